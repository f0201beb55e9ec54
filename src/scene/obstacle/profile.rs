//! Obstacles in the plane: a curve in a frame.

use std::sync::Arc;

use super::frame::{Frame, Local};
use super::row::ObstacleRow;
use super::ruled::RigidSurface;
use super::shape::Site;
use super::surface::{Foot, Surface};
use crate::scene::schema::approach::Rule;

/// Largest number of pieces of a pictured surface; more cannot be seen.
const MAX_SEGMENTS: usize = 10_000;

/// A surface in the plane, in its frame.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    frame: Frame,
    origin: Local,
    surface: Arc<dyn Surface>,
    /// Extent of the pictured surface along the body: beyond it by the size of the body on each side, so that a wall before a slender
    /// body does not end in the picture.
    extent: (f64, f64),
    rounding: f64,
}

impl Profile {
    /// The surface with its origin at a place of the frame.
    pub fn new(site: &Site, origin: Local, surface: Arc<dyn Surface>) -> Self {
        let frame = Frame::of(site.approach);
        let (low, high) = site.body.mesh().extent();
        let axis = frame.along_axis();
        let margin = site.body.mesh().size();
        let (extent, rounding) = ((low[axis] - margin, high[axis] + margin), site.rounding());
        Profile { frame, origin, surface, extent, rounding }
    }
}

impl RigidSurface for Profile {
    fn approach(&self) -> [f64; 3] {
        let [x, y] = self.frame.global([0.0, 1.0]);
        [x, y, 0.0]
    }

    fn row_by(&self, rule: Rule, [x, y, _]: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let local = self.frame.local([x, y]);
        let offset = [local[0] - self.origin[0], local[1] - self.origin[1] - shift];
        let foot = match rule {
            Rule::Approach => {
                self.surface.height(offset[0]).map(|height| Foot { normal: [0.0, 1.0], distance: height - offset[1] })
            }
            Rule::ClosestPoint => self.surface.closest(offset, self.rounding)?,
        };
        Ok(foot.map(|foot| {
            let [x, y] = self.frame.global(foot.normal);
            ObstacleRow { normal: [x, y, 0.0], gap: foot.distance }
        }))
    }

    fn gap_along(&self, from: [f64; 3], to: [f64; 3], shift: f64) -> Option<([f64; 3], [f64; 2])> {
        let local = |[x, y, _]: [f64; 3]| {
            let [along, towards] = self.frame.local([x, y]);
            [along - self.origin[0], towards - self.origin[1] - shift]
        };
        let ([from, low], [to, high]) = (local(from), local(to));
        let (first, last) = self.surface.range();
        let [start, end] = [from, to].map(|along| along.clamp(first, last));
        if start == from && end == to {
            let (heights, off) = self.surface.enclosed(from, to)?;
            return Some(([heights[0] - low, heights[1] - (low + high) / 2.0, heights[2] - high], off));
        }
        if start == end {
            return None;
        }
        // The surface reaches only over a part of the way: take the lowest height there.
        let ([first, middle, last], [below, _]) = self.surface.enclosed(start, end)?;
        let lowest = first.min(last).min(2.0 * middle - (first + last) / 2.0) - below;
        Some(([lowest - low.max(high); 3], [0.0, f64::INFINITY]))
    }

    fn outline(&self, shift: f64, segments: usize) -> Vec<[f64; 2]> {
        let (low, high) = self.extent;
        let range = self.surface.range();
        let first = (low - self.origin[0]).max(range.0);
        let last = (high - self.origin[0]).min(range.1);
        if first >= last {
            return Vec::new();
        }
        let segments = segments.clamp(1, MAX_SEGMENTS);
        let sample = |i: usize| if i == segments { last } else { first + (last - first) * i as f64 / segments as f64 };
        let mut along: Vec<f64> = (0..=segments).map(sample).collect();
        along.extend(self.surface.corners().into_iter().filter(|&corner| corner > first && corner < last));
        along.sort_by(f64::total_cmp);
        along.dedup();
        let place = |along: f64| {
            let height = self.surface.height(along)?;
            Some(self.frame.global([self.origin[0] + along, self.origin[1] + height + shift]))
        };
        along.into_iter().filter_map(place).collect()
    }
}
