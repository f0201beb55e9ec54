//! Hex8, the trilinear hexahedron: N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta)/8, 2 x 2 x 2 Gauss points.

use super::hex20::CORNERS;
use super::product::{multilinear, multilinear_slopes};
use super::quadrature::CUBE_2X2X2;
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape};

/// The trilinear hexahedron.
pub(super) static HEX8: ReferenceElement = ReferenceElement {
    name: "Hex8",
    form: Shape::Product,
    dimension: 3,
    nodes: &CORNERS,
    corners: 8,
    mid_sides: &[],
    faces: &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    along: &[0, 1, 2, 3, 4, 5, 6, 7],
    shape: |at| multilinear(&CORNERS, at),
    derivative: |at| multilinear_slopes(&CORNERS, at),
    quadrature: &CUBE_2X2X2,
    quadrature_revolved: &CUBE_2X2X2,
    facet: FacetKind::Q4,
    gmsh: 5,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7],
    vtk: 12,
    calculix: CalculixCell { number: 1, order: &[0, 1, 2, 3, 4, 5, 6, 7], points: &CUBE_2X2X2, layers: 1 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 8.0, neighbours: 27.0 },
};
