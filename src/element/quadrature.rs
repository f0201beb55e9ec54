//! Quadrature on the reference cells: the triangle (0,0), (1,0), (0,1) and the square [-1,1] x [-1,1].

/// A point of a quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// Reference coordinates.
    pub at: [f64; 2],
    /// Weight; the weights add up to the area of the reference cell.
    pub weight: f64,
}

const fn point(xi: f64, eta: f64, weight: f64) -> QuadraturePoint {
    QuadraturePoint { at: [xi, eta], weight }
}

/// 1/sqrt(3), the abscissa of the two-point Gauss rule.
const GAUSS_2: f64 = 0.577_350_269_189_625_8;

/// One point on the triangle, exact for linear functions.
pub(super) const TRIANGLE_1: [QuadraturePoint; 1] = [point(1.0 / 3.0, 1.0 / 3.0, 0.5)];

/// Two by two Gauss points on the square, exact for cubics in each direction; the order is that of the corners.
pub(super) const SQUARE_2X2: [QuadraturePoint; 4] = [
    point(-GAUSS_2, -GAUSS_2, 1.0),
    point(GAUSS_2, -GAUSS_2, 1.0),
    point(GAUSS_2, GAUSS_2, 1.0),
    point(-GAUSS_2, GAUSS_2, 1.0),
];
