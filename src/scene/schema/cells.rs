//! Cells of a mesh: along an axis, towards a place of contact, their element, its integration.

use serde::{Deserialize, Serialize};

use crate::fem::mesh::{ElementKind, Mesh, Zone};

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

/// The finely meshed zone around the lowest (highest) point of a round body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ZoneSpec {
    /// How far the cells of one size reach from the lowest point, to each side and into the body: positive, at most the
    /// radius. Twice the expected contact half-width is a good choice.
    pub width: f64,
    /// Cells on this width, at least 1.
    pub divisions: usize,
    /// Size of each further cell over that of its neighbour towards the zone, from 1 to 10.
    #[serde(default = "growth")]
    pub growth: f64,
}

fn growth() -> f64 {
    1.2
}

/// The half of a disc or a ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum HalfSpec {
    /// Below the centre.
    #[default]
    Lower,
    /// Above the centre.
    Upper,
}

impl AxisSpec {
    /// Cells from end to end.
    pub(in crate::scene) fn cells(&self) -> usize {
        self.divisions.iter().fold(0, |sum: usize, &cells| sum.saturating_add(cells))
    }

    /// From the first point to the last; 0 if there are none.
    pub(in crate::scene) fn length(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Cuts every cell into `times`; graded axes are nested.
    pub(in crate::scene) fn refine(&mut self, times: usize) {
        // The size of cell after cell grows by q = ratio^(1/(n - 1)); in the finer mesh by the times-th root of it.
        for (ratio, &cells) in self.ratios.iter_mut().zip(&self.divisions) {
            if cells > 1 {
                let finer = cells.saturating_mul(times) - 1;
                *ratio = ratio.powf(finer as f64 / (times as f64 * (cells - 1) as f64));
            }
        }
        self.divisions.iter_mut().for_each(|cells| *cells = cells.saturating_mul(times));
    }
}

impl ZoneSpec {
    pub(in crate::scene) fn zone(&self) -> Zone {
        Zone { width: self.width, divisions: self.divisions, growth: self.growth }
    }

    /// Cuts every cell into `times`.
    pub(in crate::scene) fn refine(&mut self, times: usize) {
        self.divisions = self.divisions.saturating_mul(times);
        self.growth = self.growth.powf(1.0 / times as f64);
    }
}

impl ElementSpec {
    pub(in crate::scene) fn kind(self) -> ElementKind {
        match self {
            ElementSpec::T3 => ElementKind::T3,
            ElementSpec::T6 => ElementKind::T6,
            ElementSpec::Q4 => ElementKind::Q4,
            ElementSpec::Q8 => ElementKind::Q8,
        }
    }
}

impl SolidElementSpec {
    pub(in crate::scene) fn kind(self) -> ElementKind {
        match self {
            SolidElementSpec::Tet4 => ElementKind::Tet4,
            SolidElementSpec::Hex8 => ElementKind::Hex8,
        }
    }
}

impl HalfSpec {
    pub(in crate::scene) fn is_lower(&self) -> bool {
        *self == HalfSpec::Lower
    }

    /// The half of a body of which `lower` is the lower one, the cut lying where the coordinate `axis` is `centre`.
    pub(in crate::scene) fn of(self, lower: Mesh, axis: usize, centre: f64) -> Mesh {
        match self {
            HalfSpec::Lower => lower,
            HalfSpec::Upper => lower.mirrored(axis, centre),
        }
    }
}
