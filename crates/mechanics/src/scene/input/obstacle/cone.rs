//! A cone: a wedge rotated about the approach direction.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::graph::{Form, Graph};
use super::polyline::Polyline;
use super::shape::{About, Geometry, ObstacleShape, Site};
use crate::error::Error;

/// A cone that opens along the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConeSpec {
    /// The tip of the cone, its point nearest to the body.
    pub apex: [f64; 3],
    /// Slope of the flank away from the body, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub slope: f64,
}

pub(super) const ABOUT: About = About { name: "cone", dimensions: &[3] };

impl ObstacleShape for ConeSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let apex = site.point("apex", &self.apex)?;
        let slope = site.positive("slope", self.slope)?;
        Ok(Geometry::rigid(site, Graph::new(site, apex, Form::Turned(Arc::new(Polyline::wedge(slope))))))
    }
}
