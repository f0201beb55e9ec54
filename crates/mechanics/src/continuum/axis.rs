//! Bodies of revolution about the y axis: the first coordinate is the radius r, the third component on the diagonal is
//! that around the axis.
//!
//! The stress s is r times the physical one, quadratic on each of three parts of a triangle. The balance along the
//! radius gives the hoop stress, the divergence of the first row of s with the body force; the balance along the axis
//! is a condition. So the work with a displacement of the boundary has no weight r, and all formulas of the plane hold
//! for s. On the axis s is zero.
//!
//! Energies contain `1/r`. There it is replaced by a polynomial `P(r) >= 1/r`, so that integrals by Gauss points are
//! exact and bound the energies from above.

use std::sync::OnceLock;

use super::normal::null_space;
use super::part_stress::{PartStress, QUADRATIC};
use super::simplex::{self, Point, Sample, Simplex, corners_of_side, pairs, square, traction};

/// Gauss points in each direction: exact for degree 15, and P times a product of two quadratic functions has 13.
const POINTS: usize = 8;

/// Double zeros of `1 - r P(r)` between the smallest and the largest radius of a triangle.
const ZEROS: usize = 4;

/// The entries of s that have conditions.
const ENTRIES: [usize; 3] = [0, 1, 3];

/// Points of a square with their weights.
fn points() -> &'static [([f64; 2], f64)] {
    static SQUARE: OnceLock<Vec<([f64; 2], f64)>> = OnceLock::new();
    SQUARE.get_or_init(|| square(POINTS))
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
    points().iter().map(of_point).collect()
}

/// `r P(r) - 1 >= 0` between two radii.
pub fn beyond(radius: f64, radii: [f64; 2]) -> f64 {
    simplex::beyond(radius, radii, places_of_zeros())
}

/// The double zeros between -1 and 1.
fn places_of_zeros() -> &'static [f64; ZEROS] {
    static PLACES: OnceLock<[f64; ZEROS]> = OnceLock::new();
    let place = |index: usize| (std::f64::consts::PI * (index + 1) as f64 / (ZEROS + 1) as f64).cos();
    PLACES.get_or_init(|| std::array::from_fn(place))
}

/// The coefficients in Bernstein's basis of the product of two linear functions, by their values at the corners.
fn product(one: [f64; 3], other: [f64; 3]) -> impl Iterator<Item = f64> {
    pairs(3).map(move |[i, j]| (one[i] * other[j] + one[j] * other[i]) / 2.0)
}

/// The stresses s of a triangle without axial divergence and with tractions that are linear on its sides.
pub fn stresses(triangle: &Simplex) -> Vec<PartStress> {
    let of_vector = |vector: Vec<f64>| {
        let mut stress = PartStress::zero(3, QUADRATIC);
        for (value, of_value) in stress.values_mut().iter_mut().zip(vector.chunks_exact(ENTRIES.len())) {
            ENTRIES.iter().zip(of_value).for_each(|(&entry, &part)| value[entry] = part);
        }
        add_hoop(triangle, &mut stress);
        stress
    };
    null_space(conditions(triangle)).into_iter().map(of_vector).collect()
}

/// The gradient at a corner of a quadratic function by its coefficients.
fn gradient(slopes: &[Point], corner: usize, coefficient: impl Fn(usize) -> f64) -> Point {
    let mut gradient = [0.0; 3];
    for (place, [i, j]) in pairs(3).enumerate() {
        let along = if i == corner { j } else { i };
        if i == corner || j == corner {
            (0..3).for_each(|axis| gradient[axis] += 2.0 * coefficient(place) * slopes[along][axis]);
        }
    }
    gradient
}

/// Sets r times the hoop stress: the divergence of the first row.
fn add_hoop(triangle: &Simplex, stress: &mut PartStress) {
    for k in 0..3 {
        let part = triangle.part(k);
        let (slopes, corners) = (part.slopes(), part.corners());
        let values = &mut stress.values_mut()[k * QUADRATIC..(k + 1) * QUADRATIC];
        let hoop = [0, 1, 2].map(|corner| {
            gradient(&slopes, corner, |place| values[place][0])[0]
                + gradient(&slopes, corner, |place| values[place][3])[1]
        });
        let radii = [0, 1, 2].map(|corner: usize| corners[corner][0]);
        values.iter_mut().zip(product(radii, hoop)).for_each(|(value, hoop)| value[2] = hoop);
    }
}

