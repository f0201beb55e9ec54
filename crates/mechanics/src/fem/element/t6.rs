//! T6, the quadratic triangle: N = L_a (2 L_a - 1) at corners, 4 L_a L_b at the mid-sides, L = (1 - xi - eta, xi, eta).

use super::quadrature::{TRIANGLE_3, TRIANGLE_6};
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape};
use super::simplex::{quadratic, quadratic_slopes};

/// The sides, each with the corners between which its mid-side node lies.
const SIDES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The quadratic triangle; its rule integrates the stiffness exactly if the sides are straight, in bodies of revolution
/// too, except the hoop terms.
pub(super) static T6: ReferenceElement = ReferenceElement {
    name: "T6",
    form: Shape::Simplex,
    dimension: 2,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]],
    corners: 3,
    mid_sides: &SIDES,
    faces: &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]],
    along: &[0, 1, 2, 3, 4, 5],
    shape: |at| quadratic(3, &SIDES, at),
    derivative: |at| quadratic_slopes(3, &SIDES, at),
    quadrature: &TRIANGLE_6,
    quadrature_revolved: &TRIANGLE_6,
    facet: FacetKind::Line3,
    gmsh: 9,
    gmsh_order: &[0, 1, 2, 3, 4, 5],
    vtk: 22,
    calculix: CalculixCell { number: 8, order: &[0, 1, 2, 3, 4, 5], points: &TRIANGLE_3, layers: 3 },
    counts: LatticeCounts { nodes: 4.0, line: 2.0, connections: 12.0, neighbours: 11.5 },
};
