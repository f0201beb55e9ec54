//! T3, the linear triangle: N = (1 - xi - eta, xi, eta); strain and stress are constant.

use super::quadrature::TRIANGLE_1;
use super::{PerNode, ReferenceElement};

/// The linear triangle.
pub static T3: ReferenceElement = ReferenceElement {
    name: "T3",
    nodes: &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    shape,
    derivative,
    quadrature: &TRIANGLE_1,
    centroid: [1.0 / 3.0, 1.0 / 3.0],
    extrapolation: &[&[1.0], &[1.0], &[1.0]],
};

fn shape([xi, eta]: [f64; 2]) -> PerNode<f64> {
    [1.0 - xi - eta, xi, eta, 0.0]
}

fn derivative(_: [f64; 2]) -> PerNode<[f64; 2]> {
    [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
}
