//! Factors over space.

use super::entry::{direction, table};
use super::schema::condition::ProfileSpec;
use crate::error::Error;
use crate::fem::assembly::Kinks;
use crate::fem::geometry::between;
use crate::fem::geometry::dot;

/// A factor that depends on the place, checked.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The direction along which the factor changes, of length 1.
    along: [f64; 3],
    places: Vec<f64>,
    /// The same places, each with its factor.
    points: Vec<(f64, f64)>,
}

impl Profile {
    /// The factor at a JSON path, in a model of `dimension` coordinates.
    pub fn of(spec: &ProfileSpec, path: &str, dimension: usize) -> Result<Self, Error> {
        let along = direction(&format!("{path}.along"), &spec.along, dimension)?;
        table(path, ("places", &spec.places), &spec.factors)?;
        let points = spec.places.iter().copied().zip(spec.factors.iter().copied()).collect();
        Ok(Profile { along, places: spec.places.clone(), points })
    }

    /// The factor at a point.
    pub fn at(&self, point: [f64; 3]) -> f64 {
        between(&self.points, dot(self.along, point))
    }

    /// The change of the factor with the place along each axis, at a point off its kinks.
    pub fn by_place(&self, point: [f64; 3]) -> [f64; 3] {
        let after = self.places.partition_point(|&place| place <= dot(self.along, point));
        match after.checked_sub(1).and_then(|before| self.points.get(before..after + 1)) {
            Some(&[(from, first), (to, last)]) => self.along.map(|part| part * (last - first) / (to - from)),
            _ => [0.0; 3],
        }
    }

    /// The places of its kinks.
    pub fn kinks(&self) -> Kinks<'_> {
        Kinks { along: self.along, at: &self.places }
    }
}
