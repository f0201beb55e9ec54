//! Loads, supports, rigid faces, planes of symmetry and factors over space as they are written in a scene.

use std::collections::BTreeMap;

use crate::scene::input::names;

specs! {
/// An external load. Body forces, gravity and centrifugal forces act on all bodies.
pub enum LoadSpec {
    /// A traction on a boundary.
    Traction(TractionSpec),
    /// A pressure on a boundary, against its outward normal.
    Pressure(PressureSpec),
    /// A force at a node, or on a boundary.
    Force(ForceSpec),
    /// Forces on nodes of a deck: for each name of a set or number of a node the force that each of its nodes carries.
    /// They add up.
    NodalForces(BTreeMap<String, Vec<f64>>),
    /// A moment on a boundary.
    Moment(MomentSpec),
    /// A constant body force, in force per volume.
    BodyForce(Vec<f64>),
    /// The acceleration of gravity, in length per time squared: a body force of density times acceleration. Needs a
    /// density.
    Gravity(Vec<f64>),
    /// The centrifugal force of a rotation. Needs a density.
    Centrifugal(CentrifugalSpec),
}
}

impl LoadSpec {
    /// Returns `true` for a force at a single point.
    pub fn is_at_point(&self) -> bool {
        matches!(self, LoadSpec::Force(ForceSpec { at: Some(_), .. }))
    }

    /// Returns `true` for forces at one point or several.
    #[doc(hidden)]
    pub fn is_at_points(&self) -> bool {
        self.is_at_point() || matches!(self, LoadSpec::NodalForces(_))
    }
}

specs! {
/// A force per area on a boundary, constant or with a profile.
pub struct TractionSpec {
    /// The boundary that the traction acts on.
    pub boundary: String,
    /// The traction, in force per area.
    pub value: Vec<f64>,
    /// A factor for the traction that changes along a direction.
    pub profile: Option<ProfileSpec>,
}

/// A pressure on a boundary.
pub struct PressureSpec {
    /// The boundary that the pressure acts on.
    pub boundary: String,
    /// The pressure, in force per area; a positive pressure pushes on the body.
    pub value: f64,
    /// A factor for the pressure that changes along a direction.
    pub profile: Option<ProfileSpec>,
}

/// A force at a node, or spread over a boundary as a constant traction.
pub struct ForceSpec {
    /// The point; a node must lie there.
    pub at: Option<Vec<f64>>,
    /// The boundary, instead of a point.
    pub boundary: Option<String>,
    /// The force on the whole thickness, or on the full circle of a body of revolution; its radial component is summed
    /// around the circle.
    pub value: Vec<f64>,
}

/// A moment on a boundary: a traction proportional to the distance from the centre of the boundary, at right angles to
/// the vector from there and to an axis; on a flat end it is the traction of pure bending. Its force is zero, so that
/// its moment is the same about every point.
pub struct MomentSpec {
    /// The boundary; required.
    #[serde(default)]
    #[schemars(required)]
    pub boundary: Option<String>,
    /// Refused: a node of a solid has no rotation, and cannot carry a moment.
    #[schemars(skip)]
    pub at: Option<Vec<f64>>,
    /// The moment, in force times length: `[m]` about z in the plane, on the whole thickness, counterclockwise; three
    /// components in space.
    pub value: Vec<f64>,
}

/// The centrifugal force of a rotation: density times the square of omega times the vector from the axis.
///
/// In a plane model the axis is normal to the plane; in an axisymmetric model it is the axis of revolution.
pub struct CentrifugalSpec {
    /// The angular velocity, in radians per time.
    pub omega: f64,
    /// The direction of the axis, of any length except zero; only in space, and required there.
    pub axis: Option<Vec<f64>>,
    /// A point on the axis; the origin if left out; not in an axisymmetric model.
    pub point: Option<Vec<f64>>,
}

/// A factor that changes along a direction: straight lines between places, constant beyond the first and the last.
pub struct ProfileSpec {
    /// The direction, of any length except zero.
    pub along: Vec<f64>,
    /// Places along it, at least one, increasing: distances from the plane through the origin normal to the direction.
    #[schemars(extend("minItems" = 1))]
    pub places: Vec<f64>,
    /// The factor at each place.
    #[schemars(extend("minItems" = 1))]
    pub factors: Vec<f64>,
}

/// The place on the body.
#[schemars(rename = "Place")]
pub enum PlaceSpec {
    /// All nodes of a named boundary.
    Boundary(String),
    /// The node at this point.
    Point(Vec<f64>),
    /// The nodes of a set, or of several, of a deck; a node is named by its number.
    #[serde(with = "names")]
    #[schemars(schema_with = "names::schema")]
    Nodes(Vec<String>),
}

/// A support: a direction that is left out is free; a number is the prescribed displacement.
///
/// A `normal` makes it a roller on an inclined plane: the component of the displacement along it is prescribed, the
/// components along the plane are free. In an axisymmetric model the plane is a cone.
pub struct SupportSpec {
    pub on: PlaceSpec,
    /// Prescribed displacement along x.
    pub x: Option<f64>,
    /// Prescribed displacement along y.
    pub y: Option<f64>,
    /// Prescribed displacement along z.
    pub z: Option<f64>,
    /// Normal of an inclined plane, of either sense and of any length except zero.
    pub normal: Option<Vec<f64>>,
    /// Prescribed displacement along the normal, in length; 0 if left out.
    pub value: Option<f64>,
    /// A factor for all these displacements that changes along a direction.
    pub profile: Option<ProfileSpec>,
}

/// A plane of symmetry, given by the axis normal to it. It lies at the flat end of the body, at zero if the body has a
/// flat end there.
#[derive(Copy, Eq)]
pub enum SymmetryPlane {
    /// Normal to x.
    X,
    /// Normal to y.
    Y,
    /// Normal to z.
    Z,
}
}

impl SymmetryPlane {
    /// The axis normal to the plane, 0 to 2.
    pub fn axis(self) -> usize {
        self as usize
    }

    /// The axis normal to the plane, as a scene writes it.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.axis()]
    }
}

specs! {
/// A boundary that moves as a rigid plate: a displacement of its centre and a rotation about it. Components that are
/// not prescribed follow from the force and the moment.
pub struct RigidFaceSpec {
    /// The boundary, or `nodes` instead.
    pub boundary: Option<String>,
    /// The nodes of a set, or of several, of a deck.
    #[serde(default, with = "names", skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "names::schema")]
    pub nodes: Vec<String>,
    /// The centre of rotation, at which the force acts; the centroid of the boundary's area, or the mean of the
    /// nodes, if left out.
    pub centre: Option<Vec<f64>>,
    /// Prescribed displacement of the centre along x.
    pub x: Option<f64>,
    /// Prescribed displacement of the centre along y.
    pub y: Option<f64>,
    /// Prescribed displacement of the centre along z.
    pub z: Option<f64>,
    /// Prescribed rotations about the centre.
    pub rotation: Option<RotationSpec>,
    /// The force on it; zero if left out.
    pub force: Option<Vec<f64>>,
    /// The moment on it about the centre: about z in the plane, three components in space; zero if left out.
    pub moment: Option<Vec<f64>>,
}

/// Prescribed rotations, in radians, small; a rotation that is left out is free.
#[derive(Default)]
pub struct RotationSpec {
    /// About x, in space.
    pub x: Option<f64>,
    /// About y, in space.
    pub y: Option<f64>,
    /// About z.
    pub z: Option<f64>,
}
}
