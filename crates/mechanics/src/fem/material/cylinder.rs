//! Axes around a line: 1 away from it, 2 around it, 3 along it.

use crate::fem::geometry::{across, cross, dot, length, minus, unit};

/// Distances from the line below this share of the distance from its point are rounding.
const ON_LINE: f64 = 1e-9;

/// A line through a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    point: [f64; 3],
    /// The direction of the line, of length 1.
    along: [f64; 3],
}

impl Cylinder {
    /// The line along a vector of any length; `None` for a vector without a length.
    pub fn new(point: [f64; 3], along: [f64; 3]) -> Option<Self> {
        let along = unit(along);
        (length(along) > 0.0).then_some(Cylinder { point, along })
    }

    /// The direction of the line, of unit length.
    pub fn along(&self) -> [f64; 3] {
        self.along
    }

    /// A point of the line.
    pub fn point(&self) -> [f64; 3] {
        self.point
    }

    /// The axes at a place, of unit length; `None` on the line, where no direction leads away from it.
    pub fn axes(&self, place: [f64; 3]) -> Option<[[f64; 3]; 3]> {
        let away = minus(place, self.point);
        let height = dot(away, self.along);
        let radial = [0, 1, 2].map(|axis| away[axis] - height * self.along[axis]);
        (length(radial) > ON_LINE * length(away)).then(|| self.with_first(unit(radial)))
    }

    /// The axes at a place; on the line any of those at right angles to it.
    pub fn axes_or_any(&self, place: [f64; 3]) -> [[f64; 3]; 3] {
        self.axes(place).unwrap_or_else(|| self.with_first(across(self.along)))
    }

    fn with_first(&self, first: [f64; 3]) -> [[f64; 3]; 3] {
        [first, cross(self.along, first), self.along]
    }
}
