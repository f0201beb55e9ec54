//! The scene as it is written: typed, with defaults, unknown fields refused.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parse::{choice, choices, number, object, objects, word};

/// A contact scene: one elastic body, its supports and loads, and the rigid obstacles around it.
///
/// Any consistent system of units. Coordinates are [x, y].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Scene {
    /// Address of the JSON Schema of scenes, for editors.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    pub schema: Option<String>,
    /// What the scene shows.
    #[serde(default)]
    pub title: String,
    /// Names of the units, for tables and pictures.
    #[serde(default, deserialize_with = "object")]
    pub units: Units,
    /// What happens across the plane.
    #[serde(default, deserialize_with = "word")]
    pub model: PlaneModel,
    /// Depth across the plane, positive.
    #[serde(default = "one")]
    pub thickness: f64,
    /// The elastic body.
    #[serde(deserialize_with = "choice")]
    pub body: BodySpec,
    /// Its material.
    #[serde(deserialize_with = "object")]
    pub material: MaterialSpec,
    /// Prescribed displacements.
    #[serde(default, deserialize_with = "objects")]
    pub supports: Vec<SupportSpec>,
    /// External loads; they add up.
    #[serde(default, deserialize_with = "choices")]
    pub loads: Vec<LoadSpec>,
    /// Rigid, frictionless obstacles.
    #[serde(default, deserialize_with = "objects")]
    pub obstacles: Vec<ObstacleSpec>,
    /// Shift of every obstacle along its own approach direction; negative moves it towards, and into, the body.
    #[serde(default)]
    pub gap: f64,
}

fn one() -> f64 {
    1.0
}

/// Names of the units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Unit of length, as `m`.
    pub length: String,
    /// Unit of force, as `N`.
    pub force: String,
}

impl Default for Units {
    fn default() -> Self {
        Units { length: "m".into(), force: "N".into() }
    }
}

impl Units {
    /// The unit of pressure and stress: `Pa`, `MPa`, or force over length squared.
    pub fn pressure(&self) -> String {
        match (self.force.as_str(), self.length.as_str()) {
            ("N", "m") => "Pa".into(),
            ("N", "mm") => "MPa".into(),
            (force, length) => format!("{force}/{length}²"),
        }
    }
}

/// What happens across the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneModel {
    /// No strain across the plane: a long body.
    #[default]
    PlaneStrain,
    /// No stress across the plane: a thin body.
    PlaneStress,
}

/// The elastic body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BodySpec {
    /// A rectangle with a structured mesh; its boundaries are `left`, `right`, `bottom`, `top`.
    Rectangle(#[serde(deserialize_with = "object")] RectangleSpec),
}

/// A rectangle: the product of two divided axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// One axis of a structured mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisSpec {
    /// Breakpoints, at least two, increasing.
    pub points: Vec<f64>,
    /// Cells of each interval between breakpoints, at least 1.
    pub divisions: Vec<usize>,
    /// Last cell size over first cell size of each interval, positive; all 1 where left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ratios: Vec<f64>,
}

/// The elements to choose from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ElementSpec {
    /// Linear triangle.
    T3,
    /// Bilinear quadrilateral.
    #[default]
    Q4,
}

/// An isotropic linear elastic material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Young's modulus, positive, in force per area.
    pub young: f64,
    /// Poisson's ratio: above -1, below 0.5 in plane strain, at most 0.5 in plane stress.
    pub poisson: f64,
}

/// Where on the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// All nodes of a named boundary.
    Boundary(String),
    /// The node at this point.
    Point([f64; 2]),
}

/// A support: a direction that is left out is free, a number is the prescribed displacement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportSpec {
    /// Where.
    #[serde(deserialize_with = "choice")]
    pub on: Place,
    /// Prescribed displacement along x.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// Prescribed displacement along y.
    #[serde(default, deserialize_with = "number", skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
}

/// An external load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LoadSpec {
    /// A constant traction on a boundary.
    Traction(#[serde(deserialize_with = "object")] TractionSpec),
    /// A force at a node.
    Force(#[serde(deserialize_with = "object")] ForceSpec),
    /// A constant body force [x, y], in force per volume.
    BodyForce([f64; 2]),
}

/// A constant traction on a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TractionSpec {
    /// The boundary.
    pub boundary: String,
    /// The traction [x, y], in force per area.
    pub value: [f64; 2],
}

/// A force at a node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForceSpec {
    /// The point [x, y]; there must be a node.
    pub at: [f64; 2],
    /// The force [x, y].
    pub value: [f64; 2],
}

/// A rigid, frictionless obstacle and the boundary that may touch it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
}

/// How a candidate node's contact row is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// Along the approach direction: `u . approach <= distance along it`; one entry per row.
    #[default]
    Approach,
    /// Along the obstacle's normal at the point closest to the node: `n . u <= distance`; two entries per row.
    ClosestPoint,
}

/// The surface of an obstacle, over the coordinate across the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
}

/// A plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// A point of the plane.
    pub point: [f64; 2],
    /// Its normal, pointing into the obstacle: on the side of the approach direction. Of any length but zero.
    pub normal: [f64; 2],
}

/// A parabola.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParabolaSpec {
    /// The point nearest to the body.
    pub apex: [f64; 2],
    /// Radius of curvature at the apex, positive.
    pub radius: f64,
}

/// A circle, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WedgeSpec {
    /// The point nearest to the body.
    pub apex: [f64; 2],
    /// Slope of both flanks away from the body, positive.
    pub slope: f64,
}

/// A polyline through points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// At least two points [x, y], increasing in the coordinate across the approach direction, from the first
    /// candidate to the last or further.
    pub points: Vec<[f64; 2]>,
}
