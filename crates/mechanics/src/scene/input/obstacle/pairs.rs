//! Node pairs: the contact rows against another body.

use super::row::ObstacleRow;
use crate::fem::geometry::dot;

/// The node of another body opposite to a candidate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub partner: usize,
    /// Unit vector from the candidate's body into the other.
    pub normal: [f64; 3],
    /// Half way between the normals of both surfaces, from the candidate's body into the other.
    pub mean: [f64; 3],
    /// Distance along the normal from the candidate to its partner, in length.
    pub distance: f64,
}

impl Pair {
    /// The row of the candidate, with the other body shifted by `gap` along the unit vector `approach`.
    pub fn row(&self, gap: f64, approach: [f64; 3]) -> ObstacleRow {
        ObstacleRow { normal: self.normal, gap: self.distance + gap * dot(self.normal, approach) }
    }
}
