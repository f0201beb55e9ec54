//! The definition of an obstacle: a contact row for every point; surfaces in their own frame, and the rules for their
//! rows.

use std::fmt::Debug;

use super::patch::NOT_ENCLOSED;
use crate::fem::geometry::shifted;
use crate::scene::input::schema::model::Rule;

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

/// A rigid surface that can make the row of a node by either rule.
pub(super) trait RigidSurface: Debug + Send + Sync {
    /// The row by one of the rules, with the surface moved by `shift`.
    fn row_by(&self, rule: Rule, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String>;

    /// As [`Obstacle::gap_along`], by rule `approach`.
    fn gap_along(&self, _from: [f64; 3], _to: [f64; 3], _shift: f64) -> Option<([f64; 3], [f64; 2])> {
        None
    }

    /// As [`Obstacle::gap_over`], by rule `approach`.
    fn gap_over(&self, _corners: [[f64; 3]; 3], _shift: f64) -> Option<([f64; 6], [f64; 2])> {
        Some(NOT_ENCLOSED)
    }

    /// As [`Obstacle::outline`].
    fn outline(&self, _shift: f64, _segments: usize) -> Vec<[f64; 2]> {
        Vec::new()
    }
}

/// A rigid surface with the rule for its rows.
#[derive(Clone, Debug)]
pub(super) struct Ruled<S> {
    pub surface: S,
    pub rule: Rule,
    /// The approach direction of the obstacle, [x, y, z], of length 1.
    pub approach: [f64; 3],
}

impl<S: RigidSurface> Obstacle for Ruled<S> {
    fn approach(&self) -> [f64; 3] {
        self.approach
    }

    fn row(&self, point: [f64; 3]) -> Result<Option<ObstacleRow>, String> {
        self.shifted_row(point, 0.0)
    }

    fn shifted_row(&self, point: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        self.surface.row_by(self.rule, point, shift)
    }

    fn surface_normal(&self, point: [f64; 3], shift: f64) -> Option<[f64; 3]> {
        let row = self.shifted_row(point, shift).ok()??;
        Some(self.surface.row_by(Rule::ClosestPoint, row.foot(point), shift).ok()??.normal)
    }

    fn gap_along(&self, from: [f64; 3], to: [f64; 3], shift: f64) -> Option<([f64; 3], [f64; 2])> {
        if self.rule == Rule::Approach { self.surface.gap_along(from, to, shift) } else { None }
    }

    fn gap_over(&self, corners: [[f64; 3]; 3], shift: f64) -> Option<([f64; 6], [f64; 2])> {
        if self.rule == Rule::Approach { self.surface.gap_over(corners, shift) } else { Some(NOT_ENCLOSED) }
    }

    fn outline(&self, shift: f64, segments: usize) -> Vec<[f64; 2]> {
        self.surface.outline(shift, segments)
    }
}

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
