//! The points of integration of a problem.
//!
//! Energies about an axis contain `1/r`. There it is replaced by a polynomial `P(r) >= 1/r`, so that integrals by Gauss
//! points are exact and bound the energies from above.

use std::sync::OnceLock;

use super::problem::ContinuumProblem;
use super::simplex::{Point, Simplex, Weights, mixed, size_of_facet};
use signorini_fem::element::gauss_legendre;

/// Gauss points in each direction: exact for degree 15. P times a product of two quadratic functions has 13; on facets
/// two quadratic functions and the radius have 5, P and two linear functions 11.
const POINTS: usize = 8;

/// Double zeros of `1 - r P(r)` between the smallest and the largest radius of a triangle.
const ZEROS: usize = 4;

/// A point of integration on a simplex or on a facet.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Its barycentric coordinates.
    pub weights: Weights,
    pub place: Point,
    /// Its volume, or its area.
    pub weight: f64,
    /// What counts in addition for squares of a hoop strain or of a stress, because the polynomial P stands for `1/r`:
    /// its volume times `r P(r) - 1`.
    pub extra: f64,
}

pub fn samples(problem: &ContinuumProblem, simplex: &Simplex) -> Vec<Sample> {
    if problem.is_axisymmetric {
        return around(problem.thickness * simplex.size(), simplex);
    }
    let weight = problem.thickness * simplex.size() / (simplex.dimension + 1) as f64;
    let sample = |weights| Sample { weights, place: simplex.at(weights), weight, extra: 0.0 };
    quadratic_rule(simplex.dimension).map(sample).collect()
}

/// The barycentric coordinates of points whose mean is that of a quadratic function over the simplex.
fn quadratic_rule(dimension: usize) -> impl Iterator<Item = Weights> + Clone {
    let corners = dimension + 1;
    let others = (1.0 - 1.0 / (corners as f64 + 1.0).sqrt()) / corners as f64;
    (0..corners).map(move |own| {
        let weight = |corner: usize| match corner {
            _ if corner == own => 1.0 - dimension as f64 * others,
            _ if corner <= dimension => others,
            _ => 0.0,
        };
        std::array::from_fn(weight)
    })
}

/// The points on a triangle about the axis; towards a single corner on the axis the radius is `t rho(y)`, and rho takes
/// its place.
pub fn around(size: f64, triangle: &Simplex) -> Vec<Sample> {
    let radii: Vec<f64> = triangle.corners().iter().map(|corner| corner[0]).collect();
    let on_axis = radii.iter().filter(|radius| **radius == 0.0).count();
    let tip = radii.iter().position(|radius| *radius == 0.0).unwrap_or(0);
    let [from, to] = [(tip + 1) % 3, (tip + 2) % 3];
    let of_point = |&([t, y], share): &([f64; 2], f64)| {
        let mut weights = [0.0; 4];
        (weights[tip], weights[from], weights[to]) = (1.0 - t, t * (1.0 - y), t * y);
        let radius: f64 = radii.iter().zip(weights).map(|(radius, weight)| radius * weight).sum();
        let too_much = match on_axis {
            // There the stress and the radial displacement are r times a polynomial.
            2.. => 0.0,
            1 => beyond(radius / t, [radii[from], radii[to]]),
            _ => beyond(radius, [0, 1].map(|end| radii.iter().copied().fold(radii[0], [f64::min, f64::max][end]))),
        };
        let weight = 2.0 * t * share * size * radius;
        Sample { weights, place: triangle.at(weights), weight, extra: weight * too_much }
    };
    square().iter().map(of_point).collect()
}

/// The points of integration on a facet of the surface.
pub fn samples_on_facet(problem: &ContinuumProblem, corners: &[Point]) -> Vec<Sample> {
    let size = problem.thickness * size_of_facet(corners);
    let radii: Vec<f64> = corners.iter().map(|&corner| problem.radius(corner)).collect();
    let sample = |weights: Weights, share: f64| {
        let place = mixed(corners, &weights);
        let radius = problem.radius(place);
        let too_much = match radii[..] {
            // Towards a corner on the axis the stress is r times a polynomial.
            [one, other] if problem.is_axisymmetric && one > 0.0 && other > 0.0 => beyond(radius, [one, other]),
            _ => 0.0,
        };
        let weight = share * size * radius;
        Sample { weights, place, weight, extra: weight * too_much }
    };
    match corners.len() {
        2 => line().map(|(t, share)| sample([1.0 - t, t, 0.0, 0.0], share)).collect(),
        _ => {
            let of_square = square().iter();
            of_square.map(|&([t, y], share)| sample([1.0 - t, t * (1.0 - y), t * y, 0.0], 2.0 * t * share)).collect()
        }
    }
}

/// Gauss points between 0 and 1, with their weights.
fn line() -> impl Iterator<Item = (f64, f64)> {
    gauss_legendre(POINTS).map(|(x, weight)| ((x + 1.0) / 2.0, weight / 2.0))
}

