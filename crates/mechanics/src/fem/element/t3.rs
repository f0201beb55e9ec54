//! T3, the linear triangle: N = (1 - xi - eta, xi, eta); strain and stress are constant in the plane.

use super::quadrature::{TRIANGLE_1, TRIANGLE_3};
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape};
use super::simplex::{linear, linear_slopes};

/// The linear triangle.
///
/// In a body of revolution it takes three points: with one point, a rotation about the centroid would have no strain
/// energy.
pub(super) static T3: ReferenceElement = ReferenceElement {
    name: "T3",
    form: Shape::Simplex,
    dimension: 2,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    corners: 3,
    mid_sides: &[],
    faces: &[&[0, 1], &[1, 2], &[2, 0]],
    along: &[0, 1, 2],
    shape: |at| linear(3, at),
    derivative: |_| linear_slopes(3),
    quadrature: &TRIANGLE_1,
    quadrature_revolved: &TRIANGLE_3,
    facet: FacetKind::Line2,
    gmsh: 2,
    gmsh_order: &[0, 1, 2],
    vtk: 5,
    calculix: CalculixCell { number: 7, order: &[0, 1, 2], points: &TRIANGLE_1, layers: 2 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 6.0, neighbours: 7.0 },
};
