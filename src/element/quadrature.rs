//! Quadrature on the reference cells: point, interval [-1,1], square, cube, triangle and tetrahedron.

/// A point of a quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// Reference coordinates.
    pub at: [f64; 3],
    /// Weight; the weights add up to the size of the reference cell.
    pub weight: f64,
}

const fn point(xi: f64, eta: f64, zeta: f64, weight: f64) -> QuadraturePoint {
    QuadraturePoint { at: [xi, eta, zeta], weight }
}

/// 1/sqrt(3), the abscissa of the two-point Gauss rule.
const GAUSS_2: f64 = 0.577_350_269_189_625_8;

/// sqrt(3/5), the outer abscissa of the three-point Gauss rule.
const GAUSS_3: f64 = 0.774_596_669_241_483_4;

/// The value at a point.
pub(super) const POINT: [QuadraturePoint; 1] = [point(0.0, 0.0, 0.0, 1.0)];

/// The midpoint of the interval, exact for linear functions.
pub(super) const INTERVAL_1: [QuadraturePoint; 1] = [point(0.0, 0.0, 0.0, 2.0)];

/// Two Gauss points, exact for cubics.
pub(super) const INTERVAL_2: [QuadraturePoint; 2] = [point(-GAUSS_2, 0.0, 0.0, 1.0), point(GAUSS_2, 0.0, 0.0, 1.0)];

/// Three Gauss points, exact for quintics.
pub(super) const INTERVAL_3: [QuadraturePoint; 3] =
    [point(-GAUSS_3, 0.0, 0.0, 5.0 / 9.0), point(0.0, 0.0, 0.0, 8.0 / 9.0), point(GAUSS_3, 0.0, 0.0, 5.0 / 9.0)];

/// Two by two Gauss points on the square, exact for cubics in each coordinate.
pub(super) const SQUARE_2X2: [QuadraturePoint; 4] = {
    let mut points = [point(0.0, 0.0, 0.0, 0.0); 4];
    let mut k = 0;
    while k < 4 {
        let (p, q) = (INTERVAL_2[k % 2], INTERVAL_2[k / 2]);
        points[k] = point(p.at[0], q.at[0], 0.0, p.weight * q.weight);
        k += 1;
    }
    points
};

/// Three by three Gauss points on the square, exact for quintics in each coordinate.
pub(super) const SQUARE_3X3: [QuadraturePoint; 9] = {
    let mut points = [point(0.0, 0.0, 0.0, 0.0); 9];
    let mut k = 0;
    while k < 9 {
        let (p, q) = (INTERVAL_3[k % 3], INTERVAL_3[k / 3]);
        points[k] = point(p.at[0], q.at[0], 0.0, p.weight * q.weight);
        k += 1;
    }
    points
};

/// Two by two by two Gauss points on the cube, exact for cubics in each coordinate.
pub(super) const CUBE_2X2X2: [QuadraturePoint; 8] = {
    let mut points = [point(0.0, 0.0, 0.0, 0.0); 8];
    let mut k = 0;
    while k < 8 {
        let (p, q, r) = (INTERVAL_2[k % 2], INTERVAL_2[k / 2 % 2], INTERVAL_2[k / 4]);
        points[k] = point(p.at[0], q.at[0], r.at[0], p.weight * q.weight * r.weight);
        k += 1;
    }
    points
};

/// The centroid of the triangle (0,0), (1,0), (0,1), exact for linear functions.
pub(super) const TRIANGLE_1: [QuadraturePoint; 1] = [point(1.0 / 3.0, 1.0 / 3.0, 0.0, 0.5)];

/// Three points inside the triangle, exact for quadratics.
pub(super) const TRIANGLE_3: [QuadraturePoint; 3] = [
    point(1.0 / 6.0, 1.0 / 6.0, 0.0, 1.0 / 6.0),
    point(2.0 / 3.0, 1.0 / 6.0, 0.0, 1.0 / 6.0),
    point(1.0 / 6.0, 2.0 / 3.0, 0.0, 1.0 / 6.0),
];

/// Six points inside the triangle, exact for quartics: two orbits of three points, near the mid-sides and the corners.
///
/// # Source
/// D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985, degree 4.
pub(super) const TRIANGLE_6: [QuadraturePoint; 6] = {
    const A: f64 = 0.445_948_490_915_964_9;
    const WEIGHT_A: f64 = 0.223_381_589_678_011_46 / 2.0;
    const B: f64 = 0.091_576_213_509_770_74;
    const WEIGHT_B: f64 = 0.109_951_743_655_321_87 / 2.0;
    [
        point(A, A, 0.0, WEIGHT_A),
        point(1.0 - 2.0 * A, A, 0.0, WEIGHT_A),
        point(A, 1.0 - 2.0 * A, 0.0, WEIGHT_A),
        point(B, B, 0.0, WEIGHT_B),
        point(1.0 - 2.0 * B, B, 0.0, WEIGHT_B),
        point(B, 1.0 - 2.0 * B, 0.0, WEIGHT_B),
    ]
};

/// The centroid of the tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1), exact for linear functions.
pub(super) const TETRAHEDRON_1: [QuadraturePoint; 1] = [point(0.25, 0.25, 0.25, 1.0 / 6.0)];
