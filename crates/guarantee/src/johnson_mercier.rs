//! The stress element of Johnson and Mercier, and of Křížek in space: a simplex cut in parts at its centre, the stress
//! linear on each part, tractions continuous between them. Those of its stresses that have no divergence are the
//! stresses of a simplex without body force: 9 of 15 on a triangle, 30 of 42 on a tetrahedron. About an axis,
//! [`axis`](super::axis) has stresses of a triangle instead.
//!
//! # Source
//! C. Johnson, B. Mercier, "Some equilibrium finite element methods for two-dimensional elasticity problems",
//! Numerische Mathematik 30 (1978), 103-116; M. Křížek, "An equilibrium finite element method in three-dimensional
//! elasticity", Aplikace matematiky 27 (1982), 46-75.

use std::sync::OnceLock;

use super::axis::stresses;
use super::integration::samples;
use super::normal::{Lower, add, null_space};
use super::part_stress::{PartStress, QUADRATIC, add_traction, quadratic_factors};
use super::problem::{ContinuumProblem, ElasticLaw, Medium};
use super::simplex::{ENTRIES, Point, Simplex, corners_of_side, traction};
use signorini_fem::material::engineering;
use signorini_qp::dot;

/// Stresses without divergence: those of the reference simplex, carried to this one, or those of a triangle about an
/// axis.
#[derive(Clone, Debug)]
enum Basis {
    Carried(Simplex),
    About(Vec<PartStress>),
}

impl Basis {
    fn of(problem: &ContinuumProblem, simplex: &Simplex) -> Self {
        if problem.is_axisymmetric { Basis::About(stresses(simplex)) } else { Basis::Carried(*simplex) }
    }

    fn stresses(&self) -> Vec<PartStress> {
        match self {
            Basis::Carried(simplex) => {
                let carried = |stress: &PartStress| stress.map(|value| simplex.carried(value));
                reference(simplex.dimension).iter().map(carried).collect()
            }
            Basis::About(stresses) => stresses.clone(),
        }
    }

    fn add_to(&self, stress: &mut PartStress, amounts: &[f64]) {
        match self {
            Basis::Carried(simplex) => {
                let mut of_reference = PartStress::zero(1, stress.values.len());
                let own = reference(simplex.dimension).iter().zip(amounts);
                own.for_each(|(own, &amount)| of_reference.add(amount, own));
                for (value, carried) in stress.values.iter_mut().zip(&of_reference.values) {
                    add(value, 1.0, &simplex.carried(*carried));
                }
            }
            Basis::About(stresses) => stresses.iter().zip(amounts).for_each(|(own, &amount)| stress.add(amount, own)),
        }
    }
}

/// Solves for a stress from its tractions: the second one takes the rounding of the first.
const REFINED: usize = 2;

/// The stresses without divergence on a simplex, with their tractions and energies.
#[derive(Clone, Debug)]
pub struct StressElement {
    basis: Basis,
    /// The factor L of the complementary energies of the stresses of the basis. The stresses `L^-1` times these have
    /// the energy one, and none with the others.
    factor: Lower,
    /// A stress in balance with the body force.
    particular: PartStress,
    /// Works of the tractions of each stress with the unknowns of the sides.
    tractions: Vec<Vec<f64>>,
    /// The same of the particular stress: of any stress in balance with the body force.
    pub particular_tractions: Vec<f64>,
    /// The complementary energies of each stress with the particular one, less the stress without strain.
    particular_energies: Vec<f64>,
    /// The factor of the products of the works of the stresses, at its first use.
    of_works: OnceLock<Option<Lower>>,
}

