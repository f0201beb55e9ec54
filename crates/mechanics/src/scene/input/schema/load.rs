//! Loads as they are written in a scene.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::profile::ProfileSpec;

/// An external load. Body forces, gravity and centrifugal forces act on all bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LoadSpec {
    /// A traction on a boundary.
    Traction(TractionSpec),
    /// A pressure on a boundary, against its outward normal.
    Pressure(PressureSpec),
    /// A force at a node, or on a boundary.
    Force(ForceSpec),
    /// Forces on nodes of a deck: for each name of a set or number of a node the force that each of its nodes carries.
    /// They add up.
    NodalForces(BTreeMap<String, Vec<f64>>),
    /// A moment on a boundary.
    Moment(MomentSpec),
    /// A constant body force, in force per volume.
    BodyForce(Vec<f64>),
    /// The acceleration of gravity, in length per time squared: a body force of density times acceleration. Needs a
    /// density.
    Gravity(Vec<f64>),
    /// The centrifugal force of a rotation. Needs a density.
    Centrifugal(CentrifugalSpec),
}

impl LoadSpec {
    /// Returns `true` for a force at a single point.
    pub fn is_at_point(&self) -> bool {
        matches!(self, LoadSpec::Force(ForceSpec { at: Some(_), .. }))
    }

    /// Returns `true` for forces at one point or several.
    pub(crate) fn is_at_points(&self) -> bool {
        self.is_at_point() || matches!(self, LoadSpec::NodalForces(_))
    }
}

/// A force per area on a boundary, constant or with a profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TractionSpec {
    /// The boundary that the traction acts on.
    pub boundary: String,
    /// The traction, in force per area.
    pub value: Vec<f64>,
    /// A factor for the traction that changes along a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<ProfileSpec>,
}

/// A pressure on a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureSpec {
    /// The boundary that the pressure acts on.
    pub boundary: String,
    /// The pressure, in force per area; a positive pressure pushes on the body.
    pub value: f64,
    /// A factor for the pressure that changes along a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<ProfileSpec>,
}

/// A force at a node, or spread over a boundary as a constant traction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForceSpec {
    /// The point; a node must lie there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// The boundary, instead of a point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boundary: Option<String>,
    /// The force on the whole thickness, or on the full circle of a body of revolution; its radial component is summed
    /// around the circle.
    pub value: Vec<f64>,
}

/// A moment on a boundary: a traction proportional to the distance from the centre of the boundary, at right angles to
/// the vector from there and to an axis; on a flat end it is the traction of pure bending. Its force is zero, so that
/// its moment is the same about every point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MomentSpec {
    /// The boundary; required.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(required)]
    pub boundary: Option<String>,
    /// Refused: a node of a solid has no rotation, and cannot carry a moment.
    #[schemars(skip)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<Vec<f64>>,
    /// The moment, in force times length: `[m]` about z in the plane, on the whole thickness, counterclockwise; three
    /// components in space.
    pub value: Vec<f64>,
}

/// The centrifugal force of a rotation: density times the square of omega times the vector from the axis.
///
/// In a plane model the axis is normal to the plane; in an axisymmetric model it is the axis of revolution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CentrifugalSpec {
    /// The angular velocity, in radians per time.
    pub omega: f64,
    /// The direction of the axis, of any length except zero; only in space, and required there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<Vec<f64>>,
    /// A point on the axis; the origin if left out; not in an axisymmetric model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<Vec<f64>>,
}
