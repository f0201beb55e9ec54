//! Cells of a mesh: their element, and the half of a body that they fill.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fem::mesh::{ElementKind, Mesh};

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
        match self {
            ElementSpec::T3 => ElementKind::T3,
            ElementSpec::T6 => ElementKind::T6,
            ElementSpec::Q4 => ElementKind::Q4,
            ElementSpec::Q8 => ElementKind::Q8,
        }
    }
}

impl SolidElementSpec {
    /// Returns `true` for the default element of a scene.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn kind(self) -> ElementKind {
        match self {
            SolidElementSpec::Tet4 => ElementKind::Tet4,
            SolidElementSpec::Hex8 => ElementKind::Hex8,
            SolidElementSpec::Tet10 => ElementKind::Tet10,
            SolidElementSpec::Hex20 => ElementKind::Hex20,
        }
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