impl StressElement {
    /// The element on a simplex of the medium of an element of the first mesh; `None` if it is flat.
    pub fn new(problem: &ContinuumProblem, origin: usize, simplex: &Simplex) -> Option<Self> {
        let medium = problem.medium(origin);
        let basis = Basis::of(problem, simplex);
        let carried = basis.stresses();
        let (law, products) = (problem.law(origin), products(problem, simplex));
        let strains: Vec<_> = carried.iter().map(|stress| strains_of(&law, &products, stress)).collect();
        let energies = |(k, strain): (usize, &Vec<f64>)| -> Vec<f64> {
            carried[..=k].iter().map(|stress| dot(strain, stress.entries())).collect()
        };
        let factor = Lower::of(strains.iter().enumerate().map(energies).collect())?;
        let particular = balancing(problem, medium, simplex);
        let mut elastic = particular.clone();
        if medium.own_stress.is_some() {
            let own = |place| medium.own_stress(place).map(|part| problem.radius(place) * part);
            elastic.add(-1.0, &PartStress::of(problem, simplex, own));
        }
        let mut tractions = vec![Vec::new(); carried.len()];
        let of_carried: Vec<Vec<f64>> = carried.iter().map(|stress| works(problem, simplex, stress)).collect();
        let mut of_unknown = vec![0.0; carried.len()];
        for unknown in 0..of_carried[0].len() {
            of_unknown.iter_mut().zip(&of_carried).for_each(|(own, works)| *own = works[unknown]);
            factor.forward(&mut of_unknown);
            tractions.iter_mut().zip(&of_unknown).for_each(|(works, &work)| works.push(work));
        }
        let mut particular_energies = strains.iter().map(|strain| dot(strain, elastic.entries())).collect::<Vec<_>>();
        factor.forward(&mut particular_energies);
        let particular_tractions = works(problem, simplex, &particular);
        let of_works = OnceLock::new();
        Some(Self { basis, factor, particular, tractions, particular_tractions, particular_energies, of_works })
    }

    /// The particular stress and these amounts of the others.
    fn sum(&self, mut amounts: Vec<f64>) -> PartStress {
        self.factor.backward(&mut amounts);
        let mut stress = self.particular.clone();
        self.basis.add_to(&mut stress, &amounts);
        stress
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

    /// The amount of each stress under displacements of the sides.
    fn amounts(&self, sides: &[f64]) -> Vec<f64> {
        self.tractions.iter().zip(&self.particular_energies).map(|(works, energy)| dot(works, sides) - energy).collect()
    }

    /// The works of the tractions with the unknowns of the sides, under displacements of the sides.
    pub fn works(&self, sides: &[f64]) -> Vec<f64> {
        let mut sum = self.particular_tractions.clone();
        self.tractions.iter().zip(self.amounts(sides)).for_each(|(works, amount)| add(&mut sum, amount, works));
        sum
    }

    pub fn stress(&self, sides: &[f64]) -> PartStress {
        self.sum(self.amounts(sides))
    }

    /// The stress whose tractions do these works with the unknowns of the sides; they are in balance with the body
    /// force. `None` for a flat simplex.
    pub fn stress_with(&self, works: &[f64]) -> Option<PartStress> {
        let of_unknown = |unknown: usize| self.tractions.iter().map(|works| works[unknown]).collect();
        let squares =
            || Lower::of_squares(self.tractions.len(), &(0..works.len()).map(of_unknown).collect::<Vec<Vec<f64>>>());
        let factor = self.of_works.get_or_init(squares).as_ref()?;
        let mut rest: Vec<f64> = works.iter().zip(&self.particular_tractions).map(|(all, own)| all - own).collect();
        let mut amounts = vec![0.0; self.tractions.len()];
        for _ in 0..REFINED {
            let mut step: Vec<f64> = self.tractions.iter().map(|works| dot(works, &rest)).collect();
            factor.solve(&mut step);
            self.tractions.iter().zip(&step).for_each(|(works, &amount)| add(&mut rest, -amount, works));
            add(&mut amounts, 1.0, &step);
        }
        Some(self.sum(amounts))
    }
}

/// The integrals of the products of the functions of two coefficients on a part.
type Products = [[f64; QUADRATIC]; QUADRATIC];

/// These integrals on each part; about an axis over the radius, for products of r times a stress.
fn products(problem: &ContinuumProblem, simplex: &Simplex) -> Vec<Products> {
    let corners = simplex.dimension + 1;
    if problem.is_axisymmetric {
        return (0..corners).map(|k| products_over_radius(problem, &simplex.part(k))).collect();
    }
    let of_product = problem.thickness * simplex.size() / (corners * corners * (corners + 1)) as f64;
    let entry = |i: usize, j: usize| if i == j { 2.0 * of_product } else { of_product };
    vec![std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))); corners]
}

