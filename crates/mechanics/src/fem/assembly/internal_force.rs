//! The forces that hold a displaced body: f_a = sum_q w sigma grad N_a.

use std::ops::Range;

use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::element::MAX_NODES;
use crate::fem::threads::in_order;

/// The nodal forces (length `dim * n_nodes`, in force) that hold the body in the nodal displacement `displacement`
/// (length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in length).
///
/// Computed from the strains, element by element: a rigid translation gives exactly zero. Exceptions: a radial
/// translation of a body of revolution is not rigid, and temperatures and initial stresses give a stress without
/// strain.
///
/// # Errors
/// [`qp::Error::Length`](signorini_qp::Error::Length) if the displacement does not have `dim` entries per node.
pub fn internal_force(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<f64>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let dimension = body.dimension();
    let tables = body.tabulated();
    let mut force = vec![0.0; displacement.len()];
    let of_element = |index: usize| {
        let mut forces = [[0.0; 3]; MAX_NODES];
        let Some(element) = body.element(index) else { return forces };
        let cell = &element.cell;
        let strained = body.strained(&tables, displacement, &element);
        let scale = cell.unit().powi(dimension as i32 - 1);
        for at in &tables.at(element.kind).points {
            let (point, (_, stress)) = (body.point(cell, at), strained.at(at));
            let weight = point.weight * scale;
            let [xx, yy, zz, xy, yz, zx] = stress.map(|component| component * weight);
            let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
            for (local, force) in forces.iter_mut().enumerate().take(element.nodes.len()) {
                let g = point.gradients[local];
                for (force, row) in force.iter_mut().zip(&rows[..dimension]) {
                    *force += row[0] * g[0] + row[1] * g[1] + row[2] * g[2];
                }
                force[0] += zz * point.hoop[local];
            }
        }
        forces
    };
    let of_run = |run: Range<usize>| (run.start, run.map(of_element).collect::<Vec<_>>());
    in_order(body.mesh().element_count(), of_run, |(first, of_elements)| {
        for (index, forces) in of_elements.iter().enumerate() {
            for (&node, of_node) in body.mesh().element(first + index).iter().zip(forces) {
                let sum = &mut force[dimension * node..dimension * (node + 1)];
                sum.iter_mut().zip(of_node).for_each(|(sum, force)| *sum += force);
            }
        }
    });
    Ok(force)
}
