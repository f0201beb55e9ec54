//! The stress element of Johnson and Mercier, and of Křížek in space: a simplex cut in parts at its centre, the stress linear on each
//! part, tractions continuous between them. Those of its stresses that have no divergence are the stresses of a simplex without body
//! force: 9 of 15 on a triangle, 30 of 42 on a tetrahedron.
//!
//! # Source
//! C. Johnson, B. Mercier, "Some equilibrium finite element methods for two-dimensional elasticity problems", Numerische Mathematik
//! 30 (1978), 103-116; M. Křížek, "An equilibrium finite element method in three-dimensional elasticity", Aplikace matematiky 27 (1982),
//! 46-75.

use std::sync::OnceLock;

use super::problem::ContinuumProblem;
use super::simplex::{OnParts, Point, Simplex, Tensor, Weights, traction};
use signorini_qp::dot;

/// A stress on a simplex: for each part its values at the part's corners, of which the one with the number of the part is the centre.
pub type PartStress = OnParts<Tensor>;

/// The entries of a tensor, in the plane and in space.
const ENTRIES: [&[usize]; 2] = [&[0, 1, 3], &[0, 1, 2, 3, 4, 5]];

/// The stresses without divergence on a simplex, with their tractions and energies.
#[derive(Clone, Debug)]
pub struct Element {
    /// Each has the complementary energy one, and none with the others.
    stresses: Vec<PartStress>,
    /// A stress in balance with the body force.
    particular: PartStress,
    /// Works of the tractions of each stress with the unknowns of the sides.
    tractions: Vec<Vec<f64>>,
    /// The same of the particular stress.
    particular_tractions: Vec<f64>,
    /// The complementary energies of each stress with the particular one.
    particular_energies: Vec<f64>,
}

/// A stress on part k at the point given by the weights of the part's corners.
pub fn at(stress: &PartStress, k: usize, weights: Weights) -> Tensor {
    let mut value = [0.0; 6];
    for (of_corner, weight) in stress[k].iter().zip(weights) {
        value.iter_mut().zip(of_corner).for_each(|(value, entry)| *value += weight * entry);
    }
    value
}

/// The corners of the side opposite to a corner, in their order.
pub fn corners_of_side(dimension: usize, side: usize) -> impl Iterator<Item = usize> + Clone {
    (0..=dimension).filter(move |&corner| corner != side)
}

impl Element {
    /// The element on a simplex.
    pub fn new(problem: &ContinuumProblem, simplex: &Simplex) -> Self {
        let mut stresses: Vec<PartStress> = reference(simplex.dimension)
            .iter()
            .map(|stress| stress.map(|part| part.map(|value| simplex.carried(value))))
            .collect();
        // Gram and Schmidt's method in the energy.
        let mut strains: Vec<Vec<f64>> = Vec::with_capacity(stresses.len());
        for index in 0..stresses.len() {
            let (before, rest) = stresses.split_at_mut(index);
            let own = &mut rest[0];
            for (strain, other) in strains.iter().zip(before.iter()) {
                add(own, -dot(strain, values(own)), other);
            }
            let mut strain = strains_of(problem, simplex, own);
            let length = dot(&strain, values(own)).sqrt();
            own.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|value| *value /= length);
            strain.iter_mut().for_each(|value| *value /= length);
            strains.push(strain);
        }
        let particular = balancing(problem.body_force, simplex);
        Element {
            tractions: stresses.iter().map(|stress| tractions(problem, simplex, stress)).collect(),
            particular_tractions: tractions(problem, simplex, &particular),
            particular_energies: strains.iter().map(|strain| dot(strain, values(&particular))).collect(),
            stresses,
            particular,
        }
    }

    /// The stiffness at the sides, row by row.
    pub fn block(&self) -> Vec<f64> {
        let count = self.particular_tractions.len();
        let mut block = vec![0.0; count * count];
        for works in &self.tractions {
            for (line, one) in block.chunks_exact_mut(count).zip(works) {
                line.iter_mut().zip(works).for_each(|(entry, other)| *entry += one * other);
            }
        }
        block
    }

    /// The load of the body force on the sides.
    pub fn load(&self) -> Vec<f64> {
        let mut load: Vec<f64> = self.particular_tractions.iter().map(|work| -work).collect();
        for (amount, works) in self.particular_energies.iter().zip(&self.tractions) {
            load.iter_mut().zip(works).for_each(|(load, work)| *load += amount * work);
        }
        load
    }

    /// The stress under displacements of the sides.
    pub fn stress(&self, sides: &[f64]) -> PartStress {
        let mut stress = self.particular;
        for ((works, energy), own) in self.tractions.iter().zip(&self.particular_energies).zip(&self.stresses) {
            add(&mut stress, dot(works, sides) - energy, own);
        }
        stress
    }
}

