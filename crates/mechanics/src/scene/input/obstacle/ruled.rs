//! The rigid surfaces of a scene: one of two rules makes their rows; everything else is the same for all.

use std::fmt::Debug;

use super::row::{Obstacle, ObstacleRow};
use super::triangle::NOT_ENCLOSED;
use crate::scene::input::schema::approach::Rule;

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
