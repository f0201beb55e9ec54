//! The forces that hold a displaced body: f_a = sum_q w sigma grad N_a.

use crate::error::Error;
use crate::fem::body::ElasticBody;

/// The nodal forces (length `dim * n_nodes`, in force) that hold the body in the nodal displacement `displacement`
/// (length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in length).
///
/// Computed from the strains, element by element: a rigid translation gives exactly zero. Exceptions: a radial translation of a body of
/// revolution is not rigid, and temperatures and initial stresses give a stress without strain.
///
/// # Errors
/// [`qp::Error::Length`](signorini_qp::Error::Length) if the displacement does not have `dim` entries per node.
pub fn internal_force(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<f64>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let dimension = body.dimension();
    let tables = body.tabulated();
    let mut force = vec![0.0; displacement.len()];
    for element in body.elements() {
        let (nodes, cell) = (element.nodes, &element.cell);
        let strained = body.strained(&tables, displacement, &element);
        let scale = cell.unit().powi(dimension as i32 - 1);
        for at in &tables.at(element.kind).points {
            let (point, stress) = strained.at(at);
            let weight = point.weight * scale;
            let [xx, yy, zz, xy, yz, zx] = stress.map(|component| component * weight);
            let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
            for (local, &node) in nodes.iter().enumerate() {
                let g = point.gradients[local];
                for axis in 0..dimension {
                    let row = rows[axis];
                    force[dimension * node + axis] += row[0] * g[0] + row[1] * g[1] + row[2] * g[2];
                }
                force[dimension * node] += zz * point.hoop[local];
            }
        }
    }
    Ok(force)
}
