//! Balance of forces on a set of closed rows, by conjugate gradients with the factor of an earlier set.
//!
//! From one set of an active-set loop to the next few rows change sides. If every row bounds one dof, the dofs that are free in
//! both sets use the earlier factor as preconditioner, and those that became free their own diagonal: a few steps cost less
//! than a factorisation.

use super::equilibrium::Equilibrium;
use crate::qp::linear::{Analysis, Blocks, Cholesky, Iterate, SparseMatrix, dot};
use crate::qp::problem::ContactProblem;
use crate::solution::ContactSet;

/// Number of multiplications of a factorisation, for each value of the factor, that take about as long as a step.
const WORK_OF_STEP: f64 = 10.0;

/// Largest number of steps for one set, however expensive a factor is: beyond this, rounding of the conjugate directions costs
/// further steps.
const MOST_STEPS: f64 = 25.0;

/// Number of steps after which the rate of convergence shows whether the remaining steps suffice.
pub const TRIAL: usize = 4;

/// The residual is recomputed when its energy falls below this share of the energy of the displacement.
const ENOUGH: f64 = 1e-28;

/// With this share in each part, a balance is as good as that of its own factor.
const ACCEPTED: f64 = 1e-24;

/// If a recomputed residual keeps this share of the previous energy, it is rounding.
const NO_GAIN: f64 = 0.1;

/// Number of steps that take about as long as a factorisation.
pub fn steps_for_a_factor(analysis: &Analysis) -> usize {
    let values = analysis.factor_entries().max(1) as f64;
    (analysis.multiplications() / (WORK_OF_STEP * values)).min(MOST_STEPS) as usize
}

/// The dof that every row bounds, with its coefficient.
pub struct BoundedDofs {
    dofs: usize,
    of_rows: Vec<(usize, f64)>,
}

impl BoundedDofs {
    /// `None` if a row has several entries, or none.
    pub fn of(contact: &SparseMatrix) -> Option<Self> {
        let by_row = contact.transposed();
        let single = |row| {
            let mut entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            entries.next().filter(|_| entries.next().is_none())
        };
        let of_rows = (0..contact.rows()).map(single).collect::<Option<Vec<_>>>()?;
        Some(BoundedDofs { dofs: contact.columns(), of_rows })
    }

    /// A set of the rows.
    pub fn set<'a>(&'a self, problem: &'a ContactProblem, closed: &'a ContactSet) -> BoundedSet<'a> {
        BoundedSet { problem, bounded: self, closed }
    }

    /// The values at which a set of rows holds dofs; `None` if two rows hold one dof.
    fn held(&self, gap: &[f64], closed: &ContactSet) -> Option<Vec<Option<f64>>> {
        let mut held = vec![None; self.dofs];
        for row in closed.iter() {
            let (dof, coefficient) = self.of_rows[row];
            if held[dof].replace(gap[row] / coefficient).is_some() {
                return None;
            }
        }
        Some(held)
    }
}

/// A set of closed rows, which are at their gaps.
pub struct BoundedSet<'a> {
    problem: &'a ContactProblem,
    bounded: &'a BoundedDofs,
    closed: &'a ContactSet,
}

/// The factor of a set of closed rows that bound one dof each.
pub struct EarlierFactor {
    /// The factor of K + w B_C'B_C, with a large w.
    cholesky: Cholesky,
    /// `true` for each dof that is held in that set.
    held: Vec<bool>,
}

impl EarlierFactor {
    /// The factor of K + w B_C'B_C for the set C, with a large w.
    pub fn new(cholesky: Cholesky, bounded: &BoundedDofs, closed: &ContactSet) -> Self {
        let mut held = vec![false; bounded.dofs];
        closed.iter().for_each(|row| held[bounded.of_rows[row].0] = true);
        EarlierFactor { cholesky, held }
    }

    /// The balance of `set`, from a displacement `near` it; `None` if that would take more than `most_steps`, or if two of its rows
    /// hold one dof.
    pub fn balance(&self, set: &BoundedSet, near: &[f64], most_steps: usize) -> Option<Equilibrium> {
        let BoundedSet { problem, bounded, closed } = *set;
        let held = bounded.held(problem.gap(), closed)?;
        let mut u: Vec<f64> = held.iter().zip(near).map(|(held, &near)| held.unwrap_or(near)).collect();
        let energy = dot(&u, &problem.stiffness().mul(&u));
        let (diagonal, enough) = (&problem.stiffness().diagonal(), ENOUGH * energy);
        let task = Task { factor: self, problem, held: &held, diagonal, enough, most_steps };
        let (mut steps, mut last) = (0, f64::INFINITY);
        let force = loop {
            let force = task.force(&u);
            let residual = task.on_free(&force);
            let step = task.preconditioned(&residual);
            let left = dot(&residual, &step);
            if left <= enough || left > NO_GAIN * last {
                break if task.is_balanced(&u, &residual, &step) { force } else { return None };
            }
            last = left;
            u = task.descend(Iterate::new(u, residual, Blocks::ONE), step, &mut steps)?;
        };
        let mut multiplier = vec![0.0; problem.rows()];
        for row in closed.iter() {
            let (dof, coefficient) = bounded.of_rows[row];
            multiplier[row] = -force[dof] / coefficient;
        }
        Some(Equilibrium { displacement: u, multiplier, consistent: true })
    }
}

