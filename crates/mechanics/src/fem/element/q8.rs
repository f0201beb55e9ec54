//! Q8, the serendipity quadrilateral, integrated with 3 x 3 Gauss points:
//! N = (1 + xi_a xi)(1 + eta_a eta)(xi_a xi + eta_a eta - 1)/4 at corners, (1 - xi^2)(1 + eta_a eta)/2 or
//! (1 + xi_a xi)(1 - eta^2)/2 at the mid-sides.

use super::quadrature::SQUARE_3X3;
use super::reference::{
    CalculixCell, FacetKind, LatticeCounts, PerNode, ReferenceElement, Shape, padded, with_middles,
};

/// The two corners of each of the 4 sides, in the order of the mid-side nodes.
const SIDES: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];

/// The corners, which are those of the bilinear quadrilateral too.
pub(super) const CORNERS: [[f64; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

/// Coordinates of the 4 corners, then of the 4 mid-side nodes.
const NODES: [[f64; 3]; 8] = with_middles(CORNERS, SIDES);

/// The serendipity quadrilateral.
pub(super) static Q8: ReferenceElement = ReferenceElement {
    name: "Q8",
    form: Shape::Product,
    dimension: 2,
    nodes: &NODES,
    corners: 4,
    mid_sides: &SIDES,
    faces: &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]],
    along: &[0, 1, 2, 3, 4, 5, 6, 7],
    shape,
    derivative,
    quadrature: &SQUARE_3X3,
    quadrature_revolved: &SQUARE_3X3,
    facet: FacetKind::Line3,
    gmsh: 16,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7],
    vtk: 23,
    calculix: CalculixCell { number: 10, order: &[0, 1, 2, 3, 4, 5, 6, 7], points: &SQUARE_3X3, layers: 3 },
    counts: LatticeCounts { nodes: 3.0, line: 2.0, connections: 8.0, neighbours: 15.5 },
};

fn shape([xi, eta, _]: [f64; 3]) -> PerNode<f64> {
    padded(NODES.map(|[a, b, _]| {
        if a == 0.0 {
            (1.0 - xi) * (1.0 + xi) * (1.0 + b * eta) / 2.0
        } else if b == 0.0 {
            (1.0 + a * xi) * (1.0 - eta) * (1.0 + eta) / 2.0
        } else {
            (1.0 + a * xi) * (1.0 + b * eta) * (a * xi + b * eta - 1.0) / 4.0
        }
    }))
}

fn derivative([xi, eta, _]: [f64; 3]) -> PerNode<[f64; 3]> {
    padded(NODES.map(|[a, b, _]| {
        if a == 0.0 {
            [-xi * (1.0 + b * eta), b * (1.0 - xi) * (1.0 + xi) / 2.0, 0.0]
        } else if b == 0.0 {
            [a * (1.0 - eta) * (1.0 + eta) / 2.0, -eta * (1.0 + a * xi), 0.0]
        } else {
            let (along_xi, along_eta) = (2.0 * a * xi + b * eta, a * xi + 2.0 * b * eta);
            [a * (1.0 + b * eta) * along_xi / 4.0, b * (1.0 + a * xi) * along_eta / 4.0, 0.0]
        }
    }))
}
