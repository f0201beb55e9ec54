//! The forces on the nodes that hold a body in a displacement, from the stresses of its elements.

use std::ops::Range;

use crate::body::{ElasticBody, Strained};
use crate::element::Tabulated;
use crate::error::Error;
use crate::geometry::Symmetric;
use crate::threads::in_order;

/// The nodal forces (length `dim * n_nodes`, in force) that hold the body in the nodal displacement `displacement`
/// (length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in length).
///
/// Computed from the strains, element by element: a rigid translation gives exactly zero. Exceptions: a radial
/// translation of a body of revolution is not rigid, and temperatures and initial stresses give a stress without
/// strain.
pub fn internal_force(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<f64>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let tables = body.tabulated();
    let mut force = vec![0.0; displacement.len()];
    let of_run = |run: Range<usize>| {
        let mut forces = Vec::new();
        for element in run.clone().filter_map(|index| body.element(index)) {
            let first = forces.len();
            forces.resize(first + element.nodes.len(), [0.0; 3]);
            let strained = body.strained(&tables, displacement, &element);
            of_cell(&strained, tables.at(element.kind), &mut forces[first..], |_| {});
        }
        (run, forces)
    };
    in_order(body.mesh().element_count(), of_run, |(run, forces)| add_to_nodes(body, run, &forces, &mut force));
    Ok(force)
}

/// Adds the forces on the nodes of an element to `forces`; `seen` takes the stress at each quadrature point, in order.
#[inline]
pub fn of_cell(strained: &Strained, table: &Tabulated, forces: &mut [[f64; 3]], mut seen: impl FnMut(&Symmetric)) {
    for at in &table.points {
        let point = strained.displaced(at);
        let stress = strained.stress(at, &point);
        point.add_forces(at, &stress, forces);
        seen(&stress);
    }
    let scale = strained.unit_of_force();
    forces.iter_mut().flatten().for_each(|component| *component *= scale);
}

/// Adds the forces on the nodes of some elements, one element after another, to those of the body.
pub fn add_to_nodes(body: &ElasticBody, elements: Range<usize>, forces: &[[f64; 3]], sum: &mut [f64]) {
    let dimension = body.dimension();
    let nodes = elements.flat_map(|index| body.mesh().element(index));
    for (&node, force) in nodes.zip(forces) {
        let of_node = &mut sum[dimension * node..dimension * (node + 1)];
        of_node.iter_mut().zip(force).for_each(|(sum, component)| *sum += component);
    }
}
