//! Factors over space as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A factor that changes along a direction: straight lines between places, constant beyond the first and the last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProfileSpec {
    /// The direction, of any length except zero.
    pub along: Vec<f64>,
    /// Places along it, at least one, increasing: distances from the plane through the origin normal to the direction.
    #[schemars(extend("minItems" = 1))]
    pub places: Vec<f64>,
    /// The factor at each place.
    #[schemars(extend("minItems" = 1))]
    pub factors: Vec<f64>,
}
