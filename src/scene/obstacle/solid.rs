//! Obstacles in space: a graph over two coordinates, in most cases a curve of the plane rotated or extruded.

use std::fmt::Debug;
use std::sync::Arc;

use super::row::ObstacleRow;
use super::ruled::RigidSurface;
use super::shape::Site;
use super::surface::Surface;
use crate::fem::geometry::{cross, dot};
use crate::scene::schema::approach::{Approach, Rule};

/// A surface in space, in its frame.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// Orthonormal: two axes perpendicular to the approach direction, and the approach direction.
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
    form: Form,
    rounding: f64,
}

/// The construction of the surface.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// A curve symmetric to its axis, rotated about it: towards = h(hypot(t1, t2)).
    Turned(Arc<dyn Surface>),
    /// A curve extruded along the second axis: towards = h(t1).
    DrawnOut(Arc<dyn Surface>),
    /// A grid: towards = h(t1, t2).
    Grid(Arc<dyn Grid>),
}

/// A surface over a grid of the two coordinates perpendicular to the approach direction.
pub(super) trait Grid: Debug + Send + Sync {
    /// The height at a place, or `None` beyond the rim.
    fn height(&self, at: [f64; 2]) -> Option<f64>;

    /// Unit normal into the obstacle at the closest point, and the distance along it; `None` beyond the rim. Lengths
    /// below `tolerance` are rounding.
    fn closest(&self, node: [f64; 3], tolerance: f64) -> Option<([f64; 3], f64)>;
}

impl Solid {
    /// The surface with its origin at a point.
    pub fn new(site: &Site, origin: [f64; 3], form: Form) -> Self {
        let across = across(site.approach);
        let mut axes = [[0.0; 3]; 3];
        (axes[0][across[0]], axes[1][across[1]], axes[2]) = (1.0, 1.0, site.direction());
        Solid { axes, origin, form, rounding: site.rounding() }
    }

    /// The same surface extruded along another unit vector perpendicular to the approach direction.
    pub fn along(mut self, axis: [f64; 3]) -> Self {
        self.axes[1] = axis;
        self.axes[0] = cross(axis, self.axes[2]);
        self
    }
}

impl RigidSurface for Solid {
    fn approach(&self) -> [f64; 3] {
        self.axes[2]
    }

    fn row_by(&self, rule: Rule, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let from_origin = [0, 1, 2].map(|axis| node[axis] - self.origin[axis]);
        let [t1, t2, towards] = self.axes.map(|axis| dot(axis, from_origin));
        let towards = towards - shift;
        let along_approach = |height: Option<f64>| height.map(|height| ([0.0, 0.0, 1.0], height - towards));
        let way = match (&self.form, rule) {
            (Form::Turned(curve), Rule::Approach) => along_approach(curve.height(t1.hypot(t2))),
            (Form::DrawnOut(curve), Rule::Approach) => along_approach(curve.height(t1)),
            (Form::Grid(map), Rule::Approach) => along_approach(map.height([t1, t2])),
            (Form::Turned(curve), Rule::ClosestPoint) => {
                let radius = t1.hypot(t2);
                // The closest point lies in the half plane of the node; on the axis the normal has no component perpendicular to it.
                let outwards = if radius > 0.0 { [t1 / radius, t2 / radius] } else { [0.0; 2] };
                let foot = curve.closest([radius, towards], self.rounding)?;
                foot.map(|foot| {
                    let [across, along] = foot.normal;
                    ([across * outwards[0], across * outwards[1], along], foot.distance)
                })
            }
            (Form::DrawnOut(curve), Rule::ClosestPoint) => {
                let foot = curve.closest([t1, towards], self.rounding)?;
                foot.map(|foot| ([foot.normal[0], 0.0, foot.normal[1]], foot.distance))
            }
            (Form::Grid(map), Rule::ClosestPoint) => map.closest([t1, t2, towards], self.rounding),
        };
        Ok(way.map(|(local, gap)| {
            let normal = [0, 1, 2].map(|i| (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum());
            ObstacleRow { normal, gap }
        }))
    }
}

/// The two axes perpendicular to an approach direction, increasing.
pub(super) fn across(approach: Approach) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][approach.axis().0]
}
