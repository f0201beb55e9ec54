//! Q4, the bilinear quadrilateral: N_a = (1 + xi_a xi)(1 + eta_a eta)/4, integrated with 2 x 2 Gauss points.

use super::quadrature::SQUARE_2X2;
use super::reference::{FacetKind, LatticeCounts, MAX_NODES, PerNode, ReferenceElement, Shape};

const CORNERS: [[f64; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

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
    shape,
    derivative,
    quadrature: &SQUARE_2X2,
    quadrature_revolved: &SQUARE_2X2,
    centroid: [0.0; 3],
    facet: FacetKind::Line2,
    gmsh: 3,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 9,
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 4.0, neighbours: 9.0 },
};

fn shape([xi, eta, _]: [f64; 3]) -> PerNode<f64> {
    let mut values = [0.0; MAX_NODES];
    for (value, [a, b, _]) in values.iter_mut().zip(CORNERS) {
        *value = (1.0 + a * xi) * (1.0 + b * eta) / 4.0;
    }
    values
}

fn derivative([xi, eta, _]: [f64; 3]) -> PerNode<[f64; 3]> {
    let mut slopes = [[0.0; 3]; MAX_NODES];
    for (slope, [a, b, _]) in slopes.iter_mut().zip(CORNERS) {
        *slope = [a * (1.0 + b * eta) / 4.0, b * (1.0 + a * xi) / 4.0, 0.0];
    }
    slopes
}
