//! Q4, the bilinear quadrilateral: N_a = (1 + xi_a xi)(1 + eta_a eta)/4, integrated with 2 x 2 Gauss points.

use super::quadrature::SQUARE_2X2;
use super::{PerNode, ReferenceElement};

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// The bilinear function through the Gauss points, taken at a corner, is (1 +- sqrt 3)^2/4 or -1/2 of their values.
const NEAR: f64 = 1.866_025_403_784_438_6;
const ASIDE: f64 = -0.5;
const FAR: f64 = 0.133_974_596_215_561_35;

/// The bilinear quadrilateral.
pub static Q4: ReferenceElement = ReferenceElement {
    name: "Q4",
    nodes: &CORNERS,
    shape,
    derivative,
    quadrature: &SQUARE_2X2,
    centroid: [0.0, 0.0],
    extrapolation: &[
        &[NEAR, ASIDE, FAR, ASIDE],
        &[ASIDE, NEAR, ASIDE, FAR],
        &[FAR, ASIDE, NEAR, ASIDE],
        &[ASIDE, FAR, ASIDE, NEAR],
    ],
};

fn shape([xi, eta]: [f64; 2]) -> PerNode<f64> {
    CORNERS.map(|[xi_a, eta_a]| (1.0 + xi_a * xi) * (1.0 + eta_a * eta) / 4.0)
}

fn derivative([xi, eta]: [f64; 2]) -> PerNode<[f64; 2]> {
    CORNERS.map(|[xi_a, eta_a]| [xi_a * (1.0 + eta_a * eta) / 4.0, eta_a * (1.0 + xi_a * xi) / 4.0])
}
