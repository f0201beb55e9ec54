//! Balance of forces on a set of closed rows, by conjugate gradients with the factor of an earlier set.
//!
//! From one set of an active-set loop to the next few rows change sides. If every row bounds one dof, the dofs that are
//! free in both sets use the earlier factor as preconditioner, and those that became free their own diagonal: a few
//! steps cost less than a factorisation.

use super::equilibrium::Equilibrium;
use crate::linear::{Analysis, Blocks, Cholesky, Iterate, dot};
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// Number of multiplications of a factorisation, for each value of the factor, that take about as long as a step.
const WORK_OF_STEP: f64 = 10.0;

/// Largest number of steps for one set, however expensive a factor is: beyond this, rounding of the conjugate
/// directions costs further steps.
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

/// The factor of an earlier set of rows that bound one dof each.
pub struct EarlierFactor<'a> {
    problem: &'a ContactProblem,
    /// The dof that every row bounds, with its coefficient.
    of_rows: Vec<(usize, f64)>,
    /// Largest number of steps for one set.
    most_steps: usize,
    /// The factor of K + w B_C'B_C for the earlier set C, with a large w, and `true` for each dof that C holds.
    factor: Option<(Cholesky, Vec<bool>)>,
}

impl<'a> EarlierFactor<'a> {
    /// No factor yet, for at most `most_steps` steps from one set to the next; `None` if a row has several entries, or
    /// none.
    pub fn of(problem: &'a ContactProblem, most_steps: usize) -> Option<Self> {
        let by_row = problem.contact().transposed();
        let single = |row| {
            let mut entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            entries.next().filter(|_| entries.next().is_none())
        };
        let of_rows = (0..problem.rows()).map(single).collect::<Option<Vec<_>>>()?;
        Some(EarlierFactor { problem, of_rows, most_steps, factor: None })
    }

    /// Keeps the factor of K + w B_C'B_C for the set C, with a large w.
    pub fn keep(&mut self, cholesky: Cholesky, closed: &ContactSet) {
        let mut held = vec![false; self.problem.dofs()];
        closed.iter().for_each(|row| held[self.of_rows[row].0] = true);
        self.factor = Some((cholesky, held));
    }

    /// The balance of a set, from a displacement `near` it. `None` if that would take too many steps, or if two of its
    /// rows hold one dof; then the factor is freed, because there is room for one at a time.
    pub fn balance(&mut self, closed: &ContactSet, near: &[f64]) -> Option<Equilibrium> {
        let factor = self.factor.take()?;
        let balance = self.balance_by(&factor, closed, near)?;
        self.factor = Some(factor);
        Some(balance)
    }

    /// The values at which a set of rows holds dofs; `None` if two rows hold one dof.
    fn held(&self, closed: &ContactSet) -> Option<Vec<Option<f64>>> {
        let mut held = vec![None; self.problem.dofs()];
        for row in closed.iter() {
            let (dof, coefficient) = self.of_rows[row];
            if held[dof].replace(self.problem.gap()[row] / coefficient).is_some() {
                return None;
            }
        }
        Some(held)
    }

