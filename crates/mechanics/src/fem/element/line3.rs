//! Line3, the quadratic edge: N = (xi (xi - 1)/2, xi (xi + 1)/2, 1 - xi^2), ends first.

use super::quadrature::INTERVAL_3;
use super::reference::{CalculixCell, FacetKind, LatticeCounts, PerNode, ReferenceElement, Shape, padded};

/// The quadratic line.
pub(super) static LINE3: ReferenceElement = ReferenceElement {
    name: "Line3",
    form: Shape::Product,
    dimension: 1,
    nodes: &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    corners: 2,
    mid_sides: &[[0, 1]],
    faces: &[&[0], &[1]],
    along: &[0, 2, 1],
    shape,
    derivative,
    quadrature: &INTERVAL_3,
    quadrature_revolved: &INTERVAL_3,
    facet: FacetKind::Point1,
    gmsh: 8,
    gmsh_order: &[0, 1, 2],
    vtk: 21,
    calculix: CalculixCell { number: 12, order: &[0, 2, 1], points: &INTERVAL_3, layers: 1 },
    counts: LatticeCounts::NONE,
};

fn shape([xi, ..]: [f64; 3]) -> PerNode<f64> {
    padded([xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, (1.0 - xi) * (1.0 + xi)])
}

fn derivative([xi, ..]: [f64; 3]) -> PerNode<[f64; 3]> {
    padded([xi - 0.5, xi + 0.5, -2.0 * xi].map(|slope| [slope, 0.0, 0.0]))
}