/// Gauss points of the unit square, with their weights.
fn square() -> &'static [([f64; 2], f64)] {
    static SQUARE: OnceLock<Vec<([f64; 2], f64)>> = OnceLock::new();
    let points = || line().flat_map(|(t, of_t)| line().map(move |(y, of_y)| ([t, y], of_t * of_y))).collect();
    SQUARE.get_or_init(points)
}

/// `r P(r) - 1 >= 0` for the polynomial `P(r) >= 1/r` between the radii a and b with
/// `1 - r P = (r - a) (r - b) prod (r - c)^2 / a b prod c^2`.
fn beyond(radius: f64, [one, other]: [f64; 2]) -> f64 {
    static PLACES: OnceLock<[f64; ZEROS]> = OnceLock::new();
    // Those of the c, -1 at the smaller radius and 1 at the larger one.
    let place = |index: usize| (std::f64::consts::PI * (index + 1) as f64 / (ZEROS + 1) as f64).cos();
    let places = PLACES.get_or_init(|| std::array::from_fn(place));
    let (low, high) = (one.min(other), one.max(other));
    let ends = (radius - low) / low * ((high - radius) / high);
    let middle = [low + high, high - low].map(|sum| sum / 2.0);
    let zeros = places.iter().map(|place| middle[0] + middle[1] * place);
    zeros.fold(ends.max(0.0), |product, zero| product * (radius / zero - 1.0).powi(2))
}

#[cfg(test)]
mod tests {
    use super::super::simplex::pairs;
    use super::*;

    #[test]
    fn the_rule_gives_the_mean_of_products_of_linear_functions() {
        for dimension in [2, 3] {
            for [i, j] in pairs(dimension + 1) {
                let mean = quadratic_rule(dimension).map(|weights| weights[i] * weights[j]).sum::<f64>();
                let exact = if i == j { 2.0 } else { 1.0 } / ((dimension + 1) * (dimension + 2)) as f64;
                assert!((mean / (dimension + 1) as f64 - exact).abs() < 1e-16, "{dimension}: {i} {j}");
            }
        }
    }

    /// The integral of `f^2 / r` of a function f that is r times a linear one near the axis is bounded from above, and
    /// only by a little.
    #[test]
    fn integrals_of_squares_over_the_radius_are_bounded_from_above() {
        for (radii, is_exact) in [([0.3, 1.2, 0.7], false), ([0.0, 1.2, 0.7], false), ([0.0, 1.2, 0.0], true)] {
            let corners = [[radii[0], 0.1, 0.0], [radii[1], -0.2, 0.0], [radii[2], 1.1, 0.0]];
            let triangle = Simplex::new(2, corners);
            // A corner function that vanishes at the first corner; on an axis edge r itself.
            let value = |weights: Weights| match is_exact {
                true => triangle.at(weights)[0],
                false => weights[1] + 0.5 * weights[2],
            };
            let sum = |with_extra: bool| -> f64 {
                let of_sample = |sample: &Sample| {
                    let weight = sample.weight + if with_extra { sample.extra } else { 0.0 };
                    weight * (value(sample.weights) / triangle.at(sample.weights)[0]).powi(2)
                };
                around(triangle.size(), &triangle).iter().map(of_sample).sum()
            };
            let (bound, nearly) = (sum(true), sum(false));
            assert!(bound >= nearly * (1.0 - 1e-14) && bound <= nearly * 1.001, "{radii:?}: {bound} {nearly}");
            let volume: f64 = around(triangle.size(), &triangle).iter().map(|sample| sample.weight).sum();
            let exact = triangle.size() * radii.iter().sum::<f64>() / 3.0;
            assert!((volume / exact - 1.0).abs() < 1e-13, "{volume} {exact}");
        }
    }

    /// `1 - r P = (r - 2) (r - 6) prod (r - c)^2 / 12 prod c^2` at r = 3, with the places `4 + 2 cos(k pi / 5)`.
    #[test]
    fn the_polynomial_for_one_over_the_radius_is_above_it() {
        let cosines = [0.809_016_994_374_947_5, 0.309_016_994_374_947_45];
        let squares: f64 = cosines
            .iter()
            .flat_map(|cosine| [4.0 + 2.0 * cosine, 4.0 - 2.0 * cosine])
            .map(|place: f64| (1.0 - 3.0 / place).powi(2))
            .product();
        let exact = 1.0 / 2.0 * (3.0 / 6.0) * squares;
        for ends in [[2.0, 6.0], [6.0, 2.0]] {
            assert!((beyond(3.0, ends) / exact - 1.0).abs() < 1e-13, "{}", beyond(3.0, ends));
            assert_eq!(ends.map(|end| beyond(end, ends)), [0.0; 2]);
        }
    }
}
