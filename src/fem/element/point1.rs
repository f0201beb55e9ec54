//! Point1, the end of a bar: N = 1.

use super::quadrature::POINT;
use super::reference::{FacetKind, LatticeCounts, ReferenceElement, Shape};

/// A single node.
pub(super) static POINT1: ReferenceElement = ReferenceElement {
    name: "Point1",
    form: Shape::Simplex,
    dimension: 0,
    nodes: &[[0.0; 3]],
    corners: 1,
    faces: &[],
    along: &[0],
    shape: |_| [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    derivative: |_| [[0.0; 3]; 8],
    quadrature: &POINT,
    quadrature_revolved: &POINT,
    centroid: [0.0; 3],
    facet: FacetKind::Point1,
    gmsh: 15,
    vtk: 1,
    counts: LatticeCounts::NONE,
};
