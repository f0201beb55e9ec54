//! Reference points as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::rigid_face::RotationSpec;

/// A reference point: it has displacements and small rotations, and is no node of a mesh. Couplings, equations and
/// springs join it to nodes and to other points. Components that are not prescribed follow from the force and the
/// moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointSpec {
    /// The name, by which ties and springs name it.
    pub name: String,
    /// Its place, about which it turns.
    pub at: Vec<f64>,
    /// Displacement of the point along x, if it is prescribed, in length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Displacement of the point along y, if it is prescribed, in length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
    /// Displacement of the point along z, if it is prescribed, in length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
    /// Rotations of the point that are prescribed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationSpec>,
    /// The force on the point; zero if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<Vec<f64>>,
    /// The moment on the point: about z in the plane, three components in space; zero if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment: Option<Vec<f64>>,
}
