//! The bound if the contact boundary is not known: the rows are repaired by their own dofs, and the body follows.

use super::{Answer, EnergyNorm, ErrorBound, Keeping};
use crate::qp::linear::{SparseMatrix, dot};
use crate::qp::problem::ContactProblem;

/// Rounding of a sum, relative to the sum of its terms.
const SUM_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Steps in which the rest of the body adapts to the rows that were put at their gaps; each costs a product with K.
const RELAXATIONS: usize = 20;

/// An answer moved by `repair`, and from there by a `rest` of at most these lengths in each part.
struct Repaired<'a> {
    repair: Vec<f64>,
    residual: Vec<f64>,
    multiplier: Vec<f64>,
    rest: Vec<f64>,
    /// The rows that are at their gaps then.
    closed: &'a [bool],
}

impl ContactProblem {
    /// Possible rounding error of B u - g from rounding of u, row by row.
    pub(in super::super) fn negligible(&self, displacement: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = displacement.iter().map(|value| SUM_ROUNDING * value).collect();
        self.contact.mul_abs(&magnitude)
    }

    /// The bound from a displacement with the closed rows moved to their gaps, and all others out of their obstacles.
    pub(super) fn bound_row_by_row(&self, norm: &EnergyNorm, answer: &Answer, keeping: Keeping) -> ErrorBound {
        let by_row = self.contact.transposed();
        let negligible = self.negligible(answer.displacement);
        let touches = |row: usize| {
            let violation = answer.violation[row];
            violation > 0.0 || (answer.multiplier[row] < 0.0 && violation >= -negligible[row])
        };
        let (keeps_all, at_gap) = match keeping {
            Keeping::All => (true, (0..self.rows()).map(touches).collect()),
            Keeping::Closed(closed) => (false, closed.to_vec()),
        };
        let Some(placed) = self.placed(&by_row, answer.displacement, at_gap, || norm.is_over()) else {
            return ErrorBound::none();
        };
        let (closed, mut repair) = (&placed.closed, placed.shift);
        let is_moved = repair.iter().any(|&change| change != 0.0);
        let keeps = |row: usize| self.gap[row].is_finite() && (keeps_all || closed[row]);
        let mut multiplier: Vec<f64> =
            (0..self.rows()).map(|row| if keeps(row) { answer.multiplier[row].min(0.0) } else { 0.0 }).collect();
        let dropped: Vec<f64> = multiplier.iter().zip(answer.multiplier).map(|(mu, lambda)| mu - lambda).collect();
        let mut residual = answer.residual.clone();
        residual.iter_mut().zip(self.contact.mul_transposed(&dropped)).for_each(|(entry, force)| *entry += force);
        if is_moved {
            residual.iter_mut().zip(self.stiffness.mul(&repair)).for_each(|(entry, force)| *entry -= force);
        }
        if !keeps_all && is_moved {
            let mut held = vec![false; self.dofs()];
            for row in (0..self.rows()).filter(|&row| closed[row]) {
                by_row.column(row).filter(|entry| entry.1 != 0.0).for_each(|(dof, _)| held[dof] = true);
            }
            let (follow, force) = self.relaxed(&residual, &held);
            let both: Vec<f64> = repair.iter().zip(&follow).map(|(a, b)| a + b).collect();
            let (moved_by, terms, moves) =
                (self.contact.mul(&both), self.contact.mul_abs(&both), self.contact.mul_abs(&follow));
            let is_feasible = |row: usize| {
                let (violation, moved) = (answer.violation[row], moved_by[row]);
                moves[row] == 0.0 || violation + moved <= -SUM_ROUNDING * (violation.abs() + terms[row])
            };
            if (0..self.rows()).all(is_feasible) {
                repair = both;
                residual.iter_mut().zip(&force).for_each(|(entry, force)| *entry -= force);
            }
        }
        if !keeps_all {
            self.balance(&by_row, closed, &mut multiplier, &mut residual, || norm.is_over());
        }
        self.with_slack(norm, answer, &Repaired { repair, residual, multiplier, rest: placed.rest, closed })
    }

    /// Lets the closed rows take the force that is out of balance on their dofs, as far as they may push, if less is left then.
    fn balance(
        &self,
        by_row: &SparseMatrix,
        closed: &[bool],
        multiplier: &mut [f64],
        residual: &mut Vec<f64>,
        is_over: impl Fn() -> bool,
    ) {
        let Some(forces) = self.balancing(by_row, closed, residual, is_over) else { return };
        let pushed: Vec<f64> = multiplier.iter().zip(&forces).map(|(mu, force)| (mu + force).min(0.0)).collect();
        let change: Vec<f64> = pushed.iter().zip(&*multiplier).map(|(new, old)| new - old).collect();
        let left: Vec<f64> =
            residual.iter().zip(self.contact.mul_transposed(&change)).map(|(r, force)| r + force).collect();
        let size = |force: &[f64]| {
            let squares = force.iter().zip(&self.diagonal().values).filter(|entry| *entry.1 > 0.0);
            squares.map(|(force, stiffness)| force * force / stiffness).sum::<f64>()
        };
        if size(&left) < size(residual) {
            multiplier.copy_from_slice(&pushed);
            *residual = left;
        }
    }

