//! Parts of boundaries as they are written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A part of a boundary: all its facets with the centroid in the box and in the sphere, and with the outward normal
/// around the direction. A condition that is left out is always met.
///
/// The facets are chosen again on every mesh: a part that ends within a facet changes with the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartSpec {
    /// Its name: a boundary for supports, loads, obstacles and later parts.
    #[schemars(extend("minLength" = 1))]
    pub name: String,
    /// The boundary, or a further body to choose its whole surface; the whole surface of the first body if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// A box along the coordinate axes that contains the centroids of the facets.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<PartBoxSpec>,
    /// A sphere; in the plane a circle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sphere: Option<PartSphereSpec>,
    /// Directions of outward normals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<PartNormalSpec>,
}

/// A box along the coordinate axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartBoxSpec {
    /// Its smallest coordinates.
    pub min: Vec<f64>,
    /// Its largest coordinates, none below the smallest.
    pub max: Vec<f64>,
}

/// A sphere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartSphereSpec {
    /// The centre of the sphere.
    pub centre: Vec<f64>,
    /// Its radius, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// Directions around a given one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartNormalSpec {
    /// The direction in their middle, of any length except zero.
    pub direction: Vec<f64>,
    /// The largest angle to this direction, in degrees, from 0 to 180.
    #[schemars(extend("minimum" = 0, "maximum" = 180))]
    pub within: f64,
}