fn products_over_radius(problem: &ContinuumProblem, part: &Simplex) -> Products {
    let mut products = [[0.0; QUADRATIC]; QUADRATIC];
    for sample in samples(problem, part) {
        let weight = (sample.weight + sample.extra) / sample.place[0].powi(2);
        let factors = quadratic_factors(sample.weights);
        for (line, of_line) in products.iter_mut().zip(factors) {
            line.iter_mut().zip(factors).for_each(|(entry, factor)| *entry += weight * of_line * factor);
        }
    }
    products
}

/// The complementary energies of a stress with each coefficient of another one.
fn strains_of(law: &ElasticLaw, products: &[Products], stress: &PartStress) -> Vec<f64> {
    let mut strains = PartStress::zero(products.len(), stress.of_part);
    let parts = strains.values.chunks_exact_mut(stress.of_part).zip(stress.values.chunks_exact(stress.of_part));
    for ((strains, of_part), products) in parts.zip(products) {
        for (value, column) in of_part.iter().zip(products) {
            let strain = engineering(&law.compliance(*value));
            strains.iter_mut().zip(column).for_each(|(own, &product)| add(own, product, &strain));
        }
    }
    strains.entries().to_vec()
}

/// The works of the tractions with the unknowns of the sides: for each side and each of its corners along each axis.
/// The unknowns are the coefficients of functions that are dual to a linear traction: each acts on its own corner only,
/// with its share of the side.
fn works(problem: &ContinuumProblem, simplex: &Simplex, stress: &PartStress) -> Vec<f64> {
    let dimension = simplex.dimension;
    let mut works = Vec::with_capacity((dimension + 1) * dimension * dimension);
    for side in 0..=dimension {
        let (normal, size) = simplex.outward(side);
        let share = problem.share_of_corner(size);
        for corner in corners_of_side(dimension, side) {
            let pull = traction(stress.corner(side, corner), normal);
            works.extend(pull.iter().take(dimension).map(|part| share * part));
        }
    }
    works
}

/// A stress whose divergence is the opposite of a constant body force. About an axis the radial part of the force acts
/// against the hoop stress alone.
fn balancing(problem: &ContinuumProblem, medium: &Medium, simplex: &Simplex) -> PartStress {
    let (force, centre) = (medium.body_force, simplex.centre());
    PartStress::of(problem, simplex, |at| {
        let radius = problem.radius(at);
        let mut stress = [0, 1, 2, 3, 4, 5].map(|axis: usize| match force.get(axis) {
            Some(force) => -radius * force * (at[axis] - centre[axis]),
            None => 0.0,
        });
        if problem.is_axisymmetric {
            (stress[0], stress[2]) = (0.0, radius * radius * force[0]);
        }
        stress
    })
}

