//! Obstacles as graphs over the coordinates perpendicular to the approach direction: in most cases a curve rotated or extruded. An
//! obstacle in the plane is a curve extruded along z.

use std::fmt::Debug;
use std::sync::Arc;

use super::row::ObstacleRow;
use super::ruled::RigidSurface;
use super::shape::Site;
use super::surface::Surface;
use crate::fem::geometry::{cross, dot};
use crate::scene::input::schema::approach::{Approach, Rule};

/// Largest number of pieces of a pictured surface; more cannot be seen.
const MAX_SEGMENTS: usize = 10_000;

/// A surface in its frame.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    /// Orthonormal: two axes perpendicular to the approach direction, and the approach direction.
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
    form: Form,
    /// Extent of the pictured surface along the first axis, from the origin: beyond the body by its size on each side, so that a wall
    /// before a slender body does not end in the picture.
    extent: [f64; 2],
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

impl Graph {
    /// The surface with its origin at a point.
    pub fn new(site: &Site, origin: [f64; 3], form: Form) -> Self {
        let [first, second] = across(site.approach);
        let mut axes = [[0.0; 3]; 3];
        (axes[0][first], axes[1][second], axes[2]) = (1.0, 1.0, site.direction());
        let ((low, high), margin) = (site.body.mesh().extent(), site.body.mesh().size());
        let extent = [low[first] - margin - origin[first], high[first] + margin - origin[first]];
        Graph { axes, origin, form, extent, rounding: site.rounding() }
    }

    /// A point in the frame, with the surface moved by `shift`.
    fn local(&self, point: [f64; 3], shift: f64) -> [f64; 3] {
        let from_origin = [0, 1, 2].map(|axis| point[axis] - self.origin[axis]);
        let [t1, t2, towards] = self.axes.map(|axis| dot(axis, from_origin));
        [t1, t2, towards - shift]
    }

    /// The same surface extruded along another unit vector perpendicular to the approach direction.
    pub fn along(mut self, axis: [f64; 3]) -> Self {
        self.axes[1] = axis;
        self.axes[0] = cross(axis, self.axes[2]);
        self
    }
}

impl RigidSurface for Graph {
    fn row_by(&self, rule: Rule, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let [t1, t2, towards] = self.local(node, shift);
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

    fn gap_along(&self, from: [f64; 3], to: [f64; 3], shift: f64) -> Option<([f64; 3], [f64; 2])> {
        let Form::DrawnOut(curve) = &self.form else { return None };
        let ([from, _, low], [to, _, high]) = (self.local(from, shift), self.local(to, shift));
        let (first, last) = curve.range();
        let [start, end] = [from, to].map(|along| along.clamp(first, last));
        if start == from && end == to {
            let (heights, off) = curve.enclosed(from, to)?;
            return Some(([heights[0] - low, heights[1] - (low + high) / 2.0, heights[2] - high], off));
        }
        if start == end {
            return None;
        }
        // The surface reaches only over a part of the way: take the lowest height there.
        let ([first, middle, last], [below, _]) = curve.enclosed(start, end)?;
        let lowest = first.min(last).min(2.0 * middle - (first + last) / 2.0) - below;
        Some(([lowest - low.max(high); 3], [0.0, f64::INFINITY]))
    }

    fn outline(&self, shift: f64, segments: usize) -> Vec<[f64; 2]> {
        let Form::DrawnOut(curve) = &self.form else { return Vec::new() };
        let (reach, [low, high]) = (curve.range(), self.extent);
        let (first, last) = (low.max(reach.0), high.min(reach.1));
        if first >= last {
            return Vec::new();
        }
        let segments = segments.clamp(1, MAX_SEGMENTS);
        let sample = |i: usize| if i == segments { last } else { first + (last - first) * i as f64 / segments as f64 };
        let mut along: Vec<f64> = (0..=segments).map(sample).collect();
        along.extend(curve.corners().into_iter().filter(|&corner| corner > first && corner < last));
        along.sort_by(f64::total_cmp);
        along.dedup();
        let place = |along: f64| {
            let local = [along, 0.0, curve.height(along)? + shift];
            Some([0, 1].map(|i| self.origin[i] + (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum::<f64>()))
        };
        along.into_iter().filter_map(place).collect()
    }
}

/// The two axes perpendicular to an approach direction, increasing.
pub(super) fn across(approach: Approach) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][approach.axis().0]
}
