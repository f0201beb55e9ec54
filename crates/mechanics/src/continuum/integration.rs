//! The points of integration of a problem.

use super::axis::{around, beyond};
use super::problem::ContinuumProblem;
use super::simplex::{Point, Sample, Simplex, Weights, line, quadratic_rule, size_of_facet, square};
use super::turning;

/// Points on a facet along each direction: exact for degree 15. Two quadratic functions and the radius have 5, P and
/// two linear functions 11.
const POINTS: usize = 8;

/// The points of integration on a simplex in an element of the first mesh.
pub fn samples(problem: &ContinuumProblem, origin: usize, simplex: &Simplex) -> Vec<Sample> {
    if problem.is_axisymmetric {
        return around(problem.thickness * simplex.size(), simplex);
    }
    if let Some(point) = problem.medium(origin).turns_around() {
        return turning::samples(problem, simplex, point);
    }
    let weight = problem.thickness * simplex.size() / (simplex.dimension + 1) as f64;
    let sample = |weights| Sample { weights, place: simplex.at(weights), weight, extra: 0.0 };
    quadratic_rule(simplex.dimension).map(sample).collect()
}

/// The points of integration on a facet of the surface.
pub fn samples_on_facet(problem: &ContinuumProblem, corners: &[Point]) -> Vec<Sample> {
    let size = problem.thickness * size_of_facet(corners);
    let radii: Vec<f64> = corners.iter().map(|&corner| problem.radius(corner)).collect();
    let sample = |weights: Weights, share: f64| {
        let along = |axis: usize| corners.iter().zip(weights).map(|(corner, weight)| weight * corner[axis]).sum();
        let place = [0, 1, 2].map(along);
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
        2 => line(POINTS).map(|(t, share)| sample([1.0 - t, t, 0.0, 0.0], share)).collect(),
        _ => {
            let of_square = square(POINTS).into_iter();
            of_square.map(|([t, y], share)| sample([1.0 - t, t * (1.0 - y), t * y, 0.0], 2.0 * t * share)).collect()
        }
    }
}
