//! A plane: n . x = 0 in the frame of its point.

use super::frame::Local;
use super::surface::{Foot, Surface};

/// A plane through the origin with a unit normal into the obstacle.
#[derive(Debug)]
pub(super) struct Plane {
    pub normal: Local,
}

impl Surface for Plane {
    fn height(&self, along: f64) -> Option<f64> {
        // A product with a zero that came from a division would be a negative zero; the sum takes its sign away.
        Some(0.0 - self.normal[0] / self.normal[1] * along)
    }

    fn closest(&self, [along, towards]: Local, _: f64) -> Result<Option<Foot>, &'static str> {
        let distance = -(self.normal[0] * along + self.normal[1] * towards);
        Ok(Some(Foot { normal: self.normal, distance }))
    }
}
