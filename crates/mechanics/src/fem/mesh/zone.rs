//! Grading towards a contact zone: fine cells of one size there, growing cells beyond.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use signorini_linear as linear;

use super::axis::MAX_LINES;
use crate::error::Error;
use crate::fem::formulation::positive;

/// The finely meshed zone around the lowest (highest) point of a round body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "ZoneSpec")]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// Distance over which the cells have one size, from the lowest point to each side and into the body: positive, at
    /// most the radius. Twice the expected contact half-width is a good choice.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub width: f64,
    /// Cells on this width, at least 1.
    #[schemars(extend("minimum" = 1))]
    pub divisions: usize,
    /// Size of each further cell over that of its neighbour towards the zone, from 1 to 10.
    #[serde(default = "growth")]
    #[schemars(extend("minimum" = 1, "maximum" = 10))]
    pub growth: f64,
}

fn growth() -> f64 {
    1.2
}

/// A cell smaller than this times the radius is below the rounding of coordinates.
const SMALLEST: f64 = 1e-8;

impl Zone {
    pub(crate) fn check(&self, radius: f64) -> Result<(), Error> {
        let fail = |name, value, allowed| Err(linear::Error::Setting { name, value, allowed }.into());
        positive("radius", radius)?;
        if !(self.width > 0.0 && self.width <= radius) {
            return fail("zone.width", self.width, "positive, and at most the radius");
        }
        if !(self.growth >= 1.0 && self.growth <= 10.0) {
            return fail("zone.growth", self.growth, "from 1 to 10 (each cell over its neighbour)");
        }
        let cells = self.divisions as f64;
        if self.divisions == 0 || self.divisions > MAX_LINES || self.width / cells < SMALLEST * radius {
            return fail("zone.divisions", cells, "at least 1, with cells of at least 1e-8 of the radius");
        }
        Ok(())
    }

    /// The approximate number of cells on `length`, and the size of the last cell.
    pub fn count(&self, length: f64) -> (f64, f64) {
        let size = self.width / self.divisions as f64;
        let rest = length - self.width;
        if rest <= 0.0 {
            return (length / size, size);
        }
        let growing = match self.growth.ln() {
            rate if rate > 0.0 => (rest * (self.growth - 1.0) / (size * self.growth)).ln_1p() / rate,
            _ => rest / size,
        };
        (self.divisions as f64 + growing, size * self.growth.powf(growing))
    }

    /// Cuts every cell into `times` cells.
    pub(crate) fn refine(&mut self, times: usize) {
        self.divisions = self.divisions.saturating_mul(times);
        self.growth = self.growth.powf(1.0 / times as f64);
    }

    /// Lines from 0 to `length`, fine at 0; the last one is met exactly.
    pub(super) fn lines(&self, length: f64) -> Result<Vec<f64>, Error> {
        let size = self.width / self.divisions as f64;
        let fine = if self.width < length { self.divisions } else { (length / size).ceil().max(1.0) as usize };
        let reach = self.width.min(length);
        let mut lines: Vec<f64> = (0..fine).map(|cell| reach * cell as f64 / fine as f64).collect();
        let mut growing = Vec::new();
        let mut total = 0.0;
        let mut next = size;
        while reach + total < length {
            next *= self.growth;
            total += next;
            growing.push(next);
            if growing.len() > MAX_LINES {
                let (name, allowed) = ("zone.growth", "larger: the cells are more than the nodes that are allowed");
                return Err(linear::Error::Setting { name, value: self.growth, allowed }.into());
            }
        }
        // All growing cells are scaled by one factor, so that the last line is at `length`.
        let factor = (length - reach) / total;
        let mut at = reach;
        for cell in growing {
            lines.push(at);
            at += cell * factor;
        }
        lines.push(length);
        Ok(lines)
    }
}
