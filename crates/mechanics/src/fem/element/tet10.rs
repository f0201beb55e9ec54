//! Tet10, the quadratic tetrahedron: N = L_a (2 L_a - 1) at corners, 4 L_a L_b at the mid-sides,
//! L = (1 - xi - eta - zeta, xi, eta, zeta).

use super::quadrature::{TETRAHEDRON_4, TETRAHEDRON_8};
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape, with_middles};
use super::simplex::{quadratic, quadratic_slopes};
use super::tet4::CORNERS;

/// The two corners of each of the 6 edges, in the order of the mid-side nodes.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

const NODES: [[f64; 3]; 10] = with_middles(CORNERS, EDGES);

/// The quadratic tetrahedron; its rule integrates a constant stress over curved edges exactly.
pub(super) static TET10: ReferenceElement = ReferenceElement {
    name: "Tet10",
    form: Shape::Simplex,
    dimension: 3,
    nodes: &NODES,
    corners: 4,
    mid_sides: &EDGES,
    faces: &[&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[0, 3, 2, 7, 9, 6]],
    along: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9],
    shape: |at| quadratic(4, &EDGES, at),
    derivative: |at| quadratic_slopes(4, &EDGES, at),
    quadrature: &TETRAHEDRON_8,
    quadrature_revolved: &TETRAHEDRON_8,
    facet: FacetKind::T6,
    gmsh: 11,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    vtk: 24,
    calculix: CalculixCell { number: 6, order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], points: &TETRAHEDRON_4, layers: 1 },
    counts: LatticeCounts { nodes: 8.0, line: 2.0, connections: 60.0, neighbours: 27.0 },
};
