//! Supports as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::profile::ProfileSpec;
use crate::scene::input::names;

/// The place on the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// All nodes of a named boundary.
    Boundary(String),
    /// The node at this point.
    Point(Vec<f64>),
    /// The nodes of a set, or of several, of a deck; a node is named by its number.
    #[serde(with = "names")]
    #[schemars(schema_with = "names::schema")]
    Nodes(Vec<String>),
}

/// A support: a direction that is left out is free; a number is the prescribed displacement.
///
/// A `normal` makes it a roller on an inclined plane: the component of the displacement along it is prescribed, the
/// components along the plane are free. In an axisymmetric model the plane is a cone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportSpec {
    pub on: Place,
    /// Prescribed displacement along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Prescribed displacement along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// Prescribed displacement along z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
    /// Normal of an inclined plane, of either sense and of any length except zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Vec<f64>>,
    /// Prescribed displacement along the normal, in length; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// A factor for all these displacements that changes along a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<ProfileSpec>,
}
