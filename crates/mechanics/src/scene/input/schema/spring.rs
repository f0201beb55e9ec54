//! Springs and foundations as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::condition::Place;
use super::tie::TermSpec;

/// Springs, which act in tension and compression: between the body and the ground at a node, or spread over a boundary
/// as an elastic foundation; or between nodes.
///
/// A direction that is left out has no spring.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SpringSpec {
    /// The place of a spring to the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<Place>,
    /// The elongation of a spring between nodes, instead of `on`: the sum of these terms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<TermSpec>,
    /// Stiffness along the elongation that the terms give, positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub along: Option<f64>,
    /// Stiffness along x, positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub x: Option<f64>,
    /// Stiffness along y, positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub y: Option<f64>,
    /// Stiffness along z, positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub z: Option<f64>,
    /// Stiffness along the normal of the boundary at every place, positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub normal: Option<f64>,
    /// The reference of the stiffnesses.
    #[serde(default)]
    pub stiffness: StiffnessOf,
}

/// The reference of a stiffness on a boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StiffnessOf {
    /// The whole spring, in force per length; on a boundary it is distributed evenly over its area.
    #[default]
    Total,
    /// A foundation, in force per length and area.
    PerArea,
}
