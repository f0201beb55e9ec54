//! The contact rows: their positions, and their values in an answer. All values are exact.

use serde::Serialize;

use super::body::Shape;
use super::packed::{Packed, Packer};
use crate::view::pressure::arc_lengths;
use signorini_mechanics::scene::{Answer, Model};
use signorini_qp::{ContactSet, ProvenSet};

#[derive(Debug, Serialize)]
pub(super) struct Rows {
    count: usize,
    /// The vertex of each row.
    vertices: Packed,
    obstacles: Packed,
    /// Into the obstacle, a component for each coordinate.
    normals: Packed,
    /// Signed distance along the normal before anything has moved, in length.
    gaps: Packed,
    /// 1 for a row that holds means over its area, 0 for one that holds the values at its nodes; `None` without rows of
    /// means.
    #[serde(skip_serializing_if = "Option::is_none")]
    means: Option<Packed>,
    /// The arc length along the boundary, in length, not a number where the boundary faces away; `None` in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    along: Option<Packed>,
}

/// The values of an answer at the rows.
#[derive(Debug, Serialize)]
pub(super) struct Contact {
    /// 1 for a row that is closed in this answer, 0 for an open one.
    closed: Packed,
    /// In force per area.
    pressure: Packed,
    /// In force, `<= 0`.
    multiplier: Packed,
    /// The remaining gap, in length.
    remaining: Packed,
    /// 0 for an undecided row, 1 for a row proven open, 2 for a row proven closed; `None` without a proof.
    #[serde(skip_serializing_if = "Option::is_none")]
    proven: Option<Packed>,
}

impl Rows {
    pub fn of(model: &Model, shape: &Shape, packer: &mut Packer) -> Self {
        let (rows, dimension) = (model.rows(), model.mesh().dimension());
        let vertex = |node: usize| shape.vertex_of.get(node).copied().flatten().unwrap_or(0);
        let vertices: Vec<usize> = rows.iter().map(|row| vertex(row.node)).collect();
        let obstacles: Vec<usize> = rows.iter().map(|row| row.obstacle).collect();
        let normals: Vec<f64> = rows.iter().flat_map(|row| row.normal[..dimension].to_vec()).collect();
        let gaps: Vec<f64> = rows.iter().map(|row| row.gap).collect();
        Rows {
            count: rows.len(),
            vertices: packer.whole(&vertices, 1),
            obstacles: packer.whole(&obstacles, 1),
            normals: packer.quantised(&normals, dimension),
            gaps: packer.exact(&gaps, 1),
            along: (dimension == 2).then(|| packer.exact(&arc_lengths(model), 1)),
            means: rows
                .iter()
                .any(|row| row.is_mean)
                .then(|| packer.bytes(rows.iter().map(|row| u8::from(row.is_mean)))),
        }
    }
}

impl Contact {
    pub fn of(answer: &Answer, proven: Option<&ProvenSet>, packer: &mut Packer) -> Self {
        let proof = |proven: &ProvenSet| {
            packer.bytes((0..proven.open.rows()).map(|row| {
                match (proven.open.contains(row), proven.closed.contains(row)) {
                    (true, _) => 1,
                    (_, true) => 2,
                    _ => 0,
                }
            }))
        };
        let proven = proven.map(proof);
        Contact {
            closed: closed(answer.contact_set(), packer),
            pressure: packer.exact(answer.pressure(), 1),
            multiplier: packer.exact(answer.multiplier(), 1),
            remaining: packer.exact(&answer.remaining_gaps(), 1),
            proven,
        }
    }
}

/// 1 for each closed row, 0 for each open one.
pub(super) fn closed(set: &ContactSet, packer: &mut Packer) -> Packed {
    packer.bytes((0..set.rows()).map(|row| u8::from(set.contains(row))))
}

/// The closed rows of many answers with values at each, one answer after another.
#[derive(Debug, Default)]
pub(super) struct Closed {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<Vec<f64>>,
}

/// The closed rows of many answers as they stand in a page.
#[derive(Debug, Serialize)]
pub(super) struct ClosedShown {
    /// Index of the first row of each answer, and the end of the rows of the last answer.
    starts: Packed,
    rows: Packed,
    /// Values at these rows.
    values: Vec<Packed>,
}

impl Closed {
    /// Adds an answer: its closed rows, and the entries of `values` at these rows; each of `values` has an entry for
    /// every row.
    pub fn add(&mut self, set: &ContactSet, values: &[&[f64]]) {
        self.starts.push(self.rows.len());
        self.values.resize_with(values.len(), Vec::new);
        for row in set {
            self.rows.push(row);
            self.values.iter_mut().zip(values).for_each(|(all, own)| all.push(own.get(row).copied().unwrap_or(0.0)));
        }
    }

    pub fn packed(mut self, packer: &mut Packer) -> ClosedShown {
        self.starts.push(self.rows.len());
        ClosedShown {
            starts: packer.whole(&self.starts, 1),
            rows: packer.whole(&self.rows, 1),
            values: self.values.iter().map(|values| packer.exact(values, 1)).collect(),
        }
    }
}
