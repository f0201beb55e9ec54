//! The contact rows against another body.

use std::collections::HashMap;

use super::row::ObstacleRow;
use crate::fem::geometry::dot;
use crate::scene::Warning;

/// The row of a candidate against another body: the node opposite to it, or the mean over its area.
#[derive(Clone, Debug)]
pub(crate) struct Facing {
    /// The nodes that it couples, as in a [`ContactRow`](crate::scene::ContactRow).
    pub ends: Vec<(usize, f64)>,
    /// The normal of the row, of length 1, from the candidate's body into the other.
    pub normal: [f64; 3],
    /// The direction half way between the normals of both surfaces at the row, from the candidate's body into the
    /// other.
    pub mean: [f64; 3],
    /// The outward normal of the candidate's body at the row; `None` for the mean of all facets around the candidate.
    pub outward: Option<[f64; 3]>,
    /// Distance along the normal to the other body, in length.
    pub distance: f64,
    /// The area over which the row is a mean, in area; `None` for a pair of nodes.
    pub area: Option<f64>,
}

impl Facing {
    /// The row of the candidate, with the other body shifted by `gap` along the unit vector `approach`.
    pub fn row(&self, gap: f64, approach: [f64; 3]) -> ObstacleRow {
        ObstacleRow { normal: self.normal, gap: self.distance + gap * dot(self.normal, approach) }
    }
}

/// The rows between two bodies.
#[derive(Clone, Debug)]
pub(crate) struct Between {
    /// The row of each candidate of the boundary that carries the rows; `None` where nothing faces it.
    pub rows: Vec<Option<Facing>>,
    /// Further rows of candidates, by their numbers: a node at a corner has one for each side.
    pub further: Vec<(usize, Facing)>,
    /// For nodes of the other body the place that they face, as a row against their own normal: not a row of the
    /// problem, but the same contact seen from there.
    pub across: Vec<(usize, Facing)>,
    /// Name of the boundary that the rows lead to.
    pub other: String,
    /// Covered shares of the carrying and of the other boundary, if rows are means.
    pub covered: Option<[f64; 2]>,
    /// The nodes, in ascending order, of each facet of the carrying boundary that faces the other, with the covered
    /// share of its area, if rows are means.
    pub facets: Option<HashMap<Vec<usize>, f64>>,
    /// Largest distance at which the bodies may touch, in length; infinite without one.
    pub reach: f64,
    /// The gap of all rows, in length, instead of the distance of the bodies.
    pub fit: Option<f64>,
    /// The boundary of the other body carries the rows, so that they lead against the approach direction.
    pub is_swapped: bool,
    /// What the search for rows noticed.
    pub warnings: Vec<Warning>,
}
