//! The definition of an obstacle: a contact row for every point.

use std::fmt::Debug;

use super::patch::NOT_ENCLOSED;
use crate::fem::geometry::shifted;

/// The contact row `normal . u <= gap` of a node: the statement of an [`Obstacle`](super::Obstacle) at the place of the
/// node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleRow {
    /// Direction of the bounded displacement: a dimensionless vector [x, y, z] of length 1 into the obstacle, zero
    /// beyond the dimension of the model.
    pub normal: [f64; 3],
    /// Signed distance from the undeformed node to the obstacle along `normal`, in length; negative inside.
    pub gap: f64,
}

impl ObstacleRow {
    /// The point where the row of a node at `point` meets the obstacle.
    pub(super) fn foot(&self, point: [f64; 3]) -> [f64; 3] {
        shifted(point, self.gap, self.normal)
    }
}

/// A rigid obstacle: it gives the node at any point its contact row.
///
/// All rigid shapes of a scene are obstacles. A user-defined obstacle is added by
/// [`Scene::build_with`](crate::Scene::build_with).
///
/// ```
/// use std::sync::Arc;
///
/// use signorini_mechanics::Scene;
/// use signorini_mechanics::scene::{Obstacle, ObstacleRow};
///
/// /// The surface y = 2 + x^2, with rows along y.
/// #[derive(Debug)]
/// struct Bowl;
///
/// impl Obstacle for Bowl {
///     fn approach(&self) -> [f64; 3] {
///         [0.0, 1.0, 0.0]
///     }
///
///     fn row(&self, [x, y, _]: [f64; 3]) -> Result<Option<ObstacleRow>, String> {
///         Ok(Some(ObstacleRow { normal: self.approach(), gap: 2.0 + x * x - y }))
///     }
/// }
///
/// let scene = Scene::from_json(
///     r#"{
///         "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [1]}, "y": {"points": [0, 1], "divisions": [1]}}},
///         "material": {"young": 1, "poisson": 0},
///         "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
///         "gap": -0.25
///     }"#,
///     "scene",
/// )?;
/// let model = scene.build_with(&[("top", Arc::new(Bowl))])?;
/// // At (0, 1) the surface is 1 away, at (1, 1) it is 2; the gap of the scene brings it nearer by 0.25.
/// assert_eq!(model.problem().gap(), [0.75, 1.75]);
/// # Ok::<(), signorini_mechanics::Error>(())
/// ```
pub trait Obstacle: Debug + Send + Sync {
    /// The approach direction: a dimensionless unit vector [x, y, z] from the body to the obstacle. The gap of a scene
    /// shifts the obstacle along it.
    fn approach(&self) -> [f64; 3];

    /// The row of a node at `point` ([x, y, z], in length, zero beyond the dimension of the model); `None` if the
    /// obstacle does not reach there.
    ///
    /// # Errors
    /// The fault of the node, as it follows "node 7 at (0, 1)" in a message: "lies deeper in the circle than its
    /// centre".
    fn row(&self, point: [f64; 3]) -> Result<Option<ObstacleRow>, String>;

    /// The same, with the obstacle moved by `shift` along its approach direction, in length.
    fn shifted_row(&self, point: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let approach = self.approach();
        self.row(shifted(point, -shift, approach))
    }

    /// The dimensionless unit normal [x, y, z] of the surface, into the obstacle, at the point where the row of a node
    /// at `point` meets it, with the obstacle moved by `shift`. It is the normal of the row, unless rows lie along the
    /// approach direction for any surface; `None` if the obstacle does not reach there.
    fn surface_normal(&self, point: [f64; 3], shift: f64) -> Option<[f64; 3]> {
        Some(self.shifted_row(point, shift).ok()??.normal)
    }

    /// The gap along the approach direction on the straight line between two points, with the obstacle moved by
    /// `shift`: its values `[from, middle, to]`, and its largest distances `[below, above]` from the quadratic function
    /// through these, all in length; `above` is infinite if the obstacle ends on the line. The guaranteed bound of the
    /// total error needs it; `None` if the obstacle does not reach there, or cannot give it.
    fn gap_along(&self, _from: [f64; 3], _to: [f64; 3], _shift: f64) -> Option<([f64; 3], [f64; 2])> {
        None
    }

    /// The gap along the approach direction on the triangle between three points, with the obstacle moved by `shift`:
    /// the coefficients of a quadratic function in the basis of Bernstein, in the order of
    /// `l0^2, l1^2, l2^2, 2 l0 l1, 2 l0 l2, 2 l1 l2` with the barycentric coordinates l, and the largest distances
    /// `[below, above]` of the gap from this function, `>= 0`, all in length. `above` is infinite if the obstacle ends
    /// on the triangle; both are infinite if the obstacle cannot give it, or its rows do not lie along the approach
    /// direction. `None` if the obstacle does not reach any part of the triangle.
    fn gap_over(&self, _corners: [[f64; 3]; 3], _shift: f64) -> Option<([f64; 6], [f64; 2])> {
        Some(NOT_ENCLOSED)
    }

    /// The surface in the plane as a polyline [x, y] for pictures, in length, moved by `shift`, in `segments` pieces;
    /// empty if it has no outline.
    fn outline(&self, _shift: f64, _segments: usize) -> Vec<[f64; 2]> {
        Vec::new()
    }
}
