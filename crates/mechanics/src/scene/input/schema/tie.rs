//! Ties as they are written in a scene: equations between displacements.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::condition::Place;

/// Displacements that are tied to each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TieSpec {
    /// Two surfaces that move together in all directions.
    Surfaces(TiedSurfacesSpec),
    /// One linear equation between displacements of nodes.
    Equation(EquationSpec),
}

/// Two surfaces that stay together, in the mean over the area of each node of one of them. Their meshes need not match. The softer body, or
/// the one with the smaller facets, takes the means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TiedSurfacesSpec {
    /// The boundary of one body.
    pub boundary: String,
    /// The boundary of the other.
    pub to: String,
    /// The largest distance, positive, at which the surfaces are tied; one length of a facet if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reach: Option<f64>,
}

/// An equation: the sum of the terms is the value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EquationSpec {
    /// Displacements of nodes, each with its coefficients.
    pub terms: Vec<TermSpec>,
    /// The value, in length; 0 if it is left out.
    #[serde(default)]
    pub value: f64,
}

/// The displacement of one node: the sum of its components times their coefficients, which are dimensionless.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TermSpec {
    /// The node: a point, or the number of a node of a deck.
    pub on: Place,
    /// The coefficient of the displacement along x.
    #[serde(default)]
    pub x: f64,
    /// The coefficient of the displacement along y.
    #[serde(default)]
    pub y: f64,
    /// The coefficient of the displacement along z.
    #[serde(default)]
    pub z: f64,
}