/// A set and the data of its balance.
struct Task<'a> {
    factor: &'a EarlierFactor,
    problem: &'a ContactProblem,
    held: &'a [Option<f64>],
    diagonal: &'a [f64],
    /// The remaining energy at which the displacement is balanced.
    enough: f64,
    most_steps: usize,
}

impl Task<'_> {
    /// f - K u, on all dofs.
    fn force(&self, u: &[f64]) -> Vec<f64> {
        self.problem.stiffness().mul(u).iter().zip(self.problem.load()).map(|(elastic, load)| load - elastic).collect()
    }

    /// Returns `true` if almost no energy is left in any part; the sum over all would hide a soft part beside a stiff one.
    fn is_balanced(&self, u: &[f64], residual: &[f64], direction: &[f64]) -> bool {
        let (parts, elastic) = (self.problem.parts(), self.problem.stiffness().mul(u));
        let left = parts.sums(|dof| residual[dof] * direction[dof]);
        let energy = parts.sums(|dof| u[dof] * elastic[dof]);
        left.iter().zip(&energy).all(|(left, energy)| *left <= ACCEPTED * energy)
    }

    fn on_free(&self, force: &[f64]) -> Vec<f64> {
        force.iter().zip(self.held).map(|(&force, held)| if held.is_some() { 0.0 } else { force }).collect()
    }

    /// The earlier factor on the dofs that are free in both sets, the diagonal on those that became free.
    fn preconditioned(&self, residual: &[f64]) -> Vec<f64> {
        let was_held = &self.factor.held;
        let known: Vec<f64> = residual.iter().zip(was_held).map(|(&r, &held)| if held { 0.0 } else { r }).collect();
        let mut step = self.factor.cholesky.solve(&known);
        for (dof, step) in step.iter_mut().enumerate() {
            *step = match (self.held[dof], was_held[dof]) {
                (Some(_), _) => 0.0,
                (None, true) => residual[dof] / self.diagonal[dof],
                (None, false) => *step,
            };
        }
        step
    }

    /// The displacement after conjugate gradients until the remaining energy falls to `enough`; `None` if that takes too many `steps`,
    /// those before included. `step` is the preconditioned residual.
    fn descend(&self, mut iterate: Iterate, mut step: Vec<f64>, steps: &mut usize) -> Option<Vec<f64>> {
        let first = dot(&iterate.rest, &step);
        let (mut left, mut taken) = (first, 0);
        while left > self.enough {
            *steps += 1;
            taken += 1;
            if !iterate.step(step, |p| self.on_free(&self.problem.stiffness().mul(p))) {
                return None;
            }
            step = self.preconditioned(&iterate.rest);
            left = dot(&iterate.rest, &step);
            let expected = taken as f64 * (first / self.enough).ln() / (first / left).ln();
            let is_slow = taken >= TRIAL && left > self.enough && !(expected <= self.most_steps as f64 && left < first);
            if is_slow || *steps > self.most_steps || !left.is_finite() {
                return None;
            }
        }
        Some(iterate.solution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::linear::{AugmentedMatrix, SymmetricMatrix, largest};
    use crate::qp::method::equilibrium::{WEIGHT, equilibrium};

    const SIDE: usize = 12;

    /// Seven points on a cube under a load, with a row `-2 u_i <= g_i` for every dof.
    fn lattice() -> ContactProblem {
        let at = |i: usize, j: usize, k: usize| (k * SIDE + j) * SIDE + i;
        let dofs = SIDE.pow(3);
        let mut entries: Vec<_> = (0..dofs).map(|dof| (dof, dof, 6.0)).collect();
        for own in 0..dofs {
            let (i, j, k) = (own % SIDE, own / SIDE % SIDE, own / SIDE / SIDE);
            let near = [(i + 1, j, k), (i, j + 1, k), (i, j, k + 1)];
            let inside = near.into_iter().filter(|&(a, b, c)| a < SIDE && b < SIDE && c < SIDE);
            entries.extend(inside.map(|(a, b, c)| (at(a, b, c), own, -1.0)));
        }
        let stiffness =
            SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &entries).unwrap()).unwrap();
        let rows: Vec<_> = (0..dofs).map(|dof| (dof, dof, -2.0)).collect();
        let contact = SparseMatrix::from_triplets(dofs, dofs, &rows).unwrap();
        let gap = (0..dofs).map(|dof| 1.0 + 0.1 * (dof as f64).sin()).collect();
        ContactProblem::new(stiffness, vec![-0.1; dofs], contact, gap).unwrap()
    }

    fn factor(problem: &ContactProblem, closed: &ContactSet) -> Cholesky {
        let augmented = AugmentedMatrix::new(problem.stiffness(), problem.contact()).unwrap();
        augmented.factor(augmented.matrix(|row| if closed.contains(row) { WEIGHT } else { 0.0 }, 0.0)).unwrap()
    }

    #[test]
    fn rows_that_change_sides_are_balanced_as_by_a_factor_of_their_own() {
        let problem = lattice();
        let bounded = BoundedDofs::of(problem.contact()).unwrap();
        let first = ContactSet::from_fn(problem.rows(), |row| row % 7 == 0);
        let by_first = equilibrium(&problem, &factor(&problem, &first), &first);
        let earlier = EarlierFactor::new(factor(&problem, &first), &bounded, &first);
        // Some rows open, some close, none changes.
        for changes in [97, 31, usize::MAX] {
            let other = ContactSet::from_fn(problem.rows(), |row| (row % 7 == 0) != (row % changes == 21 % changes));
            let found = earlier.balance(&bounded.set(&problem, &other), &by_first.displacement, 25).unwrap();
            let exact = equilibrium(&problem, &factor(&problem, &other), &other);
            for (found, exact) in [(&found.displacement, &exact.displacement), (&found.multiplier, &exact.multiplier)] {
                let off: Vec<f64> = found.iter().zip(exact).map(|(a, b)| a - b).collect();
                // 1e-11: the energy to 1e-12, and the condition number of the lattice, 60.
                assert!(largest(&off) < 1e-11 * largest(exact), "{changes}: {:e}", largest(&off));
            }
        }
    }

    /// The lattice twice, the second one softer by 2^-60, which is exact.
    #[test]
    fn a_soft_part_beside_a_stiff_one_is_balanced_or_left_to_a_factor() {
        let one = lattice();
        let (dofs, soft) = (one.dofs(), 2.0_f64.powi(-60));
        let twice = |entries: Vec<(usize, usize, f64)>, scale: f64| {
            let second: Vec<_> = entries.iter().map(|&(i, j, value)| (i + dofs, j + dofs, scale * value)).collect();
            SparseMatrix::from_triplets(2 * dofs, 2 * dofs, &[entries, second].concat()).unwrap()
        };
        let stiffness = SymmetricMatrix::from_lower(twice(one.stiffness().lower().triplets().collect(), soft)).unwrap();
        let load = one.load().iter().copied().chain(one.load().iter().map(|f| soft * f)).collect();
        let contact = twice(one.contact().triplets().collect(), 1.0);
        let both = ContactProblem::new(stiffness, load, contact, one.gap().repeat(2)).unwrap();
        let closed = |changed: bool| {
            ContactSet::from_fn(2 * dofs, |row| (row % dofs % 7 == 0) != (changed && row % dofs % 97 == 21))
        };
        let bounded = BoundedDofs::of(both.contact()).unwrap();
        let first = equilibrium(&both, &factor(&both, &closed(false)), &closed(false));
        let earlier = EarlierFactor::new(factor(&both, &closed(false)), &bounded, &closed(false));
        if let Some(found) = earlier.balance(&bounded.set(&both, &closed(true)), &first.displacement, 25) {
            let off = (0..dofs).map(|dof| found.displacement[dof] - found.displacement[dofs + dof]).collect::<Vec<_>>();
            assert!(largest(&off) < 1e-11 * largest(&found.displacement), "{:e}", largest(&off));
        }
        // A balance that is settled in the stiff part alone is not accepted.
        let stiff_only = ContactSet::from_fn(2 * dofs, |row| row % dofs % 7 == 0 && (row < dofs || row % 2 == 0));
        let found = earlier.balance(&bounded.set(&both, &stiff_only), &first.displacement, 25);
        let exact = equilibrium(&both, &factor(&both, &stiff_only), &stiff_only);
        if let Some(found) = found {
            let off: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(a, b)| a - b).collect();
            assert!(largest(&off) < 1e-11 * largest(&exact.displacement), "{:e}", largest(&off));
        }
    }

    #[test]
    fn what_would_take_many_steps_or_holds_a_dof_twice_is_left_to_a_factor() {
        let problem = lattice();
        let bounded = BoundedDofs::of(problem.contact()).unwrap();
        let none = ContactSet::open(problem.rows());
        let free = equilibrium(&problem, &factor(&problem, &none), &none);
        let earlier = EarlierFactor::new(factor(&problem, &none), &bounded, &none);
        let checkered = ContactSet::from_fn(problem.rows(), |row| row % 2 == 0);
        assert!(earlier.balance(&bounded.set(&problem, &checkered), &free.displacement, TRIAL).is_none());
        // A dof between two walls, both closed.
        let twice = SparseMatrix::from_triplets(2, 1, &[(0, 0, 1.0), (1, 0, -1.0)]).unwrap();
        let both = BoundedDofs::of(&twice).unwrap();
        assert!(both.held(&[1.0, 1.0], &ContactSet::closed(2)).is_none());
        let slanted = SparseMatrix::from_triplets(1, 2, &[(0, 0, 1.0), (0, 1, 1.0)]).unwrap();
        assert!(BoundedDofs::of(&slanted).is_none());
    }
}
