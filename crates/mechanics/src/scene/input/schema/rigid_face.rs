//! Boundaries that move as rigid plates, as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::input::names;

/// A boundary that moves as a rigid plate: a displacement of its centre and a rotation about it. Components that are
/// not prescribed follow from the force and the moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidFaceSpec {
    /// The boundary, or `nodes` instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boundary: Option<String>,
    /// The nodes of a set, or of several, of a deck.
    #[serde(default, with = "names", skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "names::schema")]
    pub nodes: Vec<String>,
    /// The centre of rotation, at which the force acts; the centroid of the boundary's area, or the mean of the
    /// nodes, if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<Vec<f64>>,
    /// Prescribed displacement of the centre along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Prescribed displacement of the centre along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// Prescribed displacement of the centre along z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
    /// Prescribed rotations about the centre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationSpec>,
    /// The force on it; zero if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<Vec<f64>>,
    /// The moment on it about the centre: about z in the plane, three components in space; zero if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<Vec<f64>>,
}

/// Prescribed rotations, in radians, small; a rotation that is left out is free.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationSpec {
    /// About x, in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// About y, in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// About z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
}
