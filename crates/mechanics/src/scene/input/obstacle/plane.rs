//! A plane: a line in the plane, n . x = 0 in the frame of its point; a half space behind a plane elsewhere.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::graph::{Form, Graph};
use super::row::ObstacleRow;
use super::ruled::RigidSurface;
use super::shape::{About, Geometry, ObstacleShape, Site};
use super::surface::{Foot, Local, Surface};
use crate::error::Error;
use crate::fem::geometry::{dot, length, minus};
use crate::scene::input::entry::{point, vector, wrong};
use crate::scene::input::schema::approach::Rule;

/// A plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// A point of the plane.
    pub point: Vec<f64>,
    /// Its normal, which points into the obstacle, to the side of the approach direction; of any length except zero.
    pub normal: Vec<f64>,
}

pub(super) const ABOUT: About = About { name: "plane", dimensions: &[1, 2, 3] };

impl PlaneSpec {
    /// Its point and its unit normal.
    fn checked(&self, site: &Site) -> Result<([f64; 3], [f64; 3]), Error> {
        let (dimension, approach) = (site.body.dimension(), site.direction());
        let at = vector(&site.field("point"), &self.point, dimension)?;
        let normal = vector(&site.field("normal"), &self.normal, dimension)?;
        let length = length(normal);
        if length == 0.0 {
            let zero = point(&normal[..dimension]);
            return Err(wrong(site.field("normal"), format!("{zero} has no direction; the normal needs a length")));
        }
        let normal = normal.map(|component| component / length);
        let towards = dot(normal, approach);
        if !(towards > 0.0 && towards.is_finite()) {
            let message = format!(
                "{} must point into the obstacle: to the side of the approach direction {}",
                point(&self.normal),
                point(&approach[..dimension])
            );
            return Err(wrong(site.field("normal"), message));
        }
        Ok((at, normal))
    }
}

impl ObstacleShape for PlaneSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let (point, normal) = self.checked(site)?;
        if site.body.dimension() == 2 {
            let line = Line { normal: site.local(normal) };
            return Ok(Geometry::rigid(site, Graph::new(site, point, Form::DrawnOut(Arc::new(line)))));
        }
        Ok(Geometry::rigid(site, HalfSpace { point, normal, approach: site.direction() }))
    }
}

/// A line through the origin with a unit normal into the obstacle.
#[derive(Debug)]
struct Line {
    normal: Local,
}

impl Surface for Line {
    fn height(&self, along: f64) -> Option<f64> {
        // A product with a zero from a division may be a negative zero; the sum removes its sign.
        Some(0.0 - self.normal[0] / self.normal[1] * along)
    }

    fn closest(&self, [along, towards]: Local, _: f64) -> Result<Option<Foot>, &'static str> {
        let distance = -(self.normal[0] * along + self.normal[1] * towards);
        Ok(Some(Foot { normal: self.normal, distance }))
    }
}

/// A plane through `point` with a unit `normal` into the obstacle.
#[derive(Clone, Copy, Debug)]
struct HalfSpace {
    point: [f64; 3],
    normal: [f64; 3],
    approach: [f64; 3],
}

impl RigidSurface for HalfSpace {
    fn row_by(&self, rule: Rule, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let to_plane = dot(self.normal, minus(self.point, node));
        let lean = dot(self.normal, self.approach);
        Ok(Some(match rule {
            Rule::Approach => ObstacleRow { normal: self.approach, gap: to_plane / lean + shift },
            Rule::ClosestPoint => ObstacleRow { normal: self.normal, gap: to_plane + shift * lean },
        }))
    }
}