fn values(stress: &PartStress) -> &[f64] {
    stress.as_flattened().as_flattened()
}

/// Adds `amount` times another stress.
fn add(stress: &mut PartStress, amount: f64, other: &PartStress) {
    let own = stress.as_flattened_mut().as_flattened_mut();
    own.iter_mut().zip(values(other)).for_each(|(value, part)| *value += amount * part);
}

/// The complementary energies of a stress with each value of another one.
fn strains_of(problem: &ContinuumProblem, simplex: &Simplex, stress: &PartStress) -> Vec<f64> {
    let corners = simplex.dimension + 1;
    // The integral of a product of barycentric coordinates over a part; twice that of a square.
    let weight = problem.thickness * simplex.size() / (corners * corners * (corners + 1)) as f64;
    let mut strains = [[[0.0; 6]; 4]; 4];
    for (part, values) in strains.iter_mut().zip(stress).take(corners) {
        let of_corners = values.map(|value| problem.compliance(value));
        for entry in 0..6 {
            // Of a symmetric tensor each shear component stands for two.
            let weight = if entry < 3 { weight } else { 2.0 * weight };
            let sum: f64 = of_corners.iter().map(|strain| strain[entry]).sum();
            for (value, of_corner) in part.iter_mut().zip(of_corners).take(corners) {
                value[entry] = weight * (sum + of_corner[entry]);
            }
        }
    }
    values(&strains).to_vec()
}

/// The works of the tractions with the unknowns of the sides: for each side and each of its corners along each axis. The unknowns are the
/// coefficients of functions that are dual to a linear traction: each acts on its own corner only, with its share of the side.
fn tractions(problem: &ContinuumProblem, simplex: &Simplex, stress: &PartStress) -> Vec<f64> {
    let dimension = simplex.dimension;
    let mut works = Vec::with_capacity((dimension + 1) * dimension * dimension);
    for (side, part) in stress.iter().enumerate().take(dimension + 1) {
        let (normal, size) = simplex.outward(side);
        let share = problem.share_of_corner(size);
        for corner in corners_of_side(dimension, side) {
            let pull = traction(part[corner], normal);
            works.extend(pull.iter().take(dimension).map(|part| share * part));
        }
    }
    works
}

/// A linear stress whose divergence is the opposite of a constant body force.
fn balancing(force: Point, simplex: &Simplex) -> PartStress {
    let centre = simplex.centre();
    let value = |at: &Point| {
        let mut stress = [0.0; 6];
        (0..3).for_each(|axis| stress[axis] = -force[axis] * (at[axis] - centre[axis]));
        stress
    };
    let mut balancing = [[[0.0; 6]; 4]; 4];
    for (k, part) in balancing.iter_mut().enumerate().take(simplex.dimension + 1) {
        let part_of = simplex.part(k);
        part.iter_mut().zip(part_of.corners()).for_each(|(own, at)| *own = value(at));
    }
    balancing
}

/// The stresses without divergence on the simplex of the origin and the unit vectors: the subspace of the values that satisfies balance
/// and continuity.
fn reference(dimension: usize) -> &'static [PartStress] {
    static STRESSES: [OnceLock<Vec<PartStress>>; 2] = [OnceLock::new(), OnceLock::new()];
    let entries = ENTRIES[dimension - 2];
    STRESSES[dimension - 2].get_or_init(|| {
        let of_vector = |vector: Vec<f64>| {
            let mut stress = [[[0.0; 6]; 4]; 4];
            for k in 0..=dimension {
                for corner in 0..=dimension {
                    for (place, &entry) in entries.iter().enumerate() {
                        stress[k][corner][entry] = vector[value_at(dimension, k, corner) + place];
                    }
                }
            }
            stress
        };
        null_space(conditions(dimension)).into_iter().map(of_vector).collect()
    })
}

