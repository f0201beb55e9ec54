//! Materials, parts of boundaries and further bodies as they are written in a scene.

use crate::scene::input::body::BodySpec;

specs! {
/// A linear elastic material: isotropic with `young` and `poisson`, or `orthotropic`.
pub struct MaterialSpec {
    /// Young's modulus, positive, in force per area.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<f64>,
    /// Poisson's ratio: above -1, at most 0.5 in a bar and in plane stress, below 0.5 elsewhere.
    #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 0.5))]
    pub poisson: Option<f64>,
    /// Elasticity with three planes of symmetry, instead of `young` and `poisson`.
    pub orthotropic: Option<OrthotropicSpec>,
    /// Thermal expansion in all directions, in strain per degree; needed for a `temperature`.
    pub expansion: Option<f64>,
    /// Density, positive, in mass per volume; needed for a dynamic analysis, gravity and centrifugal forces.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
}

/// Orthotropic elasticity, along the axes 1, 2, 3 of the material. These are x, y, z unless they are rotated; in an
/// axisymmetric model the radius, y and the hoop direction. A bar lies along axis 1.
pub struct OrthotropicSpec {
    /// Young's moduli `[E1, E2, E3]`, positive, in force per area.
    #[schemars(extend("items" = {"type": "number", "format": "double", "exclusiveMinimum": 0}))]
    pub young: [f64; 3],
    /// Poisson's ratios `[nu12, nu23, nu13]`: tension along i contracts the material along j by nu_ij times its
    /// extension, and nu_ij/E_i = nu_ji/E_j. The stiffness must be positive definite.
    pub poisson: [f64; 3],
    /// Shear moduli `[G12, G23, G13]`, positive, in force per area.
    #[schemars(extend("items" = {"type": "number", "format": "double", "exclusiveMinimum": 0}))]
    pub shear: [f64; 3],
    /// Thermal expansion along axes 1, 2, 3, in strain per degree.
    pub expansion: Option<[f64; 3]>,
    /// The angle from x to axis 1, counterclockwise, in degrees; only in plane and axisymmetric models.
    pub angle: Option<f64>,
    /// In space a vector along axis 1, and a second one: axis 2 lies in the plane of both vectors, at right angles to
    /// axis 1.
    pub axes: Option<[Vec<f64>; 2]>,
    /// A line around which the axes turn: axis 1 leads away from it, 2 around it, 3 along it.
    pub around: Option<LineSpec>,
}

/// A line in space, or, in the plane, a point.
pub struct LineSpec {
    /// A point on it.
    pub point: Vec<f64>,
    /// A vector along it, of any length; only in space, z if it is left out.
    pub along: Option<Vec<f64>>,
}

/// The material of a part of a body: of the elements of a group, of the elements with the centroid in a box, or of the
/// elements in both.
///
/// If several parts contain an element, the last one counts. The elements are chosen again on every mesh.
pub struct MaterialPartSpec {
    /// The physical group of the mesh file whose elements have this material.
    pub group: Option<String>,
    /// A box along the coordinate axes: its elements have this material.
    #[serde(rename = "box")]
    pub cuboid: Option<PartBoxSpec>,
    /// The material of these elements.
    pub material: MaterialSpec,
}

/// The temperature of a body above the stress-free one, or of its part in a group, in a box, or in both: `value` plus
/// the gradient times the position. If several entries contain an element, the last one counts; elements in no entry
/// are stress-free.
pub struct TemperatureSpec {
    /// The physical group of the mesh file whose elements have this temperature.
    pub group: Option<String>,
    /// A box along the coordinate axes: its elements have this temperature.
    #[serde(rename = "box")]
    pub cuboid: Option<PartBoxSpec>,
    /// The temperature difference at the origin, in degrees.
    pub value: f64,
    /// Its gradient, in degrees per length; zero if left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<f64>,
}

/// A stress that acts without strain, in a body or in its part in a group, in a box, or in both, in force per area;
/// tension is positive. If several entries contain an element, the last one counts.
///
/// Allowed components: xx in a bar; xx, yy, xy in plane stress; also zz in plane strain; also zz, the hoop stress, in
/// an axisymmetric body; all six in space.
#[derive(Default)]
#[serde(default)]
pub struct InitialStressSpec {
    /// The physical group of the mesh file whose elements have this stress.
    pub group: Option<String>,
    /// A box along the coordinate axes: its elements have this stress.
    #[serde(rename = "box")]
    pub cuboid: Option<PartBoxSpec>,
    /// Normal stress along x.
    pub xx: f64,
    /// Normal stress along y, positive in tension.
    pub yy: f64,
    /// Normal stress along z; in an axisymmetric model the hoop stress.
    pub zz: f64,
    /// Initial shear stress between x and y.
    pub xy: f64,
    /// Shear stress between y and z.
    pub yz: f64,
    /// Shear stress between z and x.
    pub zx: f64,
}

/// An elastic body besides the first, with the same model and thickness, and its own elements.
#[serde(rename_all = "kebab-case")]
pub struct FurtherBodySpec {
    /// Its name; its boundaries are called `name.boundary`.
    #[schemars(extend("minLength" = 1))]
    pub name: String,
    /// The body.
    pub body: BodySpec,
    /// The material of all elements outside `materials`.
    pub material: Option<MaterialSpec>,
    /// The materials of its parts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<MaterialPartSpec>,
    /// Its temperatures above the stress-free one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub temperature: Vec<TemperatureSpec>,
    /// Stresses that act without strain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub initial_stress: Vec<InitialStressSpec>,
}

/// A part of a boundary: all its facets with the centroid in the box and in the sphere, and with the outward normal
/// around the direction. A condition that is left out is always met.
///
/// The facets are chosen again on every mesh: a part that ends within a facet changes with the mesh.
pub struct PartSpec {
    /// Its name: a boundary for supports, loads, obstacles and later parts.
    #[schemars(extend("minLength" = 1))]
    pub name: String,
    /// The boundary, or a further body to choose its whole surface; the whole surface of the first body if left out.
    pub of: Option<String>,
    /// A box along the coordinate axes that contains the centroids of the facets.
    #[serde(rename = "box")]
    pub cuboid: Option<PartBoxSpec>,
    /// A sphere; in the plane a circle.
    pub sphere: Option<PartSphereSpec>,
    /// Directions of outward normals.
    pub normal: Option<PartNormalSpec>,
}

/// A box along the coordinate axes.
pub struct PartBoxSpec {
    /// Its smallest coordinates.
    pub min: Vec<f64>,
    /// Its largest coordinates, none below the smallest.
    pub max: Vec<f64>,
}

/// A sphere.
pub struct PartSphereSpec {
    /// The centre of the sphere.
    pub centre: Vec<f64>,
    /// Its radius, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// Directions around a given one.
pub struct PartNormalSpec {
    /// The direction in their middle, of any length except zero.
    pub direction: Vec<f64>,
    /// The largest angle to this direction, in degrees, from 0 to 180.
    #[schemars(extend("minimum" = 0, "maximum" = 180))]
    pub within: f64,
}
}
