//! Lines of round bodies: a core of straight lines, and shells around it out to the surface, fine at the lowest point.

use super::Zone;
use crate::error::Error;
use crate::fem::geometry::length;

/// Half the width of the core divided by the radius: cells are neither flat at its corners nor small in its middle.
const CORE: f64 = 0.4;

/// The lines of a round body around its core.
pub(crate) struct Grading {
    radius: f64,
    /// Arc lengths from the lowest point to the corner of the core, fine at 0.
    pub aside: Vec<f64>,
    /// Arc lengths from the cut to the corner of the core.
    pub down: Vec<f64>,
    /// The positions of the shells, from 0 at the core to 1 at the surface, fine at 1.
    pub shells: Vec<f64>,
}

impl Grading {
    pub fn new(radius: f64, zone: &Zone) -> Result<Self, Error> {
        zone.check(radius)?;
        let quarter = radius * std::f64::consts::FRAC_PI_4;
        let aside = zone.lines(quarter)?;
        // About as wide as the last cell next to them.
        let last = quarter - aside[aside.len() - 2];
        let rows = (quarter / last).round().max(2.0);
        let down = (0..=rows as usize).map(|row| quarter * row as f64 / rows).collect();
        let depth = radius * (1.0 - CORE);
        let mut shells: Vec<f64> = zone.lines(depth)?.iter().map(|line| 1.0 - line / depth).collect();
        shells.reverse();
        Ok(Grading { radius, aside, down, shells })
    }

    /// The tangent of the angle of an arc length from an axis; exact at the corner of the core, where it is 1.
    pub fn tangent(&self, arc: f64) -> f64 {
        let angle = arc / self.radius;
        if angle.abs() >= std::f64::consts::FRAC_PI_4 { angle.signum() } else { angle.tan() }
    }

    /// The position, relative to the centre, of a point of the core (given in halves of the core's width) that is moved
    /// along its ray by `outward`: from the core (0) to the surface (1).
    pub fn place(&self, core: [f64; 3], outward: f64) -> [f64; 3] {
        if outward == 0.0 {
            return core.map(|value| value * CORE * self.radius);
        }
        let stretch = (1.0 - outward) * CORE + outward / length(core);
        core.map(|value| value * stretch * self.radius)
    }
}
