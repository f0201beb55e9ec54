//! Contact rows: B u <= g in the free dofs, from the candidates of every obstacle.

use std::collections::BTreeMap;

use super::parts::Parts;
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::fem::sum::LinearForm;
use crate::scene::Warning;
use crate::scene::input::entry::{COORDINATE_ROUNDING, finite, point, wrong};
use crate::scene::input::obstacle::{ObstacleRow, PlacedObstacle};
use signorini_qp::SparseMatrix;

/// One contact row: `normal . sum(share * u) <= gap` over its ends. Against a rigid obstacle its node is the only end.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRow {
    /// Index of the node in the mesh, from 0.
    pub node: usize,
    /// The nodes that the row couples, each as `(node, share)`, its own first, with dimensionless shares that add up to
    /// 1 on its own body and to -1 on another body: 1 and -1 for a pair of nodes.
    pub ends: Vec<(usize, f64)>,
    /// The obstacle or other body that the row keeps out, numbered from 0 in the order of the scene.
    pub obstacle: usize,
    /// Normal of the row: a dimensionless vector [x, y, z] of length 1 into the obstacle or the other body, zero beyond
    /// the dimension of the model.
    pub normal: [f64; 3],
    /// Signed distance of the undeformed node to the obstacle, or to its partner, along `normal`, in length; negative
    /// inside.
    ///
    /// The gap of the problem is this value minus the prescribed displacements of its nodes along the normal. At
    /// mid-side nodes of quadratic faces in space, row and gap of the problem are those of a coefficient (see
    /// [`DofMap::with_contact_faces`](crate::fem::DofMap::with_contact_faces)).
    pub gap: f64,
    /// Integral of the node's shape function over the candidate boundary, in area: thickness, cross-section or
    /// circumference included. On quadratic faces in space the shape function is one with a positive integral.
    pub tributary_area: f64,
    /// `true` if the row holds means over its area, between meshes that do not match; `false` if it holds the values at
    /// its nodes.
    pub is_mean: bool,
    /// Outward unit normal [x, y, z] of the body at the node: the mean over the facets around it; zero if these cancel.
    pub outward: [f64; 3],
}

impl ContactRow {
    /// The tributary area projected along `normal`, in area: a pressure times this area is the force of the row. The
    /// area itself if the boundary faces away from the obstacle, where there is no force.
    pub fn projected_area(&self) -> f64 {
        let facing = dot(self.normal, self.outward);
        if facing > 0.0 { self.tributary_area * facing.min(1.0) } else { self.tributary_area }
    }

    /// The form in the displacements of nodes that it bounds.
    #[doc(hidden)]
    pub fn form(&self) -> LinearForm {
        LinearForm::along(self.normal, &self.ends, 1)
    }

    /// Index of the node opposite to it, if the row couples a pair of nodes.
    pub fn partner(&self) -> Option<usize> {
        match self.ends[..] {
            [_, (partner, -1.0)] => Some(partner),
            _ => None,
        }
    }
}

/// The rows of all obstacles, with their matrix B and vector g in the free dofs.
pub struct Rows {
    pub rows: Vec<ContactRow>,
    /// The same contact seen from nodes of the other bodies, where rows are means.
    pub across: Vec<ContactRow>,
    pub contact: SparseMatrix,
    pub gap: Vec<f64>,
    pub warnings: Vec<Warning>,
}

/// Builds the rows with all obstacles shifted by `scene_gap`.
///
/// If all dofs of a row are supported, no unknown can change it: it is left out if it is satisfied, and stays as an
/// empty row with a negative gap if it is violated.
pub(crate) fn build(parts: &Parts, scene_gap: f64) -> Result<Rows, Error> {
    let Found { rows, entries, gap, warnings } = found(parts, &parts.obstacles, scene_gap)?;
    let contact = SparseMatrix::from_triplets(rows.len(), parts.conditions.dofs.count(), &entries)?;
    let across = parts.obstacles.iter().enumerate().flat_map(|one| across(one, scene_gap)).collect();
    Ok(Rows { rows, across, contact, gap, warnings })
}

/// The rows with the entries `(row, column, value)` of B, before they are a matrix.
pub struct Found {
    pub rows: Vec<ContactRow>,
    pub entries: Vec<(usize, usize, f64)>,
    pub gap: Vec<f64>,
    warnings: Vec<Warning>,
}

