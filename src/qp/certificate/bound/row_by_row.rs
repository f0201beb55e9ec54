//! The bound if the contact boundary is not known: rows are repaired one by one, each by its own dofs.

use super::{Answer, EnergyNorm, ErrorBound, Keeping};
use crate::qp::linear::{SparseMatrix, dot};
use crate::qp::problem::ContactProblem;

/// Rounding of a sum, relative to the sum of its terms.
const SUM_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Sweeps over the rows when a displacement is repaired row by row.
const REPAIR_SWEEPS: usize = 50;

/// Steps in which the rest of the body adapts to the rows that were put at their gaps; each costs a product with K.
const RELAXATIONS: usize = 20;

/// When a sweep contributes less than this share of the sum of all sweeps, those that follow contribute at most that sum again.
const LAST: f64 = 0.01;

/// The place of a row that a bound needs.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Aim {
    /// At its gap: its force does no work then.
    AtGap,
    /// At its gap or open, without a force.
    WithinGap,
    /// Open, at its place: its force and the distance that is left are already counted.
    Stays,
}

/// A repaired answer; its rows are put at their aims.
struct Start<'a> {
    answer: &'a Answer<'a>,
    /// `B d` of the repair d.
    moved_by: &'a [f64],
    aims: &'a [Aim],
}

impl ContactProblem {
    /// Possible rounding error of B u - g from rounding of u, row by row.
    pub(in super::super) fn negligible(&self, displacement: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = displacement.iter().map(|value| SUM_ROUNDING * value).collect();
        self.contact.mul_abs(&magnitude)
    }

    /// The bound from a displacement with rows moved one after the other, each by its own dofs: the closed ones to their gaps,
    /// all others out of their obstacles.
    pub(super) fn bound_row_by_row(&self, norm: &EnergyNorm, answer: &Answer, keeping: Keeping) -> ErrorBound {
        let by_row = self.contact.transposed();
        let is_closed = |row: usize| match keeping {
            Keeping::All => false,
            Keeping::Closed(closed) => closed[row],
        };
        let keeps_all = matches!(keeping, Keeping::All);
        let Some(mut repair) = self.repair(&by_row, answer, is_closed) else { return ErrorBound::none() };
        let is_moved = repair.iter().any(|&change| change != 0.0);
        let mut multiplier: Vec<f64> = (0..self.rows())
            .map(|row| if keeps_all || is_closed(row) { answer.multiplier[row].min(0.0) } else { 0.0 })
            .collect();
        let dropped: Vec<f64> = multiplier.iter().zip(answer.multiplier).map(|(mu, lambda)| mu - lambda).collect();
        let mut residual = answer.residual.clone();
        residual.iter_mut().zip(self.contact.mul_transposed(&dropped)).for_each(|(entry, force)| *entry += force);
        if is_moved {
            residual.iter_mut().zip(self.stiffness.mul(&repair)).for_each(|(entry, force)| *entry -= force);
        }
        if !keeps_all && is_moved {
            let mut held = vec![false; self.dofs()];
            for row in (0..self.rows()).filter(|&row| is_closed(row)) {
                by_row.column(row).filter(|entry| entry.1 != 0.0).for_each(|(dof, _)| held[dof] = true);
            }
            let (follow, force) = self.relaxed(&residual, &held);
            let both: Vec<f64> = repair.iter().zip(&follow).map(|(a, b)| a + b).collect();
            let moved_by = self.contact.mul(&both);
            let is_feasible = |row: usize| is_closed(row) || answer.violation[row] + moved_by[row] <= 0.0;
            if (0..self.rows()).all(is_feasible) {
                repair = both;
                residual.iter_mut().zip(&force).for_each(|(entry, force)| *entry -= force);
            }
        }
        // The row on a single dof takes the force that is out of balance there, as far as it may push.
        for row in (0..self.rows()).filter(|&row| is_closed(row)) {
            let mut entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            if let (Some((dof, b)), None) = (entries.next(), entries.next()) {
                let pushed = (multiplier[row] - residual[dof] / b).min(0.0);
                residual[dof] += b * (pushed - multiplier[row]);
                multiplier[row] = pushed;
            }
        }
        self.with_slack(norm, &by_row, answer, &repair, &residual, &multiplier)
    }