/// The conditions on the values of s: no axial divergence, equal tractions between parts, linear ones outside, and zero
/// on the axis.
fn conditions(triangle: &Simplex) -> Vec<Vec<f64>> {
    let place = |a: usize, b: usize| pairs(3).position(|pair| pair == [a.min(b), a.max(b)]).unwrap_or(0);
    let column = |k: usize, coefficient: usize, entry: usize| (k * QUADRATIC + coefficient) * ENTRIES.len() + entry;
    let zero = || vec![0.0; column(3, 0, 0)];
    let size = triangle.size().sqrt();
    let slopes = [0, 1, 2].map(|k| triangle.part(k).slopes().map(|slope| slope.map(|part| size * part)));
    let is_on_axis = |corner: usize| triangle.corners()[corner][0] == 0.0;
    let add_traction = |rows: &mut [Vec<f64>], k: usize, coefficient: usize, normal: Point, factor: f64| {
        for (index, &entry) in ENTRIES.iter().enumerate() {
            let mut one = [0.0; 6];
            one[entry] = factor;
            let pull = traction(one, normal);
            rows.iter_mut().zip(pull).for_each(|(row, part)| row[column(k, coefficient, index)] += part);
        }
    };
    let mut conditions = Vec::new();
    for k in 0..3 {
        for corner in 0..3 {
            let mut divergence = zero();
            for coefficient in 0..QUADRATIC {
                let unit = |other: usize| f64::from(u8::from(other == coefficient));
                let slope = gradient(&slopes[k], corner, unit);
                divergence[column(k, coefficient, 1)] += slope[1];
                divergence[column(k, coefficient, 2)] += slope[0];
            }
            conditions.push(divergence);
        }
        for (other, &normal) in slopes[k].iter().enumerate().take(3).skip(k + 1) {
            // The side between both parts goes from the third corner to the centre.
            let third = 3 - k - other;
            let here = [place(third, third), place(third, k), place(k, k)];
            let there = [place(third, third), place(third, other), place(other, other)];
            for (here, there) in here.into_iter().zip(there) {
                let mut jump = vec![zero(); 2];
                add_traction(&mut jump, k, here, normal, 1.0);
                add_traction(&mut jump, other, there, normal, -1.0);
                conditions.extend(jump);
            }
        }
        let outer: Vec<usize> = corners_of_side(2, k).collect();
        let mut bend = vec![zero(); 2];
        for (coefficient, factor) in [(place(outer[0], outer[1]), 1.0), (outer[0], -0.5), (outer[1], -0.5)] {
            add_traction(&mut bend, k, coefficient, slopes[k][k], factor);
        }
        conditions.extend(bend);
        let corners = outer.iter().filter(|&&corner| is_on_axis(corner)).copied();
        let edge = outer.iter().all(|&corner| is_on_axis(corner)).then_some(place(outer[0], outer[1]));
        for coefficient in corners.chain(edge) {
            for entry in 0..ENTRIES.len() {
                let mut held = zero();
                held[column(k, coefficient, entry)] = 1.0;
                conditions.push(held);
            }
        }
    }
    conditions
}

#[cfg(test)]
mod tests {
    use super::super::simplex::Weights;
    use super::*;

    fn triangle(radii: [f64; 3]) -> Simplex {
        Simplex::new(2, [[radii[0], 0.1, 0.0], [radii[1], -0.2, 0.0], [radii[2], 1.1, 0.0]])
    }

    #[test]
    fn there_are_21_stresses_17_at_the_axis_and_12_along_it() {
        let found = [[0.3, 1.2, 0.7], [0.0, 1.2, 0.7], [0.0, 1.2, 0.0]].map(|radii| stresses(&triangle(radii)).len());
        assert_eq!(found, [21, 17, 12]);
    }

    /// Differences of quadratic functions are exact: the divergence of the first row is the hoop stress, that of the
    /// second row is zero.
    #[test]
    fn the_hoop_stress_is_in_radial_balance() {
        for radii in [[0.3, 1.2, 0.7], [0.0, 1.2, 0.7]] {
            let triangle = triangle(radii);
            for (k, stress) in stresses(&triangle).iter().flat_map(|stress| (0..3).map(move |k| (k, stress))) {
                let (part, at) = (triangle.part(k), [0.5, 0.3, 0.2, 0.0]);
                let along = |axis: usize| {
                    let moved = |step: f64| {
                        let slopes = part.slopes();
                        stress.at(k, [0, 1, 2, 3].map(|corner| at[corner] + step * slopes[corner][axis]))
                    };
                    let [above, below] = [moved(0.01), moved(-0.01)];
                    [0, 1, 2, 3, 4, 5].map(|entry| (above[entry] - below[entry]) / 0.02)
                };
                let ([by_r, by_y], hoop) = ([along(0), along(1)], stress.at(k, at)[2]);
                let size = stress.entries().iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
                assert!((part.at(at)[0] * (by_r[0] + by_y[3]) - hoop).abs() < 1e-11 * size, "{radii:?}");
                assert!((by_r[3] + by_y[1]).abs() < 1e-10 * size, "{radii:?}");
            }
        }
    }

    /// The integral of `f^2 / r` of a function f that is r times a linear one near the axis is bounded from above, and
    /// only by a little.
    #[test]
    fn integrals_of_squares_over_the_radius_are_bounded_from_above() {
        for (radii, is_exact) in [([0.3, 1.2, 0.7], false), ([0.0, 1.2, 0.7], false), ([0.0, 1.2, 0.0], true)] {
            let triangle = triangle(radii);
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
