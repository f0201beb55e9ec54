//! The points of integration of a problem.

use std::sync::OnceLock;

use super::axis::{around, beyond};
use super::mesh::SimplexMesh;
use super::problem::ContinuumProblem;
use super::simplex::{self, Point, Sample, Simplex, Weights, line, quadratic_rule, size_of_facet, square};
use crate::fem::geometry::{dot, minus};

/// Points on a facet along each direction: exact for degree 15. Two quadratic functions and the radius have 5, P and
/// two linear functions 11.
const POINTS: usize = 8;

/// The points of integration on a simplex in an element of the first mesh.
pub fn samples(problem: &ContinuumProblem, origin: usize, simplex: &Simplex) -> Vec<Sample> {
    if problem.is_axisymmetric {
        return around(problem.thickness * simplex.size(), simplex);
    }
    if let Some(point) = problem.medium(origin).turns_around() {
        return samples_around(problem, simplex, point);
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

// Media in the plane whose axes turn around a point: their stiffness is a polynomial of degree four over `r^4`, r
// being the distance from the point.
//
// In energies a polynomial `P(s)^2 >= 1/s^2`, `s = r^2`, stands for `1/r^4`, so that integrals by Gauss points are
// exact and bound the energies from above, as about an axis.

/// Points along a line: exact for degree 19, of the squares of two linear strains (2), the stiffness (4), `P^2` (12),
/// and the map of the square to the triangle (1).
const POINTS_AROUND: usize = 10;

/// The place of the double zero of `1 - s P(s)`: in the middle.
const ZERO: [f64; 1] = [0.0];

/// The points of integration on a triangle of a medium whose axes turn around a point.
pub fn samples_around(problem: &ContinuumProblem, triangle: &Simplex, point: Point) -> Vec<Sample> {
    static SQUARE: OnceLock<Vec<([f64; 2], f64)>> = OnceLock::new();
    let (size, range) = (problem.thickness * triangle.size(), squares(triangle, point));
    let of_square = SQUARE.get_or_init(|| simplex::square(POINTS_AROUND)).iter();
    let sample = |&([t, y], share): &([f64; 2], f64)| {
        let weights = [1.0 - t, t * (1.0 - y), t * y, 0.0];
        let (place, weight) = (triangle.at(weights), 2.0 * t * share * size);
        let too_much = simplex::beyond(square_of(minus(place, point)), range, &ZERO);
        Sample { weights, place, weight, extra: weight * too_much * (2.0 + too_much) }
    };
    of_square.map(sample).collect()
}

/// Rounding of the areas of triangles.
const ROUNDING: f64 = 1e-9;

fn square_of(vector: Point) -> f64 {
    dot(vector, vector)
}

/// The smallest and the largest square of the distance of a triangle from a point; the smallest one is zero in the
/// triangle.
fn squares(triangle: &Simplex, point: Point) -> [f64; 2] {
    let corners = triangle.corners();
    let to_edge = |k: usize| {
        let (from, along) = (corners[k], minus(corners[(k + 1) % 3], corners[k]));
        let share = (dot(minus(point, from), along) / square_of(along)).clamp(0.0, 1.0);
        square_of([0, 1, 2].map(|axis| from[axis] + share * along[axis] - point[axis]))
    };
    let to_corner = |corner: &Point| square_of(minus(*corner, point));
    let nearest = if contains(triangle, point) { 0.0 } else { (0..3).map(to_edge).fold(f64::INFINITY, f64::min) };
    [nearest, corners.iter().map(to_corner).fold(0.0, f64::max)]
}

/// Returns `true` if a point lies in a triangle or, except for rounding, on its border.
fn contains(triangle: &Simplex, point: Point) -> bool {
    let corners = triangle.corners();
    let with_edge = |k: usize| Simplex::new(2, [point, corners[k], corners[(k + 1) % 3]]).size();
    (0..3).map(with_edge).sum::<f64>() <= triangle.size() * (1.0 + ROUNDING)
}

impl ContinuumProblem {
    /// Returns `true` if axes turn around a point of their medium: there the stiffness has no value.
    pub fn turns_inside(&self, mesh: &SimplexMesh) -> bool {
        let is_inside = |cell: usize| {
            let point = self.medium(mesh.origins[cell]).turns_around();
            point.is_some_and(|point| contains(&mesh.simplex(cell), point))
        };
        (0..mesh.count()).any(is_inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuum::bodies::filled;
    use crate::fem::material::Lame;

    /// The integral of `1 / r^4` over a triangle is bounded from above, and only by a little; areas and linear
    /// functions are exact.
    #[test]
    fn integrals_over_the_fourth_power_are_bounded_from_above() {
        let problem = filled(2, Lame { lambda: 1.0, mu: 1.0 }, [0.0; 3]);
        for (corner, width) in [([2.0, 0.5, 0.0], 0.5), ([1.0, -0.1, 0.0], 0.2), ([0.6, 0.0, 0.0], 1.5)] {
            let [x, y, _] = corner;
            let triangle = Simplex::new(2, [corner, [x + width, y, 0.0], [x, y + width, 0.0]]);
            let at = samples_around(&problem, &triangle, [0.5, 0.0, 0.0]);
            let sum = |value: &dyn Fn(&Sample) -> f64| at.iter().map(value).sum::<f64>();
            assert!((sum(&|at| at.weight) / triangle.size() - 1.0).abs() < 1e-13);
            assert!((sum(&|at| at.weight * at.place[0]) / triangle.size() - x - width / 3.0).abs() < 1e-13);
            // By many small squares of equal size.
            const CELLS: usize = 400;
            let mut exact = 0.0;
            for i in 0..CELLS {
                for j in 0..CELLS - i {
                    let part = if j + 1 < CELLS - i { 1.0 } else { 0.5 };
                    let middle = if part == 1.0 { 0.5 } else { 1.0 / 3.0 };
                    let [i, j] = [i, j].map(|index| (index as f64 + middle) * width / CELLS as f64);
                    exact += part * (width / CELLS as f64).powi(2) / square_of([x + i - 0.5, y + j, 0.0]).powi(2);
                }
            }
            let bound = sum(&|at| (at.weight + at.extra) / square_of(minus(at.place, [0.5, 0.0, 0.0])).powi(2));
            assert!(bound > exact * (1.0 - 1e-4) && at.iter().all(|at| at.extra >= 0.0), "{bound} {exact}");
            assert!(width > 1.0 || bound < exact * 1.01, "{bound} {exact}");
        }
    }

    /// `s P - 1 = (s - 1) (4 - s) (s - 5/2)^2 / (4 (5/2)^2)` at s = 2 between 1 and 4, and what counts in addition is
    /// `(s P)^2 - 1` of the area.
    #[test]
    fn the_square_of_the_polynomial_is_counted() {
        assert!((simplex::beyond(2.0, [1.0, 4.0], &ZERO) - 0.02).abs() < 1e-15);
        let problem = filled(2, Lame { lambda: 1.0, mu: 1.0 }, [0.0; 3]);
        let triangle = Simplex::new(2, [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.5, 0.0]]);
        for at in samples_around(&problem, &triangle, [0.0; 3]) {
            let s = square_of(at.place);
            let times = 1.0 + (s - 1.0) * (4.0 - s) / 4.0 * (s / 2.5 - 1.0).powi(2);
            assert!((1.0 + at.extra / at.weight - times * times).abs() < 1e-14, "{at:?}");
        }
    }

    #[test]
    fn a_point_on_the_border_lies_in_a_triangle() {
        let triangle = Simplex::new(2, [[1.0, -1.0, 0.0], [1.0, 3.0, 0.0], [2.0, 0.0, 0.0]]);
        for (point, is_inside) in [([1.2, 0.5], true), ([1.0, 1.0], true), ([2.0, 0.0], true), ([0.99, 1.0], false)] {
            assert_eq!(contains(&triangle, [point[0], point[1], 0.0]), is_inside, "{point:?}");
        }
    }

    #[test]
    fn the_nearest_point_may_lie_on_an_edge_and_the_farthest_is_a_corner() {
        let triangle = Simplex::new(2, [[1.0, -1.0, 0.0], [1.0, 3.0, 0.0], [2.0, 0.0, 0.0]]);
        assert_eq!(squares(&triangle, [0.0; 3]), [1.0, 10.0]);
        assert_eq!(squares(&triangle, [3.0, 0.0, 0.0]), [1.0, 13.0]);
        assert_eq!(squares(&triangle, [1.5, 0.0, 0.0])[0], 0.0);
    }
}
