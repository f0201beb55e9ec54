//! Supports and loads as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::json::{choice, given, number, object};

/// Where on the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// All nodes of a named boundary.
    Boundary(String),
    /// The node at this point.
    Point(Vec<f64>),
}

/// A support: a direction that is left out is free, a number is the prescribed displacement.
///
/// A `normal` makes it a roller on an inclined plane: the component of the displacement along it is prescribed, those
/// along the plane are free. About an axis the plane is a cone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SupportSpec {
    /// Where.
    #[serde(deserialize_with = "choice")]
    pub on: Place,
    /// Prescribed displacement along x.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Prescribed displacement along y.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// Prescribed displacement along z.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
    /// Normal of an inclined plane, of either sense and of any length but zero.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    pub normal: Option<Vec<f64>>,
    /// Prescribed displacement along the normal, in length; 0 where it is left out.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
}

/// An external load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LoadSpec {
    /// A constant traction on a boundary.
    Traction(#[serde(deserialize_with = "object")] TractionSpec),
    /// A constant pressure on a boundary, against its outward normal.
    Pressure(#[serde(deserialize_with = "object")] PressureSpec),
    /// A force at a node.
    Force(#[serde(deserialize_with = "object")] ForceSpec),
    /// A constant body force, in force per volume.
    BodyForce(Vec<f64>),
}

/// A constant traction on a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TractionSpec {
    /// The boundary.
    pub boundary: String,
    /// The traction, in force per area.
    pub value: Vec<f64>,
}

/// A constant pressure on a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PressureSpec {
    /// The boundary.
    pub boundary: String,
    /// The pressure, in force per area; positive pushes on the body.
    pub value: f64,
}

/// A force at a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ForceSpec {
    /// The point; there must be a node.
    pub at: Vec<f64>,
    /// The force; on a body of revolution that of the full circle.
    pub value: Vec<f64>,
}
