//! Tet4, the linear tetrahedron: N = (1 - xi - eta - zeta, xi, eta, zeta); strain and stress are constant.

use super::quadrature::TETRAHEDRON_1;
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape};
use super::simplex::{linear, linear_slopes};

/// The corners, which are those of the quadratic tetrahedron too.
pub(super) const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The linear tetrahedron.
pub(super) static TET4: ReferenceElement = ReferenceElement {
    name: "Tet4",
    form: Shape::Simplex,
    dimension: 3,
    nodes: &CORNERS,
    corners: 4,
    mid_sides: &[],
    faces: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    along: &[0, 1, 2, 3],
    shape: |at| linear(4, at),
    derivative: |_| linear_slopes(4),
    quadrature: &TETRAHEDRON_1,
    quadrature_revolved: &TETRAHEDRON_1,
    facet: FacetKind::T3,
    gmsh: 4,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 10,
    calculix: CalculixCell { number: 3, order: &[0, 1, 2, 3], points: &TETRAHEDRON_1, layers: 1 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 24.0, neighbours: 15.0 },
};
