//! Quadrature on the reference cells, also of functions with kinks: point, interval [-1,1], square, cube, triangle and
//! tetrahedron.

use super::ReferenceElement;
use super::reference::{QuadraturePoint, Shape};
use crate::geometry::minus;

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

/// The product of a rule on the interval with itself: on the square for as many points as its square has, else on the
/// cube.
const fn product<const M: usize, const N: usize>(line: [QuadraturePoint; M]) -> [QuadraturePoint; N] {
    let mut points = [point(0.0, 0.0, 0.0, 1.0); N];
    let mut k = 0;
    while k < N {
        let (p, q) = (line[k % M], line[k / M % M]);
        let r = if N > M * M { line[k / M / M] } else { POINT[0] };
        points[k] = point(p.at[0], q.at[0], r.at[0], p.weight * q.weight * r.weight);
        k += 1;
    }
    points
}

/// Two by two Gauss points on the square, exact for cubics in each coordinate.
pub(super) const SQUARE_2X2: [QuadraturePoint; 4] = product(INTERVAL_2);

/// Three by three Gauss points on the square, exact for quintics in each coordinate.
pub(super) const SQUARE_3X3: [QuadraturePoint; 9] = product(INTERVAL_3);

/// Two by two by two Gauss points on the cube, exact for cubics in each coordinate.
pub(super) const CUBE_2X2X2: [QuadraturePoint; 8] = product(INTERVAL_2);

/// Three by three by three Gauss points on the cube, exact for quintics in each coordinate.
pub(super) const CUBE_3X3X3: [QuadraturePoint; 27] = product(INTERVAL_3);

/// The centroid of the triangle (0,0), (1,0), (0,1), exact for linear functions.
pub(super) const TRIANGLE_1: [QuadraturePoint; 1] = [point(1.0 / 3.0, 1.0 / 3.0, 0.0, 0.5)];

/// Three points inside the triangle, exact for quadratics.
pub(super) const TRIANGLE_3: [QuadraturePoint; 3] = [
    point(1.0 / 6.0, 1.0 / 6.0, 0.0, 1.0 / 6.0),
    point(2.0 / 3.0, 1.0 / 6.0, 0.0, 1.0 / 6.0),
    point(1.0 / 6.0, 2.0 / 3.0, 0.0, 1.0 / 6.0),
];

/// Points in orbits about the middle of a simplex, each given by its distance from the sides and a weight: a corner of
/// the orbit towards each corner of the simplex, the origin first.
const fn orbits<const K: usize, const N: usize>(dimension: usize, of: [(f64, f64); K]) -> [QuadraturePoint; N] {
    let mut points = [POINT[0]; N];
    let mut k = 0;
    while k < N {
        let ((a, weight), corner) = (of[k / (dimension + 1)], k % (dimension + 1));
        points[k] = point(a, a, if dimension == 3 { a } else { 0.0 }, weight);
        if corner > 0 {
            points[k].at[corner - 1] = 1.0 - dimension as f64 * a;
        }
        k += 1;
    }
    points
}

/// Six points inside the triangle, exact for quartics: two orbits of three points, near the mid-sides and the corners.
///
/// # Source
/// D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985, degree 4.
pub(super) const TRIANGLE_6: [QuadraturePoint; 6] = orbits(
    2,
    [
        (0.445_948_490_915_964_9, 0.223_381_589_678_011_46 / 2.0),
        (0.091_576_213_509_770_74, 0.109_951_743_655_321_87 / 2.0),
    ],
);

/// The centroid of the tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1), exact for linear functions.
pub(super) const TETRAHEDRON_1: [QuadraturePoint; 1] = [point(0.25, 0.25, 0.25, 1.0 / 6.0)];

/// Four points inside the tetrahedron, exact for quadratics: (5 - sqrt(5))/20 from the faces.
pub(super) const TETRAHEDRON_4: [QuadraturePoint; 4] = orbits(3, [(0.138_196_601_125_010_5, 1.0 / 24.0)]);

