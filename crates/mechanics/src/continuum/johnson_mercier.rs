//! The stress element of Johnson and Mercier: a triangle cut in three at its centre, the stress linear on each part, tractions continuous
//! between them. Nine of its fifteen stresses have no divergence; these are the stresses of a triangle without body force.
//!
//! # Source
//! C. Johnson, B. Mercier, "Some equilibrium finite element methods for two-dimensional elasticity problems", Numerische Mathematik
//! 30 (1978), 103-116.

use std::sync::OnceLock;

use super::problem::{PlaneProblem, Tensor, work};
use super::system::{Block, LOCAL};
use super::triangulation::{MIDDLES, Point, outward, slopes, twice_area};
use signorini_qp::dot;

/// Stresses without divergence.
pub const FREE: usize = 9;

/// A stress on a triangle: for part k, next to the side opposite to corner k, its values at the centre and at the corners k+1 and k+2.
pub type PartStress = [[Tensor; 3]; 3];

/// The triangle on which the stresses are computed once.
const REFERENCE: [Point; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// The nine stresses without divergence on a triangle, with their tractions and energies.
#[derive(Clone, Debug)]
pub struct Element {
    /// Each has the complementary energy one, and none with the others.
    stresses: [PartStress; FREE],
    /// A stress in balance with the body force.
    particular: PartStress,
    /// Works of the tractions of each stress with the twelve unknowns of the sides.
    tractions: [[f64; LOCAL]; FREE],
    /// The same of the particular stress.
    particular_tractions: [f64; LOCAL],
    /// The complementary energies of each stress with the particular one.
    particular_energies: [f64; FREE],
}

/// The corners of part k: the centre, then corners k+1 and k+2.
pub fn part(corners: [Point; 3], k: usize) -> [Point; 3] {
    let centre = [0, 1].map(|axis| (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3.0);
    [centre, corners[(k + 1) % 3], corners[(k + 2) % 3]]
}

/// The mean over a triangle of the product of two functions that are linear on each part, from the values at the mid-sides.
pub fn mean_over_parts(product: impl Fn(usize, [f64; 3]) -> f64) -> f64 {
    let points = (0..3).flat_map(|k| MIDDLES.map(|weights| (k, weights)));
    points.map(|(k, weights)| product(k, weights)).sum::<f64>() / 9.0
}

/// A stress on part k at the point given by the weights of its corners.
pub fn at(stress: &PartStress, k: usize, weights: [f64; 3]) -> Tensor {
    [0, 1, 2].map(|entry| (0..3).map(|corner| weights[corner] * stress[k][corner][entry]).sum())
}

/// The traction of a stress on a side.
pub fn traction(stress: Tensor, normal: Point) -> Point {
    [stress[0] * normal[0] + stress[2] * normal[1], stress[2] * normal[0] + stress[1] * normal[1]]
}

impl Element {
    /// The element on a triangle with these corners.
    pub fn new(problem: &PlaneProblem, corners: [Point; 3]) -> Self {
        let mut stresses = reference().map(|stress| mapped(&stress, corners));
        let particular = balancing(problem.body_force, corners);
        let volume = problem.thickness * twice_area(corners) / 2.0;
        let energy = |a: &PartStress, b: &PartStress| {
            volume * mean_over_parts(|k, weights| work(at(a, k, weights), problem.compliance(at(b, k, weights))))
        };
        // Gram and Schmidt's method in the energy.
        for index in 0..FREE {
            let (before, rest) = stresses.split_at_mut(index);
            let own = &mut rest[0];
            for other in before.iter() {
                let share = energy(other, own);
                add(own, -share, other);
            }
            let length = energy(own, own).sqrt();
            own.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|value| *value /= length);
        }
        Element {
            tractions: stresses.map(|stress| tractions(&stress, corners, problem.thickness)),
            particular_tractions: tractions(&particular, corners, problem.thickness),
            particular_energies: stresses.map(|stress| energy(&stress, &particular)),
            stresses,
            particular,
        }
    }

    /// The stiffness at the sides.
    pub fn block(&self) -> Block {
        let mut block = [[0.0; LOCAL]; LOCAL];
        for works in &self.tractions {
            for (line, one) in block.iter_mut().zip(works) {
                line.iter_mut().zip(works).for_each(|(entry, other)| *entry += one * other);
            }
        }
        block
    }

    /// The load of the body force on the sides.
    pub fn load(&self) -> [f64; LOCAL] {
        let mut load = self.particular_tractions.map(|work| -work);
        for (amount, works) in self.particular_energies.iter().zip(&self.tractions) {
            load.iter_mut().zip(works).for_each(|(load, work)| *load += amount * work);
        }
        load
    }

    /// The stress under displacements of the sides.
    pub fn stress(&self, sides: [f64; LOCAL]) -> PartStress {
        let mut stress = self.particular;
        for ((works, energy), own) in self.tractions.iter().zip(self.particular_energies).zip(&self.stresses) {
            add(&mut stress, dot(works, &sides) - energy, own);
        }
        stress
    }
}

/// Adds `amount` times another stress.
fn add(stress: &mut PartStress, amount: f64, other: &PartStress) {
    let values = stress.as_flattened_mut().as_flattened_mut().iter_mut();
    values.zip(other.as_flattened().as_flattened()).for_each(|(value, part)| *value += amount * part);
}

/// The works of the tractions with the unknowns of the sides: for each side, opposite to corner k, at its ends k+1 and k+2 along x and y.
/// The unknowns are the coefficients of functions that are dual to a linear traction: each acts on its own end only, with half the side's
/// length.
fn tractions(stress: &PartStress, corners: [Point; 3], thickness: f64) -> [f64; LOCAL] {
    let mut works = [0.0; LOCAL];
    for (side, on_part) in stress.iter().enumerate() {
        let (normal, length) = outward(corners, side);
        for end in 0..2 {
            let [x, y] = traction(on_part[1 + end], normal);
            let place = 4 * side + 2 * end;
            (works[place], works[place + 1]) = (thickness * length / 2.0 * x, thickness * length / 2.0 * y);
        }
    }
    works
}

/// A linear stress whose divergence is the opposite of a constant body force.
fn balancing(force: Point, corners: [Point; 3]) -> PartStress {
    let [centre, _, _] = part(corners, 0);
    let value = |[x, y]: Point| [-force[0] * (x - centre[0]), -force[1] * (y - centre[1]), 0.0];
    [0, 1, 2].map(|k| part(corners, k).map(value))
}

/// The stress of the reference triangle on a triangle with these corners: the Piola map preserves balance and tractions.
fn mapped(stress: &PartStress, corners: [Point; 3]) -> PartStress {
    let column = |to: usize| [0, 1].map(|axis| corners[to][axis] - corners[0][axis]);
    let ([a, c], [b, d]) = (column(1), column(2));
    let determinant = a * d - b * c;
    stress.map(|values| {
        values.map(|[xx, yy, xy]| {
            let along = |p: f64, q: f64, r: f64, s: f64| (p * r * xx + q * s * yy + (p * s + q * r) * xy) / determinant;
            [along(a, b, a, b), along(c, d, c, d), along(a, b, c, d)]
        })
    })
}

/// The nine stresses on the reference triangle: the subspace of 27 values that satisfies balance and continuity.
fn reference() -> &'static [PartStress; FREE] {
    static STRESSES: OnceLock<[PartStress; FREE]> = OnceLock::new();
    STRESSES.get_or_init(|| {
        let mut null = null_space(conditions()).into_iter();
        std::array::from_fn(|_| {
            let values = null.next().unwrap_or([0.0; VALUES]);
            std::array::from_fn(|k| {
                std::array::from_fn(|corner| std::array::from_fn(|entry| values[place(k, corner, entry)]))
            })
        })
    })
}

