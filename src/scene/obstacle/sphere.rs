//! A sphere, the half that faces the body: a circle turned about the approach direction.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::circle::Circle;
use super::shape::{About, Geometry, ObstacleShape, Site};
use super::solid::{Form, Solid};
use crate::error::Error;

/// A sphere, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// The centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// The point nearest to the body: the centre less the radius along the approach direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Radius, positive. Nodes beyond its reach have no contact row.
    pub radius: f64,
}

pub(super) const ABOUT: About = About { name: "sphere", dimensions: &[3] };

impl ObstacleShape for SphereSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, radius)?;
        Ok(Geometry::rigid(site, Solid::new(site, apex, Form::Turned(Arc::new(Circle { radius })))))
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}
