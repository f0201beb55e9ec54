//! The space of a model, the cells of its mesh, and the sides from which obstacles come.

use crate::fem::mesh::{ElementKind, Mesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The space of a model, and the assumption for the directions that it leaves out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelSpec {
    /// A bar along x; no stress across it.
    Bar,
    /// No strain across the plane: a long body.
    #[default]
    PlaneStrain,
    /// No stress across the plane: a thin body.
    PlaneStress,
    /// A body of revolution about the y axis; x is the radius; forces are those of the full circle.
    Axisymmetric,
    /// Three dimensions.
    Space,
}

impl ModelSpec {
    /// The model as a scene writes it, such as `plane-strain`.
    pub fn name(self) -> &'static str {
        ["bar", "plane-strain", "plane-stress", "axisymmetric", "space"][self as usize]
    }

    /// Coordinates of a point: 1 in a bar, 2 in plane and axisymmetric models, 3 in space.
    pub fn dimension(self) -> usize {
        [1, 2, 2, 2, 3][self as usize]
    }
}

/// The factor that changes nothing, if a scene leaves it out.
pub(crate) fn one() -> f64 {
    1.0
}

/// The elements of the plane to choose from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ElementSpec {
    /// Linear triangle.
    T3,
    /// Quadratic triangle.
    T6,
    /// Bilinear quadrilateral.
    #[default]
    Q4,
    /// Quadratic quadrilateral of eight nodes.
    Q8,
}

/// The elements of space to choose from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SolidElementSpec {
    /// Linear tetrahedron.
    Tet4,
    /// Trilinear hexahedron.
    #[default]
    Hex8,
    /// Quadratic tetrahedron of ten nodes.
    Tet10,
    /// Quadratic hexahedron of 20 nodes.
    Hex20,
}

/// The half of a disc or a ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HalfSpec {
    /// Below the centre.
    #[default]
    Lower,
    /// Above the centre.
    Upper,
}

impl ElementSpec {
    pub(crate) fn kind(self) -> ElementKind {
        [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8][self as usize]
    }
}

impl SolidElementSpec {
    /// Returns `true` for the default element of a scene.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn kind(self) -> ElementKind {
        [ElementKind::Tet4, ElementKind::Hex8, ElementKind::Tet10, ElementKind::Hex20][self as usize]
    }
}

impl HalfSpec {
    pub(crate) fn is_lower(&self) -> bool {
        *self == HalfSpec::Lower
    }

    /// This half of a body, from its lower half `lower`; the cut lies where the coordinate `axis` is `centre`.
    pub(crate) fn of(self, lower: Mesh, axis: usize, centre: f64) -> Mesh {
        match self {
            HalfSpec::Lower => lower,
            HalfSpec::Upper => lower.mirrored(axis, centre),
        }
    }
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
        (self as usize / 2, [1.0, -1.0][self as usize % 2])
    }

    /// The direction as a scene writes it, such as `-y`.
    pub fn name(self) -> &'static str {
        ["+x", "-x", "+y", "-y", "+z", "-z"][self as usize]
    }
}

/// The rule for the contact row of a candidate node: its direction, and the point of the obstacle that it meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// Along the approach direction: `u . approach <= distance along it`; one entry per row.
    #[default]
    Approach,
    /// Along the obstacle's normal at the point closest to the node: `n . u <= distance`; one entry per coordinate.
    ClosestPoint,
}
