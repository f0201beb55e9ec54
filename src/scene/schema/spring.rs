//! Springs and foundations as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::condition::Place;
use super::json::{choice, number, word};

/// Springs between the body and the ground, which hold in both senses: at a node, or spread over a boundary as an elastic foundation.
///
/// A direction that is left out has no spring.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SpringSpec {
    /// Where.
    #[serde(deserialize_with = "choice")]
    pub on: Place,
    /// Stiffness along x, positive.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "cli", schemars(extend("exclusiveMinimum" = 0)))]
    pub x: Option<f64>,
    /// Stiffness along y, positive.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "cli", schemars(extend("exclusiveMinimum" = 0)))]
    pub y: Option<f64>,
    /// Stiffness along z, positive.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "cli", schemars(extend("exclusiveMinimum" = 0)))]
    pub z: Option<f64>,
    /// Stiffness along the normal of the boundary at every place, positive.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "cli", schemars(extend("exclusiveMinimum" = 0)))]
    pub normal: Option<f64>,
    /// What the stiffnesses are those of.
    #[serde(default, deserialize_with = "word")]
    pub stiffness: StiffnessOf,
}

/// What a stiffness on a boundary is that of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StiffnessOf {
    /// The whole spring, in force per length; on a boundary spread evenly over its area.
    #[default]
    Total,
    /// A foundation, in force per length and area.
    PerArea,
}
