//! A cylinder without ends, seen from outside or inside: a circle extruded along the axis.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::circle::round;
use super::graph::{Form, Graph};
use super::shape::{About, Geometry, ObstacleShape, Side, Site};
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::scene::input::entry::{point, wrong};

/// Deviation of a cylinder's axis from the right angle that is rounding of its written components.
const PERPENDICULAR: f64 = 1e-9;

/// A cylinder without ends, given by a point of its axis or of its apex line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderSpec {
    /// Any point of the axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// Any point of the axis minus the radius along the approach direction, on the line nearest to the body; from
    /// inside, plus the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Direction of the axis, perpendicular to the approach direction, of any length except zero.
    pub axis: [f64; 3],
    /// Radius of the cylinder, positive. Nodes beyond its reach have no contact row.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The side of the cylinder on which the body is: `outside`, or `inside`, as a pin in a hole, with the obstacle all
    /// around.
    #[serde(default, skip_serializing_if = "Side::is_outside")]
    pub side: Side,
}

pub(super) const ABOUT: About = About { name: "cylinder", dimensions: &[3] };

impl ObstacleShape for CylinderSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, self.side.signed(radius))?;
        let axis = axis_across(&self.axis, site)?;
        Ok(Geometry::rigid(site, Graph::new(site, apex, Form::DrawnOut(round(radius, self.side))).along(axis)))
    }
}

/// The unit direction of a cylinder's axis.
fn axis_across(written: &[f64; 3], site: &Site) -> Result<[f64; 3], Error> {
    let (axis, approach) = (site.axis("axis", written)?, site.direction());
    let lean = dot(axis, approach);
    if lean.abs() > PERPENDICULAR {
        let message =
            format!("{} must be perpendicular to the approach direction {}", point(written), point(&approach));
        return Err(wrong(site.field("axis"), message));
    }
    let level = [0, 1, 2].map(|i| axis[i] - lean * approach[i]);
    let length = dot(level, level).sqrt();
    Ok(level.map(|part| part / length))
}
