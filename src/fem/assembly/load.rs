//! Consistent nodal loads: f_a = integral of N_a times the force.

use super::surface::for_each_point;
use super::{DofMap, internal_force};
use crate::error::Error;
use crate::fem::body::{BodyElement, ElasticBody};
use crate::fem::element::Tabulated;
use crate::fem::mesh::Boundary;

/// Adds to the nodal load (length `dim * n_nodes`) a constant traction (x, y, z; force per area) on a boundary.
pub fn add_traction(body: &ElasticBody, boundary: &Boundary, traction: [f64; 3], load: &mut [f64]) {
    add_traction_field(body, boundary, |_, _| traction, load);
}

/// Adds to the nodal load (length `dim * n_nodes`) a pressure (force per area) on a boundary: positive pushes against
/// the outward normal.
pub fn add_pressure(body: &ElasticBody, boundary: &Boundary, pressure: f64, load: &mut [f64]) {
    add_traction_field(body, boundary, |_, normal| normal.map(|component| -pressure * component), load);
}

/// Adds to the nodal load (length `dim * n_nodes`) the traction `field(point, outward unit normal)` (force per area) on
/// a boundary, by the quadrature of its facets.
pub fn add_traction_field(
    body: &ElasticBody,
    boundary: &Boundary,
    field: impl Fn([f64; 3], [f64; 3]) -> [f64; 3],
    load: &mut [f64],
) {
    for_each_point(body, boundary, &mut |point| {
        let traction = field(point.at, point.normal);
        for (&node, share) in point.nodes.iter().zip(point.shape) {
            add_at(body, node, traction, share * point.area, load);
        }
    });
}

/// Adds to the nodal load (length `dim * n_nodes`) a constant body force (x, y, z; force per volume).
pub fn add_body_force(body: &ElasticBody, force: [f64; 3], load: &mut [f64]) {
    add_force_at(body, &body.tabulated(), |_| force, load);
}

/// Adds to the nodal load (length `dim * n_nodes`) the body force `field(point)` (force per volume), by five quadrature
/// points in each direction of an element.
pub fn add_body_force_field(body: &ElasticBody, field: impl Fn([f64; 3]) -> [f64; 3], load: &mut [f64]) {
    add_force_at(body, &Tabulated::fine(body.mesh().kind().reference()), field, load);
}

fn add_force_at(body: &ElasticBody, table: &Tabulated, field: impl Fn([f64; 3]) -> [f64; 3], load: &mut [f64]) {
    for BodyElement { nodes, cell, .. } in body.elements() {
        let scale = cell.unit().powi(body.dimension() as i32);
        for at in &table.points {
            let volume = body.point(&cell, at).weight * scale;
            let force = field(cell.place(&at.shape));
            for (&node, share) in nodes.iter().zip(at.shape) {
                add_at(body, node, force, share * volume, load);
            }
        }
    }
}

/// The load of the free dofs: the nodal load (length `dim * n_nodes`) there, less the forces that hold the prescribed
/// displacements.
///
/// # Errors
/// [`Error::Length`] where load or dofs do not belong to the mesh.
pub fn free_load(body: &ElasticBody, dofs: &DofMap, nodal: &[f64]) -> Result<Vec<f64>, Error> {
    let mut load = nodal.to_vec();
    if (0..dofs.nodal_count()).any(|dof| dofs.prescribed(dof).is_some_and(|value| value != 0.0)) {
        let lifted = dofs.expand(&vec![0.0; dofs.free().len()])?;
        let forces = internal_force(body, &lifted)?;
        load.iter_mut().zip(forces).for_each(|(load, force)| *load -= force);
    }
    dofs.restrict(&load)
}

/// Adds `force` times `factor` at a node; axes beyond the dimension of the body are left out.
fn add_at(body: &ElasticBody, node: usize, force: [f64; 3], factor: f64, load: &mut [f64]) {
    let dimension = body.dimension();
    for (axis, component) in force.iter().enumerate().take(dimension) {
        if let Some(entry) = load.get_mut(dimension * node + axis) {
            *entry += component * factor;
        }
    }
}
