//! A sphere, seen from outside or inside: a circle rotated about the approach direction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::circle::round;
use super::graph::{Form, Graph};
use super::shape::{About, Geometry, ObstacleShape, Side, Site};
use crate::error::Error;

/// A sphere, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// The centre of the sphere that the body may touch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// The point of the sphere nearest to the body: the centre minus the radius along the approach direction; from
    /// inside, the centre plus the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Radius of the sphere, positive. Nodes beyond its reach have no contact row.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The side of the body: `outside`, or `inside`, as a ball in a cup, with the obstacle all around.
    #[serde(default, skip_serializing_if = "Side::is_outside")]
    pub side: Side,
}

pub(super) const ABOUT: About = About { name: "sphere", dimensions: &[3] };

impl ObstacleShape for SphereSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, self.side.signed(radius))?;
        Ok(Geometry::rigid(site, Graph::new(site, apex, Form::Turned(round(radius, self.side)))))
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}
