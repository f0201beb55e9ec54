//! Obstacles as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::approach::{Approach, Rule};
use super::json::{choice, word};
use crate::scene::obstacle::ShapeSpec;

/// A frictionless obstacle and the boundary that may touch it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ObstacleSpec {
    /// The boundary whose nodes are the candidates.
    pub boundary: String,
    /// The direction from the body to the obstacle.
    #[serde(deserialize_with = "word")]
    pub approach: Approach,
    /// How a node's contact row is made.
    #[serde(default, deserialize_with = "word")]
    pub rule: Rule,
    /// The surface of the obstacle.
    #[serde(deserialize_with = "choice")]
    pub shape: ShapeSpec,
}
