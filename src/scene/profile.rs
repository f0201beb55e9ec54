//! Factors over space: how loads and prescribed displacements change along a direction.

use super::entry::{table, vector, wrong};
use super::schema::profile::ProfileSpec;
use crate::error::Error;
use crate::fem::assembly::Kinks;
use crate::fem::geometry::{dot, unit};
use crate::motion::between;

/// A factor of the place, checked.
#[derive(Debug)]
pub(super) struct Profile {
    /// A unit vector.
    along: [f64; 3],
    places: Vec<f64>,
    /// The places again, each with its factor.
    points: Vec<(f64, f64)>,
}

impl Profile {
    /// That of a JSON path, in a model of `dimension` coordinates.
    ///
    /// # Errors
    /// [`Error::Scene`] for a direction that is none, and for a table that does not increase.
    pub fn of(spec: &ProfileSpec, path: &str, dimension: usize) -> Result<Self, Error> {
        let field = format!("{path}.along");
        let along = unit(vector(&field, &spec.along, dimension)?);
        if along == [0.0; 3] {
            return Err(wrong(field, "the vector is zero and has no direction; it needs a length"));
        }
        table(path, ("places", &spec.places), &spec.factors)?;
        let points = spec.places.iter().copied().zip(spec.factors.iter().copied()).collect();
        Ok(Profile { along, places: spec.places.clone(), points })
    }

    /// The factor at a point.
    pub fn at(&self, point: [f64; 3]) -> f64 {
        between(&self.points, dot(self.along, point))
    }

    /// Where it has kinks.
    pub fn kinks(&self) -> Kinks<'_> {
        Kinks { along: self.along, at: &self.places }
    }
}
