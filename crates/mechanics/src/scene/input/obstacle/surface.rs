//! The trait of every obstacle surface, in its own frame.

use std::fmt::Debug;

/// Coordinates `[along, towards]`: along the surface, and towards the obstacle.
pub(crate) type Local = [f64; 2];

/// The connection from a node to the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foot {
    /// Unit normal at the foot, into the obstacle.
    pub normal: Local,
    /// Signed distance along the normal; negative inside.
    pub distance: f64,
}

/// A surface as a graph over the coordinate along it: the obstacle lies at and above its height.
pub(crate) trait Surface: Debug + Send + Sync {
    /// The height towards the obstacle, or `None` beyond the surface's reach.
    fn height(&self, along: f64) -> Option<f64>;

    /// The values of a quadratic function at both ends of a stretch within reach and in its middle, and the largest
    /// distances `[below, above]` of the surface from it, which are zero for a surface that is quadratic itself.
    fn enclosed(&self, from: f64, to: f64) -> Option<([f64; 3], [f64; 2])> {
        Some((self.heights(from, to)?, [0.0; 2]))
    }

    /// For a curve that is symmetric to its axis, between two distances from it within reach, `0 <= near <= far`: the
    /// heights at both of a linear function of the squared distance, and the largest distances `[below, above]` of the
    /// curve from it, which are zero for a curve that is quadratic itself.
    fn enclosed_turned(&self, near: f64, far: f64) -> Option<([f64; 2], [f64; 2])> {
        Some(([self.height(near)?, self.height(far)?], [0.0; 2]))
    }

    /// The foot closest to `node`, or `None` if no part of the surface faces it; lengths below `tolerance` are
    /// rounding.
    ///
    /// For a node behind a vertex or on an axis, equally close to both sides, the direction is along the axis.
    ///
    /// # Errors
    /// A predicate of the node if it lies so deep that no meaningful closest point exists.
    fn closest(&self, node: Local, tolerance: f64) -> Result<Option<Foot>, &'static str>;

    /// The reach, along the surface.
    fn range(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// The heights at both ends and in the middle.
    fn heights(&self, from: f64, to: f64) -> Option<[f64; 3]> {
        Some([self.height(from)?, self.height((from + to) / 2.0)?, self.height(to)?])
    }

    /// The places of the corners of the surface, along it.
    fn corners(&self) -> Vec<f64> {
        Vec::new()
    }
}