const VALUES: usize = 27;

fn place(k: usize, corner: usize, entry: usize) -> usize {
    9 * k + 3 * corner + entry
}

/// The eighteen conditions on the values: no divergence on three parts, equal tractions at both ends of three lines between them.
fn conditions() -> Vec<[f64; VALUES]> {
    let mut conditions = Vec::with_capacity(18);
    for k in 0..3 {
        let corners = part(REFERENCE, k);
        let mut divergence = [[0.0; VALUES]; 2];
        for (corner, slope) in slopes(corners).into_iter().enumerate() {
            divergence[0][place(k, corner, 0)] = slope[0];
            divergence[0][place(k, corner, 2)] = slope[1];
            divergence[1][place(k, corner, 2)] = slope[0];
            divergence[1][place(k, corner, 1)] = slope[1];
        }
        conditions.extend(divergence);
        // The line from the centre to corner k lies between part k+1, of which it is the last corner, and part k+2.
        let (before, after) = ((k + 1) % 3, (k + 2) % 3);
        let line = [REFERENCE[k][0] - corners[0][0], REFERENCE[k][1] - corners[0][1]];
        let normal = [line[1], -line[0]];
        for (here, there) in [(0, 0), (2, 1)] {
            for axis in 0..2 {
                let mut jump = [0.0; VALUES];
                for (k, corner, sign) in [(before, here, 1.0), (after, there, -1.0)] {
                    jump[place(k, corner, axis)] = sign * normal[axis];
                    jump[place(k, corner, 2)] = sign * normal[1 - axis];
                }
                conditions.push(jump);
            }
        }
    }
    conditions
}

