//! A wedge: h(s) = slope |s|.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::graph::{Form, Graph};
use super::polyline::Polyline;
use super::shape::{About, Geometry, ObstacleShape, Site};
use crate::error::Error;

/// A wedge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WedgeSpec {
    /// The tip of the wedge, its point nearest to the body.
    pub apex: [f64; 2],
    /// Slope of both flanks away from the body, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub slope: f64,
}

pub(super) const ABOUT: About = About { name: "wedge", dimensions: &[2] };

impl ObstacleShape for WedgeSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let apex = site.point("apex", &self.apex)?;
        let slope = site.positive("slope", self.slope)?;
        Ok(Geometry::rigid(site, Graph::new(site, apex, Form::DrawnOut(Arc::new(Polyline::wedge(slope))))))
    }
}
