//! A cylinder without ends, the half that faces the body: a circle drawn out along the axis.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::circle::Circle;
use super::shape::{About, Geometry, ObstacleShape, Site};
use super::solid::{Form, Solid};
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::scene::entry::{point, vector, wrong};

/// An axis of a cylinder may lean by the rounding of its written components.
const PERPENDICULAR: f64 = 1e-9;

/// A cylinder without ends, given by a point of its axis or of its apex line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CylinderSpec {
    /// Any point of the axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// Any point of the line nearest to the body: the axis less the radius along the approach direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Direction of the axis, perpendicular to the approach direction. Of any length but zero.
    pub axis: [f64; 3],
    /// Radius, positive. Nodes beyond its reach have no contact row.
    pub radius: f64,
}

pub(super) const ABOUT: About = About { name: "cylinder", dimensions: &[3] };

impl ObstacleShape for CylinderSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, radius)?;
        let axis = axis_across(self.axis, &site.field("axis"), site.direction())?;
        Ok(Geometry::rigid(site, Solid::new(site, apex, Form::DrawnOut(Arc::new(Circle { radius }))).along(axis)))
    }
}

/// The unit direction of a cylinder's axis.
fn axis_across(axis: [f64; 3], path: &str, approach: [f64; 3]) -> Result<[f64; 3], Error> {
    let axis = vector(path, &axis, 3)?;
    let largest = axis.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    if largest == 0.0 {
        return Err(wrong(path, "(0, 0, 0) has no direction; the axis needs a length"));
    }
    let scaled = axis.map(|part| part / largest);
    let lean = dot(scaled, approach);
    if lean.abs() > PERPENDICULAR {
        let message = format!("{} must be perpendicular to the approach direction {}", point(&axis), point(&approach));
        return Err(wrong(path, message));
    }
    let level = [0, 1, 2].map(|i| scaled[i] - lean * approach[i]);
    let length = dot(level, level).sqrt();
    Ok(level.map(|part| part / length))
}
