//! A stress on the parts of a simplex, by its coefficients.

use super::normal::add;
use super::problem::ContinuumProblem;
use super::simplex::{Point, Simplex, Tensor, Weights, number_of_pair, pairs, traction};

/// Coefficients of a quadratic function on a triangle.
pub const QUADRATIC: usize = 6;

/// A stress on a simplex; about an axis r times a stress. On each part it is linear, given by its values at the part's
/// corners, or quadratic, given by its coefficients in Bernstein's basis. The corner with the number of a part is the
/// centre.
#[derive(Clone, Debug)]
pub struct PartStress {
    /// Coefficients of each part.
    pub of_part: usize,
    pub values: Vec<Tensor>,
}

impl PartStress {
    /// Zero stress on `parts` parts, with `of_part` coefficients on each.
    pub fn zero(parts: usize, of_part: usize) -> Self {
        PartStress { of_part, values: vec![[0.0; 6]; parts * of_part] }
    }

    /// The stress with these entries of each coefficient, one coefficient after the other.
    pub fn of_vector(parts: usize, of_part: usize, entries: &[usize], vector: &[f64]) -> Self {
        let mut stress = Self::zero(parts, of_part);
        for (value, of_value) in stress.values.iter_mut().zip(vector.chunks_exact(entries.len())) {
            entries.iter().zip(of_value).for_each(|(&entry, &part)| value[entry] = part);
        }
        stress
    }

    /// A linear or quadratic function of the place.
    pub fn of(problem: &ContinuumProblem, simplex: &Simplex, value: impl Fn(Point) -> Tensor) -> Self {
        let count = simplex.dimension + 1;
        let mut stress = Self::zero(count, if problem.is_axisymmetric { QUADRATIC } else { count });
        for (k, values) in stress.values.chunks_exact_mut(stress.of_part).enumerate() {
            let part = simplex.part(k);
            let corners = part.corners();
            for (place, own) in pairs(count).zip(values) {
                let [one, other] = place.map(|corner| value(corners[corner]));
                *own = if place[0] == place[1] {
                    one
                } else {
                    let half = value([0, 1, 2].map(|axis| (corners[place[0]][axis] + corners[place[1]][axis]) / 2.0));
                    std::array::from_fn(|entry| 2.0 * half[entry] - (one[entry] + other[entry]) / 2.0)
                };
            }
        }
        stress
    }

    /// The value at a corner of part k.
    pub fn corner(&self, k: usize, corner: usize) -> Tensor {
        self.values[k * self.of_part + corner]
    }

    /// The value on part k at the point given by the weights of the part's corners.
    pub fn at(&self, k: usize, weights: Weights) -> Tensor {
        let mut sum = [0.0; 6];
        let of_part = &self.values[k * self.of_part..(k + 1) * self.of_part];
        for (value, factor) in of_part.iter().zip(self.factors(weights)) {
            sum.iter_mut().zip(value).for_each(|(sum, entry)| *sum += factor * entry);
        }
        sum
    }

    /// The derivative by one barycentric coordinate at a corner of part k.
    pub fn slope(&self, k: usize, corner: usize, along: usize) -> Tensor {
        if self.of_part < QUADRATIC {
            return self.corner(k, along);
        }
        self.corner(k, number_of_pair(3, corner, along)).map(|part| 2.0 * part)
    }

    /// The value of the function of each coefficient at a point.
    fn factors(&self, weights: Weights) -> [f64; QUADRATIC] {
        if self.of_part == QUADRATIC {
            return quadratic_factors(weights);
        }
        let mut factors = [0.0; QUADRATIC];
        factors[..weights.len()].copy_from_slice(&weights);
        factors
    }

    /// The same with other values of the coefficients.
    pub fn map(&self, value: impl Fn(Tensor) -> Tensor) -> Self {
        PartStress { of_part: self.of_part, values: self.values.iter().map(|&old| value(old)).collect() }
    }

    pub fn entries(&self) -> &[f64] {
        self.values.as_flattened()
    }

    /// Adds a multiple of another stress.
    pub fn add(&mut self, factor: f64, other: &PartStress) {
        add(self.values.as_flattened_mut(), factor, other.entries());
    }
}

/// The values of Bernstein's quadratic functions on a triangle.
pub fn quadratic_factors(weights: Weights) -> [f64; QUADRATIC] {
    let [a, b, c, _] = weights;
    [a * a, b * b, c * c, 2.0 * a * b, 2.0 * a * c, 2.0 * b * c]
}

/// Adds the traction on a surface with this normal of the values from `first` on, those of these entries of a tensor
/// times a factor: a row for each of its components.
pub fn add_traction(rows: &mut [Vec<f64>], first: usize, entries: &[usize], factor: f64, normal: Point) {
    for (place, &entry) in entries.iter().enumerate() {
        let mut one = [0.0; 6];
        one[entry] = factor;
        rows.iter_mut().zip(traction(one, normal)).for_each(|(row, part)| row[first + place] += part);
    }
}
