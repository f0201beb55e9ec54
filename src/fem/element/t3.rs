//! T3, the linear triangle: N = (1 - xi - eta, xi, eta); strain and stress are constant in the plane.

use super::quadrature::{TRIANGLE_1, TRIANGLE_3};
use super::reference::{FacetKind, LatticeCounts, MAX_NODES, PerNode, ReferenceElement, Shape};

/// The linear triangle.
///
/// In a body of revolution it takes three points: with one point, a rotation about the centroid would have no strain energy.
pub(super) static T3: ReferenceElement = ReferenceElement {
    name: "T3",
    form: Shape::Simplex,
    dimension: 2,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    corners: 3,
    mid_sides: &[],
    faces: &[&[0, 1], &[1, 2], &[2, 0]],
    along: &[0, 1, 2],
    shape,
    derivative,
    quadrature: &TRIANGLE_1,
    quadrature_revolved: &TRIANGLE_3,
    centroid: [1.0 / 3.0, 1.0 / 3.0, 0.0],
    facet: FacetKind::Line2,
    gmsh: 2,
    gmsh_order: &[0, 1, 2],
    vtk: 5,
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 6.0, neighbours: 7.0 },
};

fn shape([xi, eta, _]: [f64; 3]) -> PerNode<f64> {
    let mut values = [0.0; MAX_NODES];
    values[..3].copy_from_slice(&[1.0 - xi - eta, xi, eta]);
    values
}

fn derivative(_: [f64; 3]) -> PerNode<[f64; 3]> {
    let mut slopes = [[0.0; 3]; MAX_NODES];
    slopes[..3].copy_from_slice(&[[-1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    slopes
}
