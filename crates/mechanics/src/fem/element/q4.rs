//! Q4, the bilinear quadrilateral: N_a = (1 + xi_a xi)(1 + eta_a eta)/4, integrated with 2 x 2 Gauss points.

use super::product::{multilinear, multilinear_slopes};
use super::q8::CORNERS;
use super::quadrature::SQUARE_2X2;
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape};

/// The bilinear quadrilateral.
pub(super) static Q4: ReferenceElement = ReferenceElement {
    name: "Q4",
    form: Shape::Product,
    dimension: 2,
    nodes: &CORNERS,
    corners: 4,
    mid_sides: &[],
    faces: &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
    along: &[0, 1, 2, 3],
    shape: |at| multilinear(&CORNERS, at),
    derivative: |at| multilinear_slopes(&CORNERS, at),
    quadrature: &SQUARE_2X2,
    quadrature_revolved: &SQUARE_2X2,
    facet: FacetKind::Line2,
    gmsh: 3,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 9,
    calculix: CalculixCell { number: 9, order: &[0, 1, 2, 3], points: &SQUARE_2X2, layers: 2 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 4.0, neighbours: 9.0 },
};