/// The rows with all obstacles, in their places in the list, shifted by `scene_gap`.
pub(crate) fn found(parts: &Parts, obstacles: &[PlacedObstacle], scene_gap: f64) -> Result<Found, Error> {
    finite("gap", scene_gap)?;
    let (mesh, dofs) = (parts.body.mesh(), &parts.conditions.dofs);
    let dimension = parts.body.dimension();
    let rounding = COORDINATE_ROUNDING * mesh.size();
    let (mut rows, mut gap, mut entries, mut warnings) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, obstacle) in obstacles.iter().enumerate() {
        let found = of_obstacle(parts, (index, obstacle), scene_gap)?;
        let travel = parts.travel(index);
        if found.is_empty() && travel.is_some() {
            let message = "no travel produces the force: on its way the obstacle meets no node of its boundary; check its place, its \
                           approach direction and its radius";
            return Err(wrong(format!("obstacles[{index}].force"), message));
        }
        warnings.extend(obstacle.warnings().iter().cloned());
        if found.is_empty() {
            let message = format!(
                "obstacles[{index}] faces no node of its boundary: the body is solved without it; check its place, its approach direction \
                 and its radius"
            );
            warnings.push(Warning::new("no-contact-row", message));
        }
        let by_node: BTreeMap<usize, f64> = match dofs.basis.is_nodal() {
            true => BTreeMap::new(),
            false => found.iter().map(|row| (row.node, row.gap)).collect(),
        };
        for row in found {
            let mut free = Vec::new();
            // Beyond the rim of the obstacle its gap is continued with the value at the node.
            let value = |node: usize| by_node.get(&node).copied().unwrap_or(row.gap);
            let mut remaining = if row.is_mean { row.gap } else { dofs.coefficient(row.node, value) };
            let along = dofs.through(&row.form(), dimension);
            remaining -= along.prescribed;
            free.extend(along.free.into_iter().map(|(column, part)| (rows.len(), column, part)));
            if let Some(travel) = travel {
                free.push((rows.len(), travel, dot(row.normal, obstacle.approach())));
            }
            if !free.is_empty() || remaining < -rounding {
                entries.extend(free);
                rows.push(row);
                gap.push(remaining);
            }
        }
    }
    Ok(Found { rows, entries, gap, warnings })
}

/// The contact with an obstacle seen from the nodes of the other body.
fn across((index, obstacle): (usize, &PlacedObstacle), scene_gap: f64) -> impl Iterator<Item = ContactRow> {
    // Seen from there, the obstacle comes from the other side.
    let (shift, approach) = (obstacle.shift(scene_gap), obstacle.approach().map(|part| 0.0 - part));
    obstacle.across().iter().map(move |(node, facing)| {
        let ObstacleRow { normal, gap } = facing.row(shift, approach);
        let (node, ends, outward) = (*node, facing.ends.clone(), normal);
        ContactRow { node, ends, obstacle: index, normal, gap, tributary_area: 0.0, is_mean: false, outward }
    })
}

/// The rows of an obstacle, in the order of its candidates.
fn of_obstacle(
    parts: &Parts,
    (index, obstacle): (usize, &PlacedObstacle),
    scene_gap: f64,
) -> Result<Vec<ContactRow>, Error> {
    let (nodes, dimension) = (parts.body.mesh().nodes(), parts.body.dimension());
    let mut rows = Vec::with_capacity(obstacle.candidates().len());
    let areas = parts.conditions.dofs.row_areas(obstacle.candidates());
    for (candidate, (node, tributary_area)) in areas.into_iter().enumerate() {
        let at = nodes[node];
        let found = obstacle.row(candidate, at, obstacle.shift(scene_gap)).map_err(|reason| {
            let message = format!("node {node} at {} {reason}", point(&at[..dimension]));
            wrong(format!("obstacles[{index}]"), message)
        })?;
        let Some(ObstacleRow { normal, gap }) = found else { continue };
        let facing = obstacle.facing(candidate);
        let outward = facing.and_then(|facing| facing.outward).unwrap_or_else(|| obstacle.outward(candidate));
        let outward = parts.conditions.symmetry.of_whole(&at, outward);
        let ends = facing.map_or_else(|| vec![(node, 1.0)], |facing| facing.ends.clone());
        let mean = facing.and_then(|facing| facing.area);
        let (tributary_area, is_mean) = (mean.unwrap_or(tributary_area), mean.is_some());
        rows.push(ContactRow { node, ends, obstacle: index, normal, gap, tributary_area, is_mean, outward });
    }
    for (candidate, facing, ObstacleRow { normal, gap }) in obstacle.further_rows(obstacle.shift(scene_gap)) {
        let (node, ends) = (obstacle.candidates()[candidate].0, facing.ends.clone());
        let outward = parts.conditions.symmetry.of_whole(&nodes[node], facing.outward.unwrap_or(normal));
        let (tributary_area, is_mean) = (facing.area.unwrap_or(0.0), true);
        rows.push(ContactRow { node, ends, obstacle: index, normal, gap, tributary_area, is_mean, outward });
    }
    Ok(rows)
}