/// The stresses without divergence on the simplex of the origin and the unit vectors: the subspace of the values that
/// satisfies balance and continuity.
fn reference(dimension: usize) -> &'static [PartStress] {
    static STRESSES: [OnceLock<Vec<PartStress>>; 2] = [OnceLock::new(), OnceLock::new()];
    let entries = ENTRIES[dimension - 2];
    STRESSES[dimension - 2].get_or_init(|| {
        let of_vector = |vector: &Vec<f64>| PartStress::of_vector(dimension + 1, dimension + 1, entries, vector);
        null_space(conditions(dimension)).iter().map(of_vector).collect()
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
    let add_traction = |rows: &mut [Vec<f64>], k: usize, corner: usize, normal: Point| {
        add_traction(rows, value_at(dimension, k, corner), entries, 1.0, normal);
    };
    let mut conditions = Vec::new();
    for k in 0..=dimension {
        let slopes = simplex.part(k).slopes();
        let mut divergence = vec![vec![0.0; count]; dimension];
        (0..=dimension).for_each(|corner| add_traction(&mut divergence, k, corner, slopes[corner]));
        conditions.extend(divergence);
        for (other, &normal) in slopes.iter().enumerate().take(dimension + 1).skip(k + 1) {
            // The side between both parts lies opposite to corner `other` in part k; both count the centre by their own
            // number.
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

#[cfg(test)]
mod tests {
    use super::super::bodies::{any_simplex, filled};
    use super::super::simplex::{Tensor, less};
    use super::*;
    use signorini_fem::geometry::plus;
    use signorini_fem::material::Lame;

    /// Rounding of stresses of order one.
    const ROUNDING: f64 = 1e-13;

    fn material(dimension: usize) -> ContinuumProblem {
        let force = [0.75, -2.0, if dimension == 2 { 0.0 } else { 1.25 }];
        ContinuumProblem {
            thickness: if dimension == 2 { 0.5 } else { 1.0 },
            ..filled(dimension, Lame { lambda: 1.5, mu: 1.0 }, force)
        }
    }

    /// About an axis the force `0.75` along the radius is balanced by the hoop stress `0.75 r`, both times r; a force
    /// along the axis by the axial stress.
    #[test]
    fn a_body_force_about_an_axis_is_in_balance() {
        let problem = ContinuumProblem { is_axisymmetric: true, ..material(2) };
        let (simplex, at) = (any_simplex(2), [0.2, 0.5, 0.3, 0.0]);
        let stress = balancing(&problem, &problem.media[0], &simplex);
        for k in 0..3 {
            let radius = simplex.part(k).at(at)[0];
            let [rr, _, hoop, ry, ..] = stress.at(k, at);
            assert!(
                rr.abs() + ry.abs() < ROUNDING && (hoop - 0.75 * radius * radius).abs() < ROUNDING,
                "{hoop} {radius}"
            );
        }
    }

    #[test]
    fn there_are_as_many_stresses_as_motions_of_the_sides_that_are_not_rigid() {
        assert_eq!([2, 3].map(|dimension| reference(dimension).len()), [9, 30]);
    }

    /// The stress is in balance with the body force, and its tractions are continuous between parts, for any motion of
    /// the sides.
    #[test]
    fn stresses_are_in_balance_and_continuous() {
        for dimension in [2, 3] {
            let (material, simplex) = (material(dimension), any_simplex(dimension));
            let element = StressElement::new(&material, 0, &simplex).unwrap();
            let unknowns = (dimension + 1) * dimension * dimension;
            for unknown in 0..unknowns {
                let sides: Vec<f64> = (0..unknowns).map(|place| f64::from(u8::from(place == unknown))).collect();
                let stress = element.stress(&sides);
                for k in 0..=dimension {
                    let slopes = simplex.part(k).slopes();
                    let mut sum = material.media[0].body_force;
                    for (corner, &slope) in slopes.iter().enumerate().take(dimension + 1) {
                        sum = plus(sum, traction(stress.corner(k, corner), slope));
                    }
                    assert!(sum.iter().all(|part| part.abs() < 100.0 * ROUNDING), "{sum:?}");
                    for other in (0..=dimension).filter(|&other| other != k) {
                        for corner in (0..=dimension).filter(|&corner| corner != other) {
                            let there = if corner == k { other } else { corner };
                            let jump: Tensor = less(stress.corner(k, corner), stress.corner(other, there));
                            let jump = traction(jump, slopes[other]);
                            assert!(jump.iter().all(|part| part.abs() < 100.0 * ROUNDING), "{jump:?}");
                        }
                    }
                }
            }
        }
    }

    /// The unknowns of the sides of a linear displacement: against the dual functions it has means to which each corner
    /// contributes its value, and its own once more.
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
            let (material, simplex) = (material(dimension).unloaded(), any_simplex(dimension));
            let block = StressElement::new(&material, 0, &simplex).unwrap().block();
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
            let exact = material.thickness * simplex.size() * material.law(0).square(strain);
            let moved = energy(&sides(&simplex, &|at| traction(strain, at)));
            assert!((moved / exact - 1.0).abs() < ROUNDING, "{moved} {exact}");
        }
    }
}
