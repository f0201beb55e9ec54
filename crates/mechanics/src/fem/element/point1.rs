//! Point1, the end of a bar: N = 1.

use super::quadrature::POINT;
use super::reference::{CalculixCell, FacetKind, LatticeCounts, MAX_NODES, ReferenceElement, Shape, padded};

/// A single node.
pub(super) static POINT1: ReferenceElement = ReferenceElement {
    name: "Point1",
    form: Shape::Simplex,
    dimension: 0,
    nodes: &[[0.0; 3]],
    corners: 1,
    mid_sides: &[],
    faces: &[],
    along: &[0],
    shape: |_| padded([1.0]),
    derivative: |_| [[0.0; 3]; MAX_NODES],
    quadrature: &POINT,
    quadrature_revolved: &POINT,
    facet: FacetKind::Point1,
    gmsh: 15,
    gmsh_order: &[0],
    vtk: 1,
    calculix: CalculixCell { number: 0, order: &[0], points: &POINT, layers: 1 },
    counts: LatticeCounts::NONE,
};
