//! Bodies of revolution about the y axis: the first coordinate is the radius r, the third component on the diagonal is
//! that around the axis.
//!
//! The stress s is r times the physical one, quadratic on each of three parts of a triangle. The balance along the
//! radius gives the hoop stress, the divergence of the first row of s with the body force; the balance along the axis
//! is a condition. So the work with a displacement of the boundary has no weight r, and all formulas of the plane hold
//! for s. On the axis s is zero.

use super::normal::null_space;
use super::part_stress::{PartStress, QUADRATIC, add_traction};
use super::simplex::{Point, Simplex, corners_of_side, number_of_pair, pairs};

/// The entries of s that have conditions.
const ENTRIES: [usize; 3] = [0, 1, 3];

/// The stresses s of a triangle without axial divergence and with tractions that are linear on its sides.
pub fn stresses(triangle: &Simplex) -> Vec<PartStress> {
    let of_vector = |vector: &Vec<f64>| {
        let mut stress = PartStress::of_vector(3, QUADRATIC, &ENTRIES, vector);
        add_hoop(triangle, &mut stress);
        stress
    };
    null_space(conditions(triangle)).iter().map(of_vector).collect()
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
        let values = &mut stress.values[k * QUADRATIC..(k + 1) * QUADRATIC];
        let hoop = [0, 1, 2].map(|corner| {
            gradient(&slopes, corner, |place| values[place][0])[0]
                + gradient(&slopes, corner, |place| values[place][3])[1]
        });
        let radii = [0, 1, 2].map(|corner: usize| corners[corner][0]);
        // The product of two linear functions, in Bernstein's basis.
        let product = |[i, j]: [usize; 2]| (radii[i] * hoop[j] + radii[j] * hoop[i]) / 2.0;
        values.iter_mut().zip(pairs(3)).for_each(|(value, pair)| value[2] = product(pair));
    }
}

/// The conditions on the values of s: no axial divergence, equal tractions between parts, linear ones outside, and zero
/// on the axis.
fn conditions(triangle: &Simplex) -> Vec<Vec<f64>> {
    let place = |a: usize, b: usize| number_of_pair(3, a, b);
    let column = |k: usize, coefficient: usize, entry: usize| (k * QUADRATIC + coefficient) * ENTRIES.len() + entry;
    let zero = || vec![0.0; column(3, 0, 0)];
    let size = triangle.size().sqrt();
    let slopes = [0, 1, 2].map(|k| triangle.part(k).slopes().map(|slope| slope.map(|part| size * part)));
    let is_on_axis = |corner: usize| triangle.corners()[corner][0] == 0.0;
    let add_traction = |rows: &mut [Vec<f64>], k: usize, coefficient: usize, normal: Point, factor: f64| {
        add_traction(rows, column(k, coefficient, 0), &ENTRIES, factor, normal);
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
                let size = signorini_qp::largest(stress.entries());
                assert!((part.at(at)[0] * (by_r[0] + by_y[3]) - hoop).abs() < 1e-11 * size, "{radii:?}");
                assert!((by_r[3] + by_y[1]).abs() < 1e-10 * size, "{radii:?}");
            }
        }
    }
}
