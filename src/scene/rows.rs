//! Contact rows: B u <= g in the free dofs, from the candidates of every obstacle.

use super::Warning;
use super::entry::{COORDINATE_ROUNDING, finite, point, wrong};
use super::parts::Parts;
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::qp::linear::SparseMatrix;

/// One contact row: `normal . u <= gap` at a node, or `normal . (u - u_partner) <= gap` between two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRow {
    /// The node.
    pub node: usize,
    /// The node across it, where the obstacle is another body.
    pub partner: Option<usize>,
    /// The obstacle, from 0 in the order of the scene.
    pub obstacle: usize,
    /// Unit vector [x, y, z] into the obstacle; zero beyond the dimension of the model.
    pub normal: [f64; 3],
    /// Signed distance of the undeformed node to the obstacle, or to its partner, along `normal`, in length; negative inside.
    ///
    /// The gap of the problem is this less what prescribed displacements of its nodes take up.
    pub gap: f64,
    /// Integral of the node's shape function over the candidate boundary, in area: thickness, cross-section or
    /// circumference included.
    pub tributary_area: f64,
    /// Outward unit normal [x, y, z] of the body at the node: the mean over the facets around it; zero where these cancel.
    pub outward: [f64; 3],
}

impl ContactRow {
    /// The tributary area as it is seen along `normal`: what a pressure on it times this is the force of the row. The area
    /// itself where the boundary faces away from the obstacle, which carries no force.
    pub fn projected_area(&self) -> f64 {
        let facing = dot(self.normal, self.outward);
        if facing > 0.0 { self.tributary_area * facing.min(1.0) } else { self.tributary_area }
    }

    /// The nodes that the row ties: its own with the sign 1, and the partner with -1.
    pub fn ends(&self) -> impl Iterator<Item = (usize, f64)> {
        [(Some(self.node), 1.0), (self.partner, -1.0)].into_iter().filter_map(|(node, sign)| Some((node?, sign)))
    }
}

/// The rows of all obstacles, and the matrix B and the vector g that they make in the free dofs.
pub(super) struct Rows {
    pub rows: Vec<ContactRow>,
    pub contact: SparseMatrix,
    pub gap: Vec<f64>,
    pub warnings: Vec<Warning>,
}

/// Builds the rows with all obstacles shifted by `scene_gap`.
///
/// A row whose dofs are all supported holds or fails by itself: it is left out where it holds, and stays as an empty
/// row with a negative gap where it fails.
pub(super) fn build(parts: &Parts, scene_gap: f64) -> Result<Rows, Error> {
    finite("gap", scene_gap)?;
    let (mesh, dofs) = (parts.body.mesh(), &parts.dofs);
    let dimension = parts.body.dimension();
    let rounding = COORDINATE_ROUNDING * mesh.size();
    let (mut rows, mut gap, mut entries, mut warnings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, obstacle) in parts.obstacles.iter().enumerate() {
        let mut reached = false;
        for (candidate, &(node, tributary_area)) in obstacle.candidates().iter().enumerate() {
            let at = mesh.nodes()[node];
            let found = obstacle.row(candidate, at, scene_gap).map_err(|reason| {
                let message = format!("node {node} at {} {reason}", point(&at[..dimension]));
                wrong(format!("obstacles[{index}]"), message)
            })?;
            let Some(found) = found else { continue };
            reached = true;
            let row = ContactRow {
                node,
                partner: obstacle.partner(candidate),
                obstacle: index,
                normal: found.normal,
                gap: found.gap,
                tributary_area,
                outward: obstacle.outward(candidate),
            };
            let (mut remaining, mut free) = (row.gap, Vec::new());
            for (node, sign) in row.ends() {
                let along = dofs.along(node, &row.normal[..dimension]);
                remaining -= sign * along.prescribed;
                free.extend(along.free.into_iter().map(|(column, component)| (rows.len(), column, sign * component)));
            }
            if !free.is_empty() || remaining < -rounding {
                entries.extend(free);
                rows.push(row);
                gap.push(remaining);
            }
        }
        if !reached {
            warnings.push(Warning::NoContactRow { obstacle: index });
        }
    }
    let contact = SparseMatrix::from_triplets(rows.len(), dofs.free().len(), &entries)?;
    Ok(Rows { rows, contact, gap, warnings })
}