    fn balance_by(&self, factor: &(Cholesky, Vec<bool>), closed: &ContactSet, near: &[f64]) -> Option<Equilibrium> {
        let (problem, held) = (self.problem, self.held(closed)?);
        let (load, parts) = (problem.load(), problem.parts());
        let mut u: Vec<f64> = held.iter().zip(near).map(|(held, &near)| held.unwrap_or(near)).collect();
        let enough = ENOUGH * dot(&u, &problem.stiffness().mul(&u));
        let mut task = SetBalance { factor, problem, held: &held, enough, steps_left: self.most_steps };
        let mut last = f64::INFINITY;
        let force = loop {
            let elastic = problem.stiffness().mul(&u);
            let force: Vec<f64> = elastic.iter().zip(load).map(|(elastic, load)| load - elastic).collect();
            let residual = task.on_free(force.clone());
            let step = task.preconditioned(&residual);
            let left = dot(&residual, &step);
            if left <= enough || left > NO_GAIN * last {
                // The sum over all parts would hide a soft part beside a stiff one.
                let left = parts.sums(|dof| residual[dof] * step[dof]);
                let energy = parts.sums(|dof| u[dof] * elastic[dof]);
                let is_balanced = left.iter().zip(&energy).all(|(left, energy)| *left <= ACCEPTED * energy);
                break is_balanced.then_some(force)?;
            }
            last = left;
            u = task.descend(Iterate::new(u, residual, Blocks::ONE), step)?;
        };
        let mut multiplier = vec![0.0; problem.rows()];
        for row in closed.iter() {
            let (dof, coefficient) = self.of_rows[row];
            multiplier[row] = -force[dof] / coefficient;
        }
        let along_rows = problem.contact().mul(&u);
        Some(Equilibrium { displacement: u, multiplier, along_rows, consistent: true })
    }
}

/// A set and the data of its balance.
struct SetBalance<'a> {
    factor: &'a (Cholesky, Vec<bool>),
    problem: &'a ContactProblem,
    held: &'a [Option<f64>],
    /// The remaining energy at which the displacement is balanced.
    enough: f64,
    steps_left: usize,
}