/// The first of the values of a tensor at a corner of part k.
fn value_at(dimension: usize, k: usize, corner: usize) -> usize {
    (k * (dimension + 1) + corner) * ENTRIES[dimension - 2].len()
}

/// The conditions on the values: no divergence on the parts, equal tractions at the corners of the sides between them.
fn conditions(dimension: usize) -> Vec<Vec<f64>> {
    let unit = |corner: usize| [1, 2, 3].map(|axis| f64::from(u8::from(axis == corner)));
    let simplex = Simplex::new(dimension, (0..=dimension).map(unit));
    let entries = ENTRIES[dimension - 2];
    let count = value_at(dimension, dimension + 1, 0);
    // The rows of the traction on a surface with this normal, at a corner of part k.
    let add_traction = |rows: &mut [Vec<f64>], k: usize, corner: usize, normal: Point| {
        for (place, &entry) in entries.iter().enumerate() {
            let mut one = [0.0; 6];
            one[entry] = 1.0;
            let pull = traction(one, normal);
            rows.iter_mut().zip(pull).for_each(|(row, part)| row[value_at(dimension, k, corner) + place] += part);
        }
    };
    let mut conditions = Vec::new();
    for k in 0..=dimension {
        let slopes = simplex.part(k).slopes();
        let mut divergence = vec![vec![0.0; count]; dimension];
        (0..=dimension).for_each(|corner| add_traction(&mut divergence, k, corner, slopes[corner]));
        conditions.extend(divergence);
        for (other, &normal) in slopes.iter().enumerate().take(dimension + 1).skip(k + 1) {
            // The side between both parts lies opposite to corner `other` in part k; both count the centre by their own number.
            let shared = (0..=dimension).filter(|&corner| corner != k && corner != other);
            for (here, there) in shared.map(|corner| (corner, corner)).chain([(k, other)]) {
                let mut jump = vec![vec![0.0; count]; dimension];
                add_traction(&mut jump, k, here, normal);
                add_traction(&mut jump, other, there, normal.map(|part| -part));
                conditions.extend(jump);
            }
        }
    }
    conditions
}

/// A basis of the null space of all rows, by elimination; the rows are independent.
fn null_space(mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let count = rows.first().map_or(0, Vec::len);
    let mut pivots = Vec::with_capacity(rows.len());
    for index in 0..rows.len() {
        let largest = |&a: &usize, &b: &usize| rows[index][a].abs().total_cmp(&rows[index][b].abs());
        let pivot = (0..count).max_by(largest).unwrap_or(0);
        let scale = rows[index][pivot];
        rows[index].iter_mut().for_each(|value| *value /= scale);
        let row = rows[index].clone();
        for other in (0..rows.len()).filter(|&other| other != index) {
            let share = rows[other][pivot];
            rows[other].iter_mut().zip(&row).for_each(|(value, part)| *value -= share * part);
        }
        pivots.push(pivot);
    }
    let vector = |column: usize| {
        let mut vector = vec![0.0; count];
        vector[column] = 1.0;
        pivots.iter().zip(&rows).for_each(|(&pivot, row)| vector[pivot] = -row[column]);
        vector
    };
    (0..count).filter(|column| !pivots.contains(column)).map(vector).collect()
}

#[cfg(test)]
mod tests {
    use super::super::simplex::work;
    use super::*;
    use crate::fem::material::Lame;

    /// Rounding of stresses of order one.
    const ROUNDING: f64 = 1e-13;

    fn material(dimension: usize) -> ContinuumProblem {
        ContinuumProblem {
            dimension,
            lame: Lame { lambda: 1.5, mu: 1.0 },
            thickness: if dimension == 2 { 0.5 } else { 1.0 },
            body_force: [0.75, -2.0, if dimension == 2 { 0.0 } else { 1.25 }],
            conditions: Vec::new(),
            obstacles: Vec::new(),
            boundaries: Vec::new(),
        }
    }

