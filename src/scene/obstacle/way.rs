//! The way from a node to an obstacle.

/// The way from a node to an obstacle: `normal . u <= distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) struct Approachable {
    /// Unit vector [x, y, z] into the obstacle.
    pub normal: [f64; 3],
    /// Signed distance along it; negative inside.
    pub distance: f64,
}
