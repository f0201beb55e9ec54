//! A half space behind a plane, in any dimension: n . x = n . p.

use super::way::Approachable;
use crate::scene::Rule;

/// A plane through `point` with a unit `normal` into the obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub point: [f64; 3],
    pub normal: [f64; 3],
}

impl HalfSpace {
    /// The way from `node` to the plane shifted by `gap` along the unit vector `approach`.
    pub fn row(&self, node: [f64; 3], gap: f64, approach: [f64; 3], rule: Rule) -> Approachable {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let to_plane = [0, 1, 2].map(|axis| self.point[axis] - node[axis]);
        match rule {
            Rule::Approach => Approachable {
                normal: approach,
                distance: dot(self.normal, to_plane) / dot(self.normal, approach) + gap,
            },
            Rule::ClosestPoint => {
                let distance = dot(self.normal, to_plane) + gap * dot(self.normal, approach);
                Approachable { normal: self.normal, distance }
            }
        }
    }
}
