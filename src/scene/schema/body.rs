//! Bodies and materials as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::json::{choice, given, object, word};
use super::{
    AxisSpec, DiscSpec, ElementSpec, GmshSpec, HalfBallSpec, HalfDiscSpec, IntegrationSpec, RingSpec, SolidElementSpec,
    one,
};

/// The elastic body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum BodySpec {
    /// A rectangle with a structured mesh; its boundaries are `left`, `right`, `bottom`, `top`. In an axisymmetric
    /// model its section.
    Rectangle(#[serde(deserialize_with = "object")] RectangleSpec),
    /// A bar along x; its boundaries are `left`, `right`.
    Bar(#[serde(deserialize_with = "object")] BarSpec),
    /// A box with a structured mesh; its boundaries are `left`, `right` (along x), `front`, `back` (along y), `bottom`,
    /// `top` (along z).
    Box(#[serde(deserialize_with = "object")] BoxSpec),
    /// A disc, graded towards its lowest and its highest point; its boundaries are `lower` and `upper` and, where it is
    /// symmetric, `symmetry-x`. In an axisymmetric model, symmetric about x = 0, a ball.
    Disc(#[serde(deserialize_with = "object")] DiscSpec),
    /// Half of a disc, graded towards its lowest (highest) point; its boundaries are `cut` (flat), `arc` and, where it
    /// is symmetric, `symmetry-x`. In an axisymmetric model, symmetric about x = 0, half a ball.
    HalfDisc(#[serde(deserialize_with = "object")] HalfDiscSpec),
    /// Half of a ball, or a quarter or an eighth of one, graded towards its lowest (highest) point; its boundaries are
    /// `cut` (flat), `round` and the planes `symmetry-x` and `symmetry-y`.
    HalfBall(#[serde(deserialize_with = "object")] HalfBallSpec),
    /// A ring or a sector of it; its boundaries are `inner`, `outer` and, where it does not close, `start` and `end`.
    Ring(#[serde(deserialize_with = "object")] RingSpec),
    /// A mesh written by Gmsh; its physical groups are the boundaries.
    Gmsh(#[serde(deserialize_with = "object")] GmshSpec),
}

/// A bar along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BarSpec {
    /// The axis along x.
    #[serde(deserialize_with = "object")]
    pub x: AxisSpec,
    /// Cross-section, positive.
    #[serde(default = "one")]
    pub area: f64,
}

/// A rectangle: the product of two divided axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RectangleSpec {
    /// The axis along x.
    #[serde(deserialize_with = "object")]
    pub x: AxisSpec,
    /// The axis along y.
    #[serde(deserialize_with = "object")]
    pub y: AxisSpec,
    /// The element.
    #[serde(default, deserialize_with = "word")]
    pub element: ElementSpec,
    /// How its stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// A box: the product of three divided axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// The axis along x.
    #[serde(deserialize_with = "object")]
    pub x: AxisSpec,
    /// The axis along y.
    #[serde(deserialize_with = "object")]
    pub y: AxisSpec,
    /// The axis along z.
    #[serde(deserialize_with = "object")]
    pub z: AxisSpec,
    /// The element.
    #[serde(default, deserialize_with = "word")]
    pub element: SolidElementSpec,
    /// How its stiffness is integrated.
    #[serde(default, deserialize_with = "word")]
    pub integration: IntegrationSpec,
}

/// An isotropic linear elastic material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Young's modulus, positive, in force per area.
    pub young: f64,
    /// Poisson's ratio: above -1, at most 0.5 in a bar and in plane stress, below 0.5 elsewhere.
    pub poisson: f64,
    /// Density, positive, in mass per volume; only a dynamic analysis asks for it.
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
