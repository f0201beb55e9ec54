//! Rigid surfaces before a body, and the rules for their rows.

use std::fmt::Debug;

use super::patch::NOT_ENCLOSED;
use super::row::{Obstacle, ObstacleRow};
use crate::fem::geometry::{dot, minus};
use crate::scene::input::schema::model::{Approach, Rule};

/// A rigid surface. All its methods take it moved by `shift` along the approach direction, in length.
pub(super) trait Surface: Debug + Send + Sync {
    /// The distance of a node from the surface along the approach direction; `None` beyond the reach of the surface.
    fn gap(&self, node: [f64; 3], shift: f64) -> Option<f64>;

    /// The row along the normal at the closest point; `None` if no closest point faces the body.
    ///
    /// # Errors
    /// A predicate of the node if it lies so deep that no meaningful closest point exists.
    fn closest(&self, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String>;

    /// As [`Obstacle::gap_along`].
    fn gap_along(&self, _from: [f64; 3], _to: [f64; 3], _shift: f64) -> Option<([f64; 3], [f64; 2])> {
        None
    }

    /// As [`Obstacle::gap_over`].
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
pub(super) struct Placed<S> {
    pub surface: S,
    pub rule: Rule,
    /// The approach direction of the obstacle, [x, y, z], of length 1.
    pub approach: [f64; 3],
}

impl<S: Surface> Obstacle for Placed<S> {
    fn approach(&self) -> [f64; 3] {
        self.approach
    }

    fn row(&self, point: [f64; 3]) -> Result<Option<ObstacleRow>, String> {
        self.shifted_row(point, 0.0)
    }

    fn shifted_row(&self, point: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        match self.rule {
            Rule::Approach => Ok(self.surface.gap(point, shift).map(|gap| ObstacleRow { normal: self.approach, gap })),
            Rule::ClosestPoint => self.surface.closest(point, shift),
        }
    }

    fn surface_normal(&self, point: [f64; 3], shift: f64) -> Option<[f64; 3]> {
        let row = self.shifted_row(point, shift).ok()??;
        Some(self.surface.closest(row.foot(point), shift).ok()??.normal)
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

/// The axes of a surface that is a graph over the coordinates perpendicular to the approach direction.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    pub origin: [f64; 3],
    /// Orthonormal: two axes perpendicular to the approach direction, and the approach direction.
    pub axes: [[f64; 3]; 3],
}

impl Axes {
    /// Along the coordinates.
    pub fn new(approach: Approach, origin: [f64; 3]) -> Self {
        let ([first, second], (axis, sense)) = (across(approach), approach.axis());
        let mut axes = [[0.0; 3]; 3];
        (axes[0][first], axes[1][second], axes[2][axis]) = (1.0, 1.0, sense);
        Axes { origin, axes }
    }

    /// A point `[t1, t2, towards]` in these axes, with the surface moved by `shift`.
    pub fn local(&self, point: [f64; 3], shift: f64) -> [f64; 3] {
        let from_origin = minus(point, self.origin);
        let [t1, t2, towards] = self.axes.map(|axis| dot(axis, from_origin));
        [t1, t2, towards - shift]
    }

    /// A direction `[t1, t2, towards]` as `[x, y, z]`.
    pub fn global(&self, local: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum())
    }
}

/// The two axes perpendicular to an approach direction, increasing.
pub(super) fn across(approach: Approach) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][approach.axis().0]
}
