//! Ties, springs and reference points as they are written in a scene: sums of displacements.

use super::condition::{PlaceSpec, RotationSpec};
use crate::scene::input::names;

specs! {
/// One tie of displacements: between two surfaces, or by an equation.
pub enum TieSpec {
    /// Two surfaces that move together in all directions.
    Surfaces(TiedSurfacesSpec),
    /// One linear equation between displacements of nodes.
    Equation(EquationSpec),
    /// Two faces of a bolt that is cut across: they move together along the faces, and are drawn together.
    Preload(PreloadSpec),
    /// Nodes that move with a reference point.
    Coupling(CouplingSpec),
}

/// Two surfaces that stay together, in the mean over the area of each node of one of them. Their meshes need not match.
/// The softer body, or the one with the smaller facets, takes the means.
pub struct TiedSurfacesSpec {
    /// The boundary of one body.
    pub boundary: String,
    /// The boundary of the other.
    pub to: String,
    /// The largest distance, positive, at which the surfaces are tied; one length of a facet if it is left out.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reach: Option<f64>,
}

/// The preload of a bolt that is cut across: the two faces of the cut move together along themselves, and towards each
/// other by one shortening. Their meshes need not match. Give a force, a shortening or a point.
pub struct PreloadSpec {
    /// The face of the cut on one part of the bolt.
    pub boundary: String,
    /// The face on the other part, at the same place.
    pub to: String,
    /// The tension in the bolt, positive if it draws the parts together, in force; of the modelled part.
    pub force: Option<f64>,
    /// The length by which the bolt is shortened.
    pub shortening: Option<f64>,
    /// The name of a reference point that stands for the bolt: its displacement along x is the shortening, its force
    /// along x the tension.
    pub point: Option<String>,
    /// The direction from the first part to the other, of any length: it points out of the first part. If it is left
    /// out, it is the mean outward normal of the face.
    pub direction: Option<Vec<f64>>,
}

/// Nodes that follow a reference point as those of a rigid body, or whose mean motion the point follows. Couplings to
/// one point join their nodes, also those of several bodies.
pub struct CouplingSpec {
    /// The name of the point.
    pub point: String,
    /// The boundary that is coupled; `nodes` instead of it.
    pub boundary: Option<String>,
    /// The coupled nodes: those of a set, or of several, of a deck.
    #[serde(default, with = "names", skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "names::schema")]
    pub nodes: Vec<String>,
    /// `true` if the point follows the mean motion over the area of the boundary, so that the body stays soft there.
    #[serde(default)]
    pub mean: bool,
}

/// An equation: the sum of the terms is the value.
pub struct EquationSpec {
    /// Displacements of nodes and motions of points, each with its coefficients.
    pub terms: Vec<TermSpec>,
    /// The value, in length; 0 if it is left out.
    #[serde(default)]
    pub value: f64,
}

/// The displacement of one node, or the motion of one reference point: the sum of its components times their
/// coefficients, which are dimensionless; lengths for rotations.
pub struct TermSpec {
    /// The node or the reference point.
    pub on: TermPlace,
    /// The coefficient of the displacement along x.
    #[serde(default)]
    pub x: f64,
    /// The coefficient of the displacement along y.
    #[serde(default)]
    pub y: f64,
    /// The coefficient of the displacement along z.
    #[serde(default)]
    pub z: f64,
    /// The coefficients of the rotations of a reference point.
    #[serde(default, skip_serializing_if = "Turns::is_none")]
    pub rotation: Turns,
}

/// The node or the reference point of a term.
pub enum TermPlace {
    /// The only node of a named boundary.
    Boundary(String),
    /// The node at these coordinates.
    Point(Vec<f64>),
    /// A node of a deck, by its number, or a set with one node.
    #[serde(with = "names")]
    #[schemars(schema_with = "names::schema")]
    Nodes(Vec<String>),
    /// The name of a reference point.
    Reference(String),
}

/// Coefficients of rotations, in length.
#[derive(Copy, Default)]
#[serde(default)]
pub struct Turns {
    /// Of the rotation about x, in space.
    pub x: f64,
    /// Of the rotation about y, in space.
    pub y: f64,
    /// Of the rotation about z.
    pub z: f64,
}
}

impl Turns {
    fn is_none(&self) -> bool {
        *self == Turns::default()
    }
}

specs! {
/// Springs, which act in tension and compression: between the body and the ground at a node, or spread over a boundary
/// as an elastic foundation; or between nodes.
///
/// A direction that is left out has no spring.
#[serde(rename_all = "kebab-case")]
pub struct SpringSpec {
    /// The place of a spring to the ground.
    pub on: Option<PlaceSpec>,
    /// The elongation of a spring between nodes, instead of `on`: the sum of these terms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<TermSpec>,
    /// Stiffness along the elongation that the terms give, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub along: Option<f64>,
    /// Stiffness along x, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub x: Option<f64>,
    /// Stiffness along y, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub y: Option<f64>,
    /// Stiffness along z, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub z: Option<f64>,
    /// Stiffness along the normal of the boundary at every place, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub normal: Option<f64>,
    /// The reference of the stiffnesses.
    #[serde(default)]
    pub stiffness: StiffnessOf,
}

/// The reference of a stiffness on a boundary.
#[derive(Copy, Default, Eq)]
pub enum StiffnessOf {
    /// The whole spring, in force per length; on a boundary it is distributed evenly over its area.
    #[default]
    Total,
    /// A foundation, in force per length and area.
    PerArea,
}

/// A reference point: it has displacements and small rotations, and is no node of a mesh. Couplings, equations and
/// springs join it to nodes and to other points. Components that are not prescribed follow from the force and the
/// moment.
pub struct PointSpec {
    /// The name, by which ties and springs name it.
    pub name: String,
    /// Its place, about which it turns.
    pub at: Vec<f64>,
    /// Displacement of the point along x, if it is prescribed, in length.
    pub x: Option<f64>,
    /// Displacement of the point along y, if it is prescribed, in length.
    pub y: Option<f64>,
    /// Displacement of the point along z, if it is prescribed, in length.
    pub z: Option<f64>,
    /// Rotations of the point that are prescribed.
    pub rotation: Option<RotationSpec>,
    /// The force on the point; zero if left out.
    pub force: Option<Vec<f64>>,
    /// The moment on the point: about z in the plane, three components in space; zero if left out.
    pub moment: Option<Vec<f64>>,
}
}
