//! Obstacles in space as they are written in a scene.

use serde::{Deserialize, Serialize};

/// A sphere, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// The centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// The point nearest to the body: the centre less the radius along the approach direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Radius, positive. Nodes beyond its reach have no contact row.
    pub radius: f64,
}

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

/// A cone that opens along the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ConeSpec {
    /// The point nearest to the body.
    pub apex: [f64; 3],
    /// Slope of the flank away from the body, positive.
    pub slope: f64,
}

/// Heights on a grid over the two coordinates across the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HeightMapSpec {
    /// Grid lines of the first coordinate across the approach direction (x, or y where that is along x): at least two,
    /// increasing, from the first candidate to the last or further.
    pub x: Vec<f64>,
    /// Grid lines of the second coordinate across it (z, or y where the approach direction is along z), likewise.
    pub y: Vec<f64>,
    /// `heights[i][j]`: the surface's coordinate along the axis of the approach direction over `x[i]`, `y[j]`.
    pub heights: Vec<Vec<f64>>,
}
