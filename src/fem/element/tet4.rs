//! Tet4, the linear tetrahedron: N = (1 - xi - eta - zeta, xi, eta, zeta); strain and stress are constant.

use super::quadrature::TETRAHEDRON_1;
use super::reference::{FacetKind, LatticeCounts, MAX_NODES, PerNode, ReferenceElement, Shape};

/// The linear tetrahedron.
pub(super) static TET4: ReferenceElement = ReferenceElement {
    name: "Tet4",
    form: Shape::Simplex,
    dimension: 3,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    corners: 4,
    mid_sides: &[],
    faces: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    along: &[0, 1, 2, 3],
    shape,
    derivative,
    quadrature: &TETRAHEDRON_1,
    quadrature_revolved: &TETRAHEDRON_1,
    centroid: [0.25; 3],
    facet: FacetKind::T3,
    gmsh: 4,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 10,
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 24.0, neighbours: 15.0 },
};

fn shape([xi, eta, zeta]: [f64; 3]) -> PerNode<f64> {
    let mut values = [0.0; MAX_NODES];
    values[..4].copy_from_slice(&[1.0 - xi - eta - zeta, xi, eta, zeta]);
    values
}

fn derivative(_: [f64; 3]) -> PerNode<[f64; 3]> {
    let mut slopes = [[0.0; 3]; MAX_NODES];
    slopes[..4].copy_from_slice(&[[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    slopes
}
