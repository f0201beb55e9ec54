//! Materials and further bodies as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::json::{choice, given, object};
use crate::scene::body::BodySpec;

/// An isotropic linear elastic material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Young's modulus, positive, in force per area.
    pub young: f64,
    /// Poisson's ratio: above -1, at most 0.5 in a bar and in plane stress, below 0.5 elsewhere.
    pub poisson: f64,
    /// Density, positive, in mass per volume; a dynamic analysis, gravity and centrifugal forces ask for it.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
}

/// An elastic body beside the first: of the same model, thickness and element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FurtherBodySpec {
    /// Its name; its boundaries are called `name.boundary`.
    pub name: String,
    /// The body.
    #[serde(deserialize_with = "choice")]
    pub body: BodySpec,
    /// Its material.
    #[serde(deserialize_with = "object")]
    pub material: MaterialSpec,
}
