//! Obstacles as they are written in a scene.

use serde::{Deserialize, Serialize};

use super::json::{choice, object, word};
use super::solid::{ConeSpec, CylinderSpec, HeightMapSpec, SphereSpec};

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

/// A direction along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum Approach {
    /// Along x.
    #[serde(rename = "+x")]
    PlusX,
    /// Against x.
    #[serde(rename = "-x")]
    MinusX,
    /// Along y.
    #[serde(rename = "+y")]
    PlusY,
    /// Against y.
    #[serde(rename = "-y")]
    MinusY,
    /// Along z.
    #[serde(rename = "+z")]
    PlusZ,
    /// Against z.
    #[serde(rename = "-z")]
    MinusZ,
}

impl Approach {
    /// The axis, 0 to 2, and the sense along it, 1 or -1.
    pub fn axis(self) -> (usize, f64) {
        match self {
            Approach::PlusX => (0, 1.0),
            Approach::MinusX => (0, -1.0),
            Approach::PlusY => (1, 1.0),
            Approach::MinusY => (1, -1.0),
            Approach::PlusZ => (2, 1.0),
            Approach::MinusZ => (2, -1.0),
        }
    }

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Approach::PlusX => "+x",
            Approach::MinusX => "-x",
            Approach::PlusY => "+y",
            Approach::MinusY => "-y",
            Approach::PlusZ => "+z",
            Approach::MinusZ => "-z",
        }
    }
}

/// How a candidate node's contact row is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// Along the approach direction: `u . approach <= distance along it`; one entry per row.
    #[default]
    Approach,
    /// Along the obstacle's normal at the point closest to the node: `n . u <= distance`; one entry per coordinate.
    ClosestPoint,
}

/// The surface of an obstacle, over the coordinates across the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ShapeSpec {
    /// A plane.
    Plane(#[serde(deserialize_with = "object")] PlaneSpec),
    /// A parabola t^2/(2 radius) that bulges towards the body.
    Parabola(#[serde(deserialize_with = "object")] ParabolaSpec),
    /// The half of a circle that faces the body.
    Circle(#[serde(deserialize_with = "object")] CircleSpec),
    /// A wedge slope |t| that points at the body.
    Wedge(#[serde(deserialize_with = "object")] WedgeSpec),
    /// A polyline.
    Table(#[serde(deserialize_with = "object")] TableSpec),
    /// In space: the half of a sphere that faces the body.
    Sphere(#[serde(deserialize_with = "object")] SphereSpec),
    /// In space: the half of a cylinder that faces the body, its axis across the approach direction.
    Cylinder(#[serde(deserialize_with = "object")] CylinderSpec),
    /// In space: a cone that points at the body, its axis along the approach direction.
    Cone(#[serde(deserialize_with = "object")] ConeSpec),
    /// In space: heights on a grid, bilinear in between.
    HeightMap(#[serde(deserialize_with = "object")] HeightMapSpec),
    /// The surface of another elastic body, node to node.
    Body(#[serde(deserialize_with = "object")] FacingSpec),
}

impl ShapeSpec {
    /// As it is written.
    pub fn name(&self) -> &'static str {
        match self {
            ShapeSpec::Plane(_) => "plane",
            ShapeSpec::Parabola(_) => "parabola",
            ShapeSpec::Circle(_) => "circle",
            ShapeSpec::Wedge(_) => "wedge",
            ShapeSpec::Table(_) => "table",
            ShapeSpec::Sphere(_) => "sphere",
            ShapeSpec::Cylinder(_) => "cylinder",
            ShapeSpec::Cone(_) => "cone",
            ShapeSpec::HeightMap(_) => "height-map",
            ShapeSpec::Body(_) => "body",
        }
    }
}

/// The surface of another elastic body: across every candidate lies one of its nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FacingSpec {
    /// The boundary of the other body, as `name.boundary`.
    pub boundary: String,
}

/// A plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// A point of the plane.
    pub point: Vec<f64>,
    /// Its normal, pointing into the obstacle: on the side of the approach direction. Of any length but zero.
    pub normal: Vec<f64>,
}

/// A parabola.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ParabolaSpec {
    /// The point nearest to the body.
    pub apex: [f64; 2],
    /// Radius of curvature at the apex, positive.
    pub radius: f64,
}

/// A circle, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CircleSpec {
    /// The centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 2]>,
    /// The point nearest to the body: the centre less the radius along the approach direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 2]>,
    /// Radius, positive. Nodes beyond its reach have no contact row.
    pub radius: f64,
}

/// A wedge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WedgeSpec {
    /// The point nearest to the body.
    pub apex: [f64; 2],
    /// Slope of both flanks away from the body, positive.
    pub slope: f64,
}

/// A polyline through points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// At least two points [x, y], increasing in the coordinate across the approach direction, from the first
    /// candidate to the last or further.
    pub points: Vec<[f64; 2]>,
}
