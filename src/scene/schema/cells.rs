//! Cells of a mesh: along an axis, their element, its integration.

use serde::{Deserialize, Serialize};

/// One axis of a structured mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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

/// The elements of the plane to choose from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SolidElementSpec {
    /// Linear tetrahedron.
    Tet4,
    /// Trilinear hexahedron.
    #[default]
    Hex8,
}

/// How the stiffness of an element is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IntegrationSpec {
    /// All of it at all quadrature points.
    #[default]
    Standard,
    /// The dilatation is replaced by its mean over the element: for `q4` and `hex8`, which then do not lock as
    /// Poisson's ratio nears 0.5.
    MeanDilatation,
}