    /// The bound of a repaired answer.
    fn with_slack(&self, norm: &EnergyNorm, answer: &Answer, repaired: &Repaired) -> ErrorBound {
        let Repaired { repair, residual, multiplier, rest, closed } = repaired;
        let parts = self.parts();
        let moved_by = self.contact.mul(repair);
        let mut slack_work = vec![0.0; parts.count()];
        for (row, part) in self.parts_of_rows(parts).into_iter().enumerate() {
            if multiplier[row] != 0.0 && !closed[row] {
                slack_work[part] += (answer.violation[row] + moved_by[row]).min(0.0) * multiplier[row];
            }
        }
        let length = |square: f64, slack: f64| (square + 2.0 * slack).max(0.0).sqrt();
        let total = |values: &[f64]| values.iter().sum::<f64>();
        // A shift of the answer changes its residual too, by K times the shift.
        let left = length(norm.of_force(residual).powi(2), total(&slack_work));
        let rounding = |row: usize| f64::EPSILON * answer.multiplier[row].abs();
        if norm.springs().is_some_and(|springs| !springs.hold(multiplier, closed, rounding, |_| left)) {
            return ErrorBound::none();
        }
        let whole = left + self.length(repair) + 2.0 * total(rest);
        let of_parts = (parts.count() > 1).then(|| {
            let mut sizes = rest.iter().map(|cost| 2.0 * cost).collect::<Vec<f64>>();
            self.add_sizes(parts, repair, &mut sizes);
            let energies = self.energies(parts, &norm.displacement(residual));
            sizes
                .iter_mut()
                .zip(energies.iter().zip(&slack_work))
                .for_each(|(size, (&e, &slack))| *size += length(e, slack));
            sizes
        });
        ErrorBound { whole, of_parts }
    }

    /// A displacement d that follows the force `residual` on all dofs that are not `held`, by a few steps of conjugate
    /// gradients, and K d.
    fn relaxed(&self, residual: &[f64], held: &[bool]) -> (Vec<f64>, Vec<f64>) {
        let diagonal = &self.diagonal().values;
        let free = |values: Vec<f64>| -> Vec<f64> {
            values.into_iter().zip(held).map(|(value, &held)| if held { 0.0 } else { value }).collect()
        };
        let scaled = |rest: &[f64]| -> Vec<f64> { rest.iter().zip(diagonal).map(|(r, d)| r / d).collect() };
        let (mut moved, mut force) = (vec![0.0; self.dofs()], vec![0.0; self.dofs()]);
        let mut rest = free(residual.to_vec());
        let mut preconditioned = scaled(&rest);
        let mut direction = preconditioned.clone();
        let mut work = dot(&rest, &preconditioned);
        for _ in 0..RELAXATIONS {
            let elastic = self.stiffness.mul(&direction);
            let step = work / dot(&direction, &elastic);
            if !step.is_finite() {
                break;
            }
            moved.iter_mut().zip(&direction).for_each(|(entry, d)| *entry += step * d);
            force.iter_mut().zip(&elastic).for_each(|(entry, k)| *entry += step * k);
            let change = free(elastic);
            rest.iter_mut().zip(&change).for_each(|(entry, k)| *entry -= step * k);
            preconditioned = scaled(&rest);
            let next = dot(&rest, &preconditioned);
            let share = next / work;
            direction.iter_mut().zip(&preconditioned).for_each(|(d, z)| *d = z + share * *d);
            work = next;
        }
        (moved, force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::linear::SymmetricMatrix;

    #[test]
    fn the_rest_of_the_body_follows_a_force_to_its_equilibrium() {
        // A chain of four springs between two walls: K = tridiag(-1, 2, -1) has (n - i) / n of a force on the first dof at dof i.
        let entries: Vec<_> = (0..4).map(|i| (i, i, 2.0)).chain((1..4).map(|i| (i, i - 1, -1.0))).collect();
        let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(4, 4, &entries).unwrap()).unwrap();
        let none = SparseMatrix::from_triplets(0, 4, &[]).unwrap();
        let problem = ContactProblem::new(stiffness, vec![0.0; 4], none, Vec::new()).unwrap();
        for (last_is_held, exact, force) in [
            (false, [0.8, 0.6, 0.4, 0.2], [1.0, 0.0, 0.0, 0.0]),
            (true, [0.75, 0.5, 0.25, 0.0], [1.0, 0.0, 0.0, -0.25]),
        ] {
            let (found, elastic) = problem.relaxed(&[1.0, 0.0, 0.0, 0.0], &[false, false, false, last_is_held]);
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < SUM_ROUNDING;
            assert!(found.iter().zip(&exact).all(is_near), "{found:?}");
            assert!(elastic.iter().zip(&force).all(is_near), "{elastic:?}");
        }
    }
}