/// Eight points inside the tetrahedron, exact for cubics: with curved edges the stiffness needs this to pass the patch
/// test.
///
/// # Source
/// Y. Jinyun, *Symmetric Gaussian quadrature formulae for tetrahedronal regions*, Comput. Methods Appl. Mech. Engrg. 43
/// (1984) 349-353: two orbits of four points.
pub(super) const TETRAHEDRON_8: [QuadraturePoint; 8] = orbits(
    3,
    [
        (0.328_054_696_711_426_7, 0.138_527_966_511_862_2 / 6.0),
        (0.106_952_273_932_930_7, 0.111_472_033_488_137_8 / 6.0),
    ],
);

/// Abscissas and weights of five Gauss points on [-1, 1], exact for degree nine.
const GAUSS_5: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Gauss points on [-1, 1] as `(abscissa, weight)`, exact for degree `2 count - 1`: the zeros of the Legendre
/// polynomial.
pub fn gauss_legendre(count: usize) -> impl Iterator<Item = (f64, f64)> + Clone {
    /// Steps of Newton's method from the known estimate of a zero: four suffice.
    const STEPS: usize = 6;
    let n = count as f64;
    // The polynomial and its slope, by the recurrence of three terms.
    let legendre = move |x: f64| {
        let (mut before, mut own) = (1.0, x);
        for degree in 2..=count {
            let k = degree as f64;
            (before, own) = (own, ((2.0 * k - 1.0) * x * own - (k - 1.0) * before) / k);
        }
        (own, n * (x * own - before) / (x * x - 1.0))
    };
    (0..count).map(move |place| {
        let mut x = -((place as f64 + 0.75) / (n + 0.5) * std::f64::consts::PI).cos();
        for _ in 0..STEPS {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let (_, slope) = legendre(x);
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// Five Gauss points in each direction of the cell; on a simplex the points of the product of intervals, mapped onto
/// the simplex. Exact for polynomials of total degree six and more.
pub(super) fn fine(form: Shape, dimension: usize) -> Vec<QuadraturePoint> {
    let mut points = vec![point(0.0, 0.0, 0.0, 1.0)];
    for axis in 0..dimension {
        let along = |start: &QuadraturePoint| {
            let start = *start;
            GAUSS_5.map(move |(at, weight)| {
                let mut next = start;
                // Rounded as the way from the end of the interval.
                next.at[axis] = (1.0 + at) - 1.0;
                next.weight *= weight;
                next
            })
        };
        points = points.iter().flat_map(along).collect();
    }
    if form == Shape::Simplex {
        for point in &mut points {
            // Each coordinate takes its share of what the later coordinates leave.
            let mut left = 1.0;
            for axis in (0..dimension).rev() {
                let share = (1.0 + point.at[axis]) / 2.0;
                point.at[axis] = left * share;
                // On a simplex the interval [-1, 1] of this coordinate shrinks to length `left`.
                point.weight *= left / 2.0;
                left *= 1.0 - share;
            }
        }
    }
    points
}

/// A corner of a piece: reference coordinates, and the value of the function.
type Corner = ([f64; 3], f64);

/// Five points in each direction of every piece of a cell between `levels` of a function with the values `at_corners`,
/// linear between them along the sides of the cell and along the cuts.
///
/// If the cell in place is an affine image of its reference, these are the pieces of a function that is linear in the
/// coordinates.
pub fn between_levels(reference: &ReferenceElement, at_corners: &[f64], levels: &[f64]) -> Vec<QuadraturePoint> {
    let whole: Vec<Corner> = reference.nodes.iter().copied().zip(at_corners.iter().copied()).collect();
    let mut pieces = vec![whole];
    for &level in levels {
        let halves = |piece: Vec<Corner>| {
            [clipped(&piece, level, |value| value <= level), clipped(&piece, level, |value| value >= level)]
        };
        pieces = pieces.into_iter().flat_map(halves).filter(|piece| piece.len() > reference.dimension).collect();
    }
    pieces.iter().flat_map(|piece| points(reference.dimension, piece)).collect()
}

/// The part of a line or of a polygon on the kept side of the level.
fn clipped(piece: &[Corner], level: f64, keeps: impl Fn(f64) -> bool) -> Vec<Corner> {
    // A polygon is closed; a line has one side.
    let sides = if piece.len() == 2 { 1 } else { piece.len() };
    let mut kept = Vec::with_capacity(piece.len() + 1);
    for (index, &(at, value)) in piece.iter().enumerate() {
        if keeps(value) {
            kept.push((at, value));
        }
        let (next, beyond) = piece[(index + 1) % piece.len()];
        if index < sides && (value < level && beyond > level || value > level && beyond < level) {
            let share = (level - value) / (beyond - value);
            kept.push(([0, 1, 2].map(|axis| at[axis] + share * (next[axis] - at[axis])), level));
        }
    }
    kept
}

/// The points of a piece: a line, or a polygon that is cut into triangles around its first corner.
fn points(dimension: usize, piece: &[Corner]) -> Vec<QuadraturePoint> {
    match (dimension, piece) {
        (1, &[(from, _), (to, _)]) => {
            let way = minus(to, from);
            let place = |point: QuadraturePoint| QuadraturePoint {
                at: [0, 1, 2].map(|axis| from[axis] + (1.0 + point.at[0]) / 2.0 * way[axis]),
                weight: point.weight * way[0].abs() / 2.0,
            };
            fine(Shape::Product, 1).into_iter().map(place).collect()
        }
        (2, &[(first, _), ref others @ ..]) => {
            let triangle = |pair: &[Corner]| {
                let (u, v) = (minus(pair[0].0, first), minus(pair[1].0, first));
                let twice = (u[0] * v[1] - u[1] * v[0]).abs();
                fine(Shape::Simplex, 2).into_iter().map(move |point| QuadraturePoint {
                    at: [0, 1, 2].map(|axis| first[axis] + point.at[0] * u[axis] + point.at[1] * v[axis]),
                    weight: point.weight * twice,
                })
            };
            others.windows(2).flat_map(triangle).collect()
        }
        _ => fine(Shape::Product, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::FacetKind;

    #[test]
    fn gauss_points_are_those_of_the_table_and_integrate_their_degree() {
        for ((x, weight), (at, of_table)) in gauss_legendre(5).zip(GAUSS_5) {
            assert!((x - at).abs() < 1e-15 && (weight - of_table).abs() < 1e-15, "{x} {weight}");
        }
        for count in [2, 3, 8, 12] {
            for degree in (0..2 * count as i32).step_by(2) {
                let sum: f64 = gauss_legendre(count).map(|(x, weight)| weight * x.powi(degree)).sum();
                assert!(
                    (sum * f64::from(degree + 1) / 2.0 - 1.0).abs() < 1e-14,
                    "{count} points, degree {degree}: {sum}"
                );
            }
        }
    }

    /// The integral of max(0, s - level) over a cell, s linear, against a fine cut of the cell into many.
    #[test]
    fn a_function_with_a_kink_is_integrated_exactly() {
        // Over a line from 1 to 3 on [-1, 1], above 2.5: (1/2) (1/2)^2, over a slope of 1.
        let line = between_levels(FacetKind::Line2.reference(), &[1.0, 3.0], &[2.5]);
        let above = |at: [f64; 3]| (2.0 + at[0] - 2.5).max(0.0);
        let sum: f64 = line.iter().map(|point| point.weight * above(point.at)).sum();
        assert!((sum - 0.125).abs() < 1e-15, "{sum}");
        // xi + eta - 1/2 on the triangle, positive beyond 1/2: the whole less what is negative, plus that again.
        let triangle = between_levels(FacetKind::T3.reference(), &[0.0, 1.0, 1.0], &[0.5]);
        let sum: f64 = triangle.iter().map(|point| point.weight * (point.at[0] + point.at[1] - 0.5).max(0.0)).sum();
        let (whole, below) = (1.0 / 3.0 - 0.25, 0.125 * 1.0 / 3.0 - 0.5 * 0.125);
        assert!((sum - (whole - below)).abs() < 1e-15, "{sum}");
        // xi + eta on the square, above 1: a triangle of legs 1 and height 1 at its corner.
        let square = between_levels(FacetKind::Q4.reference(), &[-2.0, 0.0, 2.0, 0.0], &[-3.0, 1.0]);
        let sum: f64 = square.iter().map(|point| point.weight * (point.at[0] + point.at[1] - 1.0).max(0.0)).sum();
        assert!((sum - 1.0 / 6.0).abs() < 1e-15, "{sum}");
        assert!((square.iter().map(|point| point.weight).sum::<f64>() - 4.0).abs() < 1e-14);
    }
}
