//! Parts of boundaries as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::json::{given, given_object};

/// A part of a boundary: all facets of it whose centroids lie in the box and in the sphere, and whose outward normals lie around
/// the direction. What is left out asks for nothing.
///
/// The facets are chosen on every mesh anew: a part that ends within a facet changes with the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PartSpec {
    /// Its name: a boundary for supports, loads, obstacles and the parts behind it.
    #[cfg_attr(feature = "cli", schemars(extend("minLength" = 1)))]
    pub name: String,
    /// The boundary, or the further body whose whole surface is meant; the whole surface of the first body where it is left out.
    #[serde(default, deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// A box along the coordinate axes.
    #[serde(rename = "box", default, deserialize_with = "given_object", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<PartBoxSpec>,
    /// A sphere; in the plane a circle.
    #[serde(default, deserialize_with = "given_object", skip_serializing_if = "Option::is_none")]
    pub sphere: Option<PartSphereSpec>,
    /// Directions of outward normals.
    #[serde(default, deserialize_with = "given_object", skip_serializing_if = "Option::is_none")]
    pub normal: Option<PartNormalSpec>,
}

/// A box along the coordinate axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PartBoxSpec {
    /// Its smallest coordinates.
    pub min: Vec<f64>,
    /// Its largest coordinates, none below the smallest.
    pub max: Vec<f64>,
}

/// A sphere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PartSphereSpec {
    /// Its centre.
    pub centre: Vec<f64>,
    /// Its radius, positive.
    #[cfg_attr(feature = "cli", schemars(extend("exclusiveMinimum" = 0)))]
    pub radius: f64,
}

/// Directions around one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PartNormalSpec {
    /// The direction in their middle, of any length but zero.
    pub direction: Vec<f64>,
    /// The largest angle to it, in degrees, from 0 to 180.
    #[cfg_attr(feature = "cli", schemars(extend("minimum" = 0, "maximum" = 180)))]
    pub within: f64,
}