/// A basis of the null space of all rows, by elimination; the rows are independent.
fn null_space(mut rows: Vec<[f64; VALUES]>) -> Vec<[f64; VALUES]> {
    let mut pivots = Vec::with_capacity(rows.len());
    for index in 0..rows.len() {
        let largest = |&a: &usize, &b: &usize| rows[index][a].abs().total_cmp(&rows[index][b].abs());
        let pivot = (0..VALUES).max_by(largest).unwrap_or(0);
        let scale = rows[index][pivot];
        rows[index].iter_mut().for_each(|value| *value /= scale);
        let row = rows[index];
        for other in (0..rows.len()).filter(|&other| other != index) {
            let share = rows[other][pivot];
            (0..VALUES).for_each(|column| rows[other][column] -= share * row[column]);
        }
        pivots.push(pivot);
    }
    let free = (0..VALUES).filter(|column| !pivots.contains(column));
    let vector = |column: usize| {
        let mut vector = [0.0; VALUES];
        vector[column] = 1.0;
        pivots.iter().zip(&rows).for_each(|(&pivot, row)| vector[pivot] = -row[column]);
        vector
    };
    free.map(vector).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of stresses of order one.
    const ROUNDING: f64 = 1e-13;

    fn material() -> PlaneProblem {
        PlaneProblem {
            lame: crate::fem::material::Lame { lambda: 1.5, mu: 1.0 },
            thickness: 0.5,
            body_force: [0.75, -2.0],
            conditions: Vec::new(),
            obstacles: Vec::new(),
            boundaries: Vec::new(),
        }
    }

    fn product(a: &[f64; LOCAL], b: &[f64; LOCAL]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    const CORNERS: [Point; 3] = [[0.25, -0.5], [2.0, 0.125], [0.75, 1.5]];

    /// The divergence of a stress on part k.
    fn divergence(stress: &PartStress, k: usize) -> Point {
        let corners = part(CORNERS, k);
        let area = twice_area(corners);
        let mut sum = [0.0; 2];
        for corner in 0..3 {
            let [from, to] = [corners[(corner + 1) % 3], corners[(corner + 2) % 3]];
            let slope = [(from[1] - to[1]) / area, (to[0] - from[0]) / area];
            let pull = traction(stress[k][corner], slope);
            (0..2).for_each(|axis| sum[axis] += pull[axis]);
        }
        sum
    }

    /// The stress is in balance with the body force, and its tractions are continuous between parts, for any motion of the sides.
    #[test]
    fn stresses_are_in_balance_and_continuous() {
        let element = Element::new(&material(), CORNERS);
        for unknown in 0..LOCAL {
            let stress = element.stress(std::array::from_fn(|place| f64::from(u8::from(place == unknown))));
            for k in 0..3 {
                let sum = divergence(&stress, k);
                assert!((sum[0] + 0.75).abs() < ROUNDING && (sum[1] - 2.0).abs() < ROUNDING, "{sum:?}");
                let [centre, ..] = part(CORNERS, k);
                let normal = [CORNERS[k][1] - centre[1], centre[0] - CORNERS[k][0]];
                for (here, there) in [(0, 0), (2, 1)] {
                    let [one, other] = [stress[(k + 1) % 3][here], stress[(k + 2) % 3][there]];
                    let jump = [0, 1, 2].map(|entry| one[entry] - other[entry]);
                    assert!(traction(jump, normal).iter().all(|part| part.abs() < ROUNDING), "{jump:?}");
                }
            }
        }
    }

    /// A rigid motion of the sides gives no stress, and no other motion does: the rank is nine.
    #[test]
    fn only_rigid_body_motions_cost_nothing() {
        let material = PlaneProblem { body_force: [0.0; 2], ..material() };
        let block = Element::new(&material, CORNERS).block();
        // A linear function has, against `2 (1-s)` and `2 s`, the means two thirds of the near end and one third of the far one.
        let sides = |motion: &dyn Fn(Point) -> Point| -> [f64; LOCAL] {
            let mut values = [0.0; LOCAL];
            for side in 0..3 {
                let ends = [CORNERS[(side + 1) % 3], CORNERS[(side + 2) % 3]].map(motion);
                for end in 0..2 {
                    for axis in 0..2 {
                        let [near, far] = [ends[end][axis], ends[1 - end][axis]];
                        values[4 * side + 2 * end + axis] = (2.0 * near + far) / 3.0;
                    }
                }
            }
            values
        };
        for motion in [|_| [1.0, 0.0], |_| [0.0, 1.0], |[x, y]: Point| [-y, x]] {
            let values = sides(&motion);
            for line in block {
                let force = product(&line, &values);
                assert!(force.abs() < ROUNDING, "{force}");
            }
        }
        // A constant strain has its own energy.
        let strain = [0.5, -0.25, 0.375];
        let values = sides(&|[x, y]| [0.5 * x + 0.375 * y, 0.375 * x - 0.25 * y]);
        let energy: f64 = block.iter().zip(values).map(|(line, value)| value * product(line, &values)).sum();
        let exact = material.thickness * twice_area(CORNERS) / 2.0 * work(material.stress(strain), strain);
        assert!((energy / exact - 1.0).abs() < ROUNDING, "{energy} {exact}");
    }
}