    /// The bound of a repaired answer: u moved by `repair`, with its `residual` and `multiplier`. Rows that rounding still
    /// holds off their gaps are put there along themselves, at the cost of those shifts.
    fn with_slack(
        &self,
        norm: &EnergyNorm,
        by_row: &SparseMatrix,
        answer: &Answer,
        repair: &[f64],
        residual: &[f64],
        multiplier: &[f64],
    ) -> ErrorBound {
        let parts = self.parts();
        let (moved_by, negligible) = (self.contact.mul(repair), self.negligible(answer.displacement));
        let mut at_gap = vec![false; self.rows()];
        let (mut slack_work, mut aims) = (vec![0.0; parts.count()], vec![Aim::Stays; self.rows()]);
        let part_of_row = self.parts_of_rows(parts);
        for (row, &part) in part_of_row.iter().enumerate() {
            let distance = answer.violation[row] + moved_by[row];
            at_gap[row] = distance.abs() <= negligible[row];
            aims[row] = match multiplier[row] != 0.0 {
                true if distance >= -negligible[row] => Aim::AtGap,
                true if distance.is_finite() => {
                    slack_work[part] += distance * multiplier[row];
                    Aim::Stays
                }
                _ => Aim::WithinGap,
            };
        }
        let start = Start { answer, moved_by: &moved_by, aims: &aims };
        let Some(put) = self.put_along_rows(by_row, &start) else { return ErrorBound::none() };
        let mut put_in_parts = vec![0.0; parts.count()];
        part_of_row.iter().zip(&put).for_each(|(&part, cost)| put_in_parts[part] += cost);
        let put = put_in_parts;
        let length = |square: f64, slack: f64| (square + 2.0 * slack).max(0.0).sqrt();
        let total = |values: &[f64]| values.iter().sum::<f64>();
        // A shift of the answer changes its residual too, by K times the shift.
        let left = length(norm.of_force(residual).powi(2), total(&slack_work));
        if norm.springs().is_some_and(|springs| {
            !springs.hold(multiplier, &at_gap, |row| f64::EPSILON * answer.multiplier[row].abs(), |_| left)
        }) {
            return ErrorBound::none();
        }
        let whole = left + self.length(repair) + 2.0 * total(&put);
        let of_parts = (parts.count() > 1).then(|| {
            let mut sizes = put.iter().map(|cost| 2.0 * cost).collect::<Vec<f64>>();
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

    /// An upper bound on the energy norm of the shifts that put rows at their aims, row by row. Each shift moves other rows
    /// too, so sweeps are repeated until the last one is small beside the sum; `None` if it stays large.
    fn put_along_rows(&self, by_row: &SparseMatrix, start: &Start) -> Option<Vec<f64>> {
        let lengths = self.lengths_along_rows();
        let (mut put, mut total, mut change) = (vec![0.0; self.rows()], 0.0, vec![0.0; self.dofs()]);
        for _ in 0..REPAIR_SWEEPS {
            let mut last = 0.0;
            for (row, &aim) in start.aims.iter().enumerate() {
                let moved: f64 = by_row.column(row).map(|(dof, b)| b * change[dof]).sum();
                let distance = start.answer.violation[row] + start.moved_by[row] + moved;
                if distance == 0.0 || !(aim == Aim::AtGap || distance > 0.0) {
                    continue;
                }
                let square: f64 = by_row.column(row).map(|(_, b)| b * b).sum();
                if square == 0.0 {
                    return None;
                }
                by_row.column(row).for_each(|(dof, b)| change[dof] -= distance / square * b);
                put[row] += distance.abs() * lengths[row];
                last += distance.abs() * lengths[row];
            }
            total += last;
            if last <= LAST * total {
                // The sweeps that would follow add at most as much again.
                let follow = if last > 0.0 { 2.0 } else { 1.0 };
                return Some(put.iter().map(|cost| follow * cost).collect());
            }
        }
        None
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

    /// A change of u that puts the closed rows at their gaps and removes all penetration except for rounding of u, by
    /// projections row after row; `None` if rows contradict each other.
    fn repair(&self, by_row: &SparseMatrix, answer: &Answer, is_closed: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
        let mut change = vec![0.0; self.dofs()];
        let negligible = self.negligible(answer.displacement);
        for sweep in 0..REPAIR_SWEEPS {
            // The last sweeps stop at rounding of u, the first ones at that of the change.
            let patient = sweep < REPAIR_SWEEPS / 2;
            let mut clean = true;
            for (row, &negligible) in negligible.iter().enumerate() {
                let (moved, terms) = by_row.column(row).map(|(dof, b)| b * change[dof]).fold((0.0, 0.0), add_term);
                let excess = answer.violation[row] + moved;
                // A row that contradicts a closed one as an equality may still be met as an inequality.
                let open = excess < 0.0 && !(is_closed(row) && patient);
                let rounding = SUM_ROUNDING * (answer.violation[row].abs() + terms);
                if excess == 0.0 || open || excess.abs() <= if patient { rounding } else { negligible.max(rounding) } {
                    continue;
                }
                let square: f64 = by_row.column(row).map(|(_, b)| b * b).sum();
                if square == 0.0 {
                    return None;
                }
                clean = false;
                for (dof, b) in by_row.column(row) {
                    change[dof] -= excess / square * b;
                }
            }
            if clean {
                return Some(change);
            }
        }
        None
    }
}

/// A sum and the sum of magnitudes, with one more term.
fn add_term((sum, magnitudes): (f64, f64), term: f64) -> (f64, f64) {
    (sum + term, magnitudes + term.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::linear::SymmetricMatrix;

    #[test]
    fn a_row_off_its_gap_is_put_there_along_itself_and_a_row_of_zeros_cannot_be() {
        let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, 4.0), (1, 1, 16.0)]).unwrap();
        let contact = SparseMatrix::from_triplets(2, 2, &[(0, 0, 3.0), (0, 1, 4.0)]).unwrap();
        let stiffness = SymmetricMatrix::from_lower(stiffness).unwrap();
        let problem = ContactProblem::new(stiffness, vec![0.0; 2], contact, vec![0.0; 2]).unwrap();
        let put = |violation: [f64; 2], aims: [Aim; 2]| {
            let (displacement, multiplier) = ([0.0; 2], [0.0; 2]);
            let answer = Answer {
                displacement: &displacement,
                multiplier: &multiplier,
                residual: vec![0.0; 2],
                violation: &violation,
            };
            problem.put_along_rows(
                &problem.contact.transposed(),
                &Start { answer: &answer, moved_by: &[0.0; 2], aims: &aims },
            )
        };
        // A distance of 25 moves the dofs by 3 and 4: against roots of stiffness of 2 and 4, 6 + 16 at most.
        let at_gap = [Aim::AtGap, Aim::WithinGap];
        assert_eq!(put([25.0, -1.0], at_gap), Some(vec![22.0, 0.0]));
        assert_eq!(put([-25.0, -1.0], at_gap), Some(vec![22.0, 0.0]));
        // Open rows keep their values, unless they have to be at their gaps.
        assert_eq!(put([-25.0, -1.0], [Aim::WithinGap; 2]), Some(vec![0.0, 0.0]));
        assert_eq!(put([25.0, 1.0], at_gap), None);
    }

    /// Two dofs of stiffness 4, and these rows, with their gaps at zero.
    fn two(rows: [[f64; 2]; 2]) -> ContactProblem {
        let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, 4.0), (1, 1, 4.0)]).unwrap();
        let entries: Vec<_> = (0..4).map(|at| (at / 2, at % 2, rows[at / 2][at % 2])).collect();
        let contact = SparseMatrix::from_triplets(2, 2, &entries).unwrap();
        ContactProblem::new(SymmetricMatrix::from_lower(stiffness).unwrap(), vec![0.0; 2], contact, vec![0.0; 2])
            .unwrap()
    }

    fn off<'a>(violation: &'a [f64]) -> Answer<'a> {
        Answer { displacement: &[0.0; 2], multiplier: &[0.0; 2], residual: vec![0.0; 2], violation }
    }

    #[test]
    fn rows_that_move_each_other_are_put_at_their_gaps_at_the_cost_of_all_their_shifts() {
        let problem = two([[1.0, 0.0], [1.0, 1.0]]);
        let start = Start { answer: &off(&[1.0, 0.0]), moved_by: &[0.0; 2], aims: &[Aim::AtGap; 2] };
        let put = problem.put_along_rows(&problem.contact.transposed(), &start).unwrap();
        // Each sweep moves either row half as far as the one before, first by 1, at a cost of 2 for each: 2 + 1 + 1/2 + ...
        let whole = 4.0;
        assert!(put[0] == put[1] && (whole..=2.0 * whole).contains(&put[0]), "{put:?}");
        // The sweeps end when the last is a hundredth of their sum; the rest then counts as much as all sweeps.
        assert!(put[0] >= 2.0 * (1.0 - LAST) * whole, "{put:?}");
    }

    #[test]
    fn a_penetration_is_taken_back_in_any_unit_and_an_open_row_stays() {
        let problem = two([[1.0, 0.0], [0.0, 2.0]]);
        for unit in [1e-12, 1.0, 1e12] {
            let violation = [3.0 * unit, -unit];
            let repair = |is_closed: &dyn Fn(usize) -> bool| {
                problem.repair(&problem.contact.transposed(), &off(&violation), is_closed).unwrap()
            };
            assert_eq!(repair(&|_| false), [-3.0 * unit, 0.0]);
            assert_eq!(repair(&|_| true), [-3.0 * unit, unit / 2.0]);
        }
    }

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