    fn simplex(dimension: usize) -> Simplex {
        let plane = [[0.25, -0.5, 0.0], [2.0, 0.125, 0.0], [0.75, 1.5, 0.0]];
        let space = [[0.25, -0.5, 0.1], [2.0, 0.125, -0.2], [0.75, 1.5, 0.3], [0.5, 0.4, 1.7]];
        if dimension == 2 { Simplex::new(2, plane) } else { Simplex::new(3, space) }
    }

    #[test]
    fn there_are_as_many_stresses_as_motions_of_the_sides_that_are_not_rigid() {
        assert_eq!([2, 3].map(|dimension| reference(dimension).len()), [9, 30]);
    }

    /// The stress is in balance with the body force, and its tractions are continuous between parts, for any motion of the sides.
    #[test]
    fn stresses_are_in_balance_and_continuous() {
        for dimension in [2, 3] {
            let (material, simplex) = (material(dimension), simplex(dimension));
            let element = Element::new(&material, &simplex);
            let unknowns = (dimension + 1) * dimension * dimension;
            for unknown in 0..unknowns {
                let sides: Vec<f64> = (0..unknowns).map(|place| f64::from(u8::from(place == unknown))).collect();
                let stress = element.stress(&sides);
                for k in 0..=dimension {
                    let slopes = simplex.part(k).slopes();
                    let mut sum = material.body_force;
                    for corner in 0..=dimension {
                        let pull = traction(stress[k][corner], slopes[corner]);
                        (0..3).for_each(|axis| sum[axis] += pull[axis]);
                    }
                    assert!(sum.iter().all(|part| part.abs() < 100.0 * ROUNDING), "{sum:?}");
                    for other in (0..=dimension).filter(|&other| other != k) {
                        for corner in (0..=dimension).filter(|&corner| corner != other) {
                            let there = if corner == k { other } else { corner };
                            let jump: Tensor =
                                std::array::from_fn(|entry| stress[k][corner][entry] - stress[other][there][entry]);
                            let jump = traction(jump, slopes[other]);
                            assert!(jump.iter().all(|part| part.abs() < 100.0 * ROUNDING), "{jump:?}");
                        }
                    }
                }
            }
        }
    }

    /// The unknowns of the sides of a linear displacement: against the dual functions it has means to which each corner contributes its
    /// value, and its own once more.
    fn sides(simplex: &Simplex, motion: &dyn Fn(Point) -> Point) -> Vec<f64> {
        let dimension = simplex.dimension;
        let mut values = Vec::new();
        for side in 0..=dimension {
            let corners: Vec<Point> =
                corners_of_side(dimension, side).map(|corner| motion(simplex.corners()[corner])).collect();
            for own in &corners {
                values.extend((0..dimension).map(|axis| {
                    let sum: f64 = corners.iter().map(|corner| corner[axis]).sum();
                    (sum + own[axis]) / (dimension + 1) as f64
                }));
            }
        }
        values
    }

    /// A rigid motion of the sides gives no stress, and a constant strain has its own energy.
    #[test]
    fn only_rigid_body_motions_cost_nothing() {
        for dimension in [2, 3] {
            let (material, simplex) =
                (ContinuumProblem { body_force: [0.0; 3], ..material(dimension) }, simplex(dimension));
            let block = Element::new(&material, &simplex).block();
            let energy = |values: &[f64]| -> f64 {
                block.chunks_exact(values.len()).zip(values).map(|(line, value)| value * dot(line, values)).sum()
            };
            let rigid: [&dyn Fn(Point) -> Point; 4] =
                [&|_| [1.0, 0.0, 0.0], &|_| [0.0, 1.0, 0.0], &|[x, y, _]| [-y, x, 0.0], &|[x, y, z]| {
                    if dimension == 2 { [-y, x, 0.0] } else { [z, 0.0, -x] }
                }];
            for motion in rigid {
                assert!(energy(&sides(&simplex, motion)).abs() < ROUNDING);
            }
            let strain =
                if dimension == 2 { [0.5, -0.25, 0.0, 0.375, 0.0, 0.0] } else { [0.5, -0.25, 0.75, 0.375, 0.25, -0.5] };
            let exact = material.thickness * simplex.size() * work(material.stress(strain), strain);
            let moved = energy(&sides(&simplex, &|at| traction(strain, at)));
            assert!((moved / exact - 1.0).abs() < ROUNDING, "{moved} {exact}");
        }
    }
}
