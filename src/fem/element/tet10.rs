//! Tet10, the quadratic tetrahedron: N = L_a (2 L_a - 1) at corners, 4 L_a L_b at the mid-sides,
//! L = (1 - xi - eta - zeta, xi, eta, zeta).

use super::quadrature::TETRAHEDRON_8;
use super::reference::{FacetKind, LatticeCounts, MAX_NODES, PerNode, ReferenceElement, Shape};

/// The corners between which each mid-side node lies.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// The slopes of the barycentric coordinates.
const SLOPES: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

const NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

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
    shape,
    derivative,
    quadrature: &TETRAHEDRON_8,
    quadrature_revolved: &TETRAHEDRON_8,
    centroid: [0.25; 3],
    facet: FacetKind::T6,
    gmsh: 11,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    vtk: 24,
    counts: LatticeCounts { nodes: 8.0, line: 2.0, connections: 60.0, neighbours: 27.0 },
};

fn barycentric([xi, eta, zeta]: [f64; 3]) -> [f64; 4] {
    [1.0 - xi - eta - zeta, xi, eta, zeta]
}

fn shape(at: [f64; 3]) -> PerNode<f64> {
    let l = barycentric(at);
    let mut values = [0.0; MAX_NODES];
    for corner in 0..4 {
        values[corner] = l[corner] * (2.0 * l[corner] - 1.0);
    }
    for (edge, [a, b]) in EDGES.into_iter().enumerate() {
        values[4 + edge] = 4.0 * l[a] * l[b];
    }
    values
}

fn derivative(at: [f64; 3]) -> PerNode<[f64; 3]> {
    let l = barycentric(at);
    let mut slopes = [[0.0; 3]; MAX_NODES];
    for axis in 0..3 {
        for corner in 0..4 {
            slopes[corner][axis] = (4.0 * l[corner] - 1.0) * SLOPES[corner][axis];
        }
        for (edge, [a, b]) in EDGES.into_iter().enumerate() {
            slopes[4 + edge][axis] = 4.0 * (SLOPES[a][axis] * l[b] + l[a] * SLOPES[b][axis]);
        }
    }
    slopes
}