impl SetBalance<'_> {
    fn on_free(&self, mut force: Vec<f64>) -> Vec<f64> {
        force.iter_mut().zip(self.held).filter(|entry| entry.1.is_some()).for_each(|(force, _)| *force = 0.0);
        force
    }

    /// The earlier factor on the dofs that are free in both sets, the diagonal on those that became free.
    fn preconditioned(&self, residual: &[f64]) -> Vec<f64> {
        let ((cholesky, was_held), diagonal) = (self.factor, &self.problem.diagonal().values);
        let known: Vec<f64> = residual.iter().zip(was_held).map(|(&r, &held)| if held { 0.0 } else { r }).collect();
        let mut step = cholesky.solve(&known);
        let became_free = (0..step.len()).filter(|&dof| was_held[dof]);
        became_free.for_each(|dof| step[dof] = residual[dof] / diagonal[dof]);
        self.on_free(step)
    }

    /// The displacement after conjugate gradients until the remaining energy falls to `enough`; `None` if that takes
    /// more steps than are left. `step` is the preconditioned residual.
    fn descend(&mut self, mut iterate: Iterate, mut step: Vec<f64>) -> Option<Vec<f64>> {
        let first = dot(&iterate.rest, &step);
        let (mut left, mut taken, most) = (first, 0, self.steps_left);
        while left > self.enough {
            self.steps_left = self.steps_left.checked_sub(1)?;
            taken += 1;
            if !iterate.step(step, |p| self.on_free(self.problem.stiffness().mul(p))) {
                return None;
            }
            step = self.preconditioned(&iterate.rest);
            left = dot(&iterate.rest, &step);
            let expected = taken as f64 * (first / self.enough).ln() / (first / left).ln();
            let is_slow = taken >= TRIAL && left > self.enough && !(expected <= most as f64 && left < first);
            if is_slow || !left.is_finite() {
                return None;
            }
        }
        Some(iterate.solution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::{AugmentedMatrix, largest};
    use crate::method::equilibrium::{WEIGHT, equilibrium};

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
        let rows: Vec<_> = (0..dofs).map(|dof| (dof, dof, -2.0)).collect();
        let gap: Vec<f64> = (0..dofs).map(|dof| 1.0 + 0.1 * (dof as f64).sin()).collect();
        ContactProblem::of_entries(&entries, &vec![-0.1; dofs], &rows, &gap)
    }

    fn factor(problem: &ContactProblem, closed: &ContactSet) -> Cholesky {
        let augmented = AugmentedMatrix::new(problem.stiffness(), problem.contact()).unwrap();
        augmented.factor(augmented.matrix(|row| if closed.contains(row) { WEIGHT } else { 0.0 }, 0.0)).unwrap()
    }

    #[test]
    fn rows_that_change_sides_are_balanced_as_by_a_factor_of_their_own() {
        let problem = lattice();
        let first = ContactSet::from_fn(problem.rows(), |row| row % 7 == 0);
        let by_first = equilibrium(&problem, &factor(&problem, &first), &first);
        let mut earlier = EarlierFactor::of(&problem, 25).unwrap();
        earlier.keep(factor(&problem, &first), &first);
        // Some rows open, some close, none changes.
        for changes in [97, 31, usize::MAX] {
            let other = ContactSet::from_fn(problem.rows(), |row| (row % 7 == 0) != (row % changes == 21 % changes));
            let found = earlier.balance(&other, &by_first.displacement).unwrap();
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
            [entries, second].concat()
        };
        let stiffness = twice(one.stiffness().lower().triplets().collect(), soft);
        let load: Vec<f64> = one.load().iter().copied().chain(one.load().iter().map(|f| soft * f)).collect();
        let contact = twice(one.contact().triplets().collect(), 1.0);
        let both = ContactProblem::of_entries(&stiffness, &load, &contact, &one.gap().repeat(2));
        let closed = |changed: bool| {
            ContactSet::from_fn(2 * dofs, |row| (row % dofs % 7 == 0) != (changed && row % dofs % 97 == 21))
        };
        let first = equilibrium(&both, &factor(&both, &closed(false)), &closed(false));
        let mut earlier = EarlierFactor::of(&both, 25).unwrap();
        earlier.keep(factor(&both, &closed(false)), &closed(false));
        if let Some(found) = earlier.balance(&closed(true), &first.displacement) {
            let off = (0..dofs).map(|dof| found.displacement[dof] - found.displacement[dofs + dof]).collect::<Vec<_>>();
            assert!(largest(&off) < 1e-11 * largest(&found.displacement), "{:e}", largest(&off));
        }
        // A balance that is settled in the stiff part alone is not accepted.
        let stiff_only = ContactSet::from_fn(2 * dofs, |row| row % dofs % 7 == 0 && (row < dofs || row % 2 == 0));
        earlier.keep(factor(&both, &closed(false)), &closed(false));
        let found = earlier.balance(&stiff_only, &first.displacement);
        let exact = equilibrium(&both, &factor(&both, &stiff_only), &stiff_only);
        if let Some(found) = found {
            let off: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(a, b)| a - b).collect();
            assert!(largest(&off) < 1e-11 * largest(&exact.displacement), "{:e}", largest(&off));
        }
    }

    #[test]
    fn what_would_take_many_steps_or_holds_a_dof_twice_is_left_to_a_factor() {
        let problem = lattice();
        let none = ContactSet::open(problem.rows());
        let free = equilibrium(&problem, &factor(&problem, &none), &none);
        let mut earlier = EarlierFactor::of(&problem, TRIAL).unwrap();
        earlier.keep(factor(&problem, &none), &none);
        let checkered = ContactSet::from_fn(problem.rows(), |row| row % 2 == 0);
        assert!(earlier.balance(&checkered, &free.displacement).is_none());
        // A dof between two walls, both closed.
        let both = ContactProblem::of_entries(&[(0, 0, 1.0)], &[0.0], &[(0, 0, 1.0), (1, 0, -1.0)], &[1.0; 2]);
        assert!(EarlierFactor::of(&both, TRIAL).unwrap().held(&ContactSet::closed(2)).is_none());
        let springs = [(0, 0, 1.0), (1, 1, 1.0)];
        let slanted = ContactProblem::of_entries(&springs, &[0.0; 2], &[(0, 0, 1.0), (0, 1, 1.0)], &[1.0]);
        assert!(EarlierFactor::of(&slanted, TRIAL).is_none());
    }
}
