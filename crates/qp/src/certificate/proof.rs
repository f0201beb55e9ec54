//! The rows of a contact set that are proven open or closed, from the bound on the energy norm of the error.
//!
//! With `|u - u*|_K <= E` and the compliance `G = B K^-1 B'` of the rows:
//!
//! * `|B_i (u - u*)| <= sqrt(G_ii) E`: a row with a larger distance is open in the exact answer too.
//! * Let C be all other rows, `r = f + B_C' lambda_C - K u`, and w a shift with `B_i w = 1` that moves no other row of
//!   C. From `B_C' (lambda - lambda*)_C = r + K (u - u*)`: `|lambda_i - lambda*_i| <= |w|_K (|r|_{K^-1} + E)`. A row
//!   with a larger force is closed in the exact answer too. The cheapest such shift has `|w|_K^2 = (G_CC^-1)_ii`.
//!
//! If only springs D on equalities make K definite, both hold in the norm of `K_D = K + B' D B`: an answer that misses
//! the equalities by d has there an error of at most `sqrt(E^2 + d'D d)`.

use super::bound::Answer;
use super::bound::row_by_row::negligible;
use super::conditions::{Bounding, Evidence, examined};
use super::energy_norm::{EnergyNorm, ROUNDED_BOUND};
use super::reach::{ComplianceFactor, largest_eigenvalue, measured_reach, monotone_reach, within_reach};
use super::scales::least_reach;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, ProvenSet};

/// Accuracy of the solve for an M-matrix without a factor; its error widens the bounds.
const ROUGH: f64 = 1e-2;

/// Largest number of cycles of that solve.
const MOST_CYCLES: usize = 20;

/// Multiplications that the compliance of the rows in question may cost; beyond this, one dof of each row is moved
/// alone.
const MOST_WORK: f64 = 2e9;

impl Evidence {
    /// The same with the rounding of its bound; `None` if no bound is known.
    fn bounded(self) -> Option<Self> {
        let error = ROUNDED_BOUND * self.error;
        error.is_finite().then_some(Evidence { error, ..self })
    }
}

/// The rows that an answer proves in an energy norm.
pub fn proven_in(
    problem: &ContactProblem,
    norm: &EnergyNorm,
    [displacement, multiplier]: [&[f64]; 2],
    evidence: Option<Evidence>,
) -> Option<ProvenSet> {
    if norm.loose_dofs() > 0 {
        return None;
    }
    let found = || examined(problem, &Bounding::Factor(norm.clone()), [displacement, multiplier]).ok()?.evidence;
    let Evidence { residual, violation, error, .. } = evidence.or_else(found)?.bounded()?;
    let error = error.hypot(norm.length_of_springs(&violation));
    let answer = Answer { problem, displacement, multiplier, residual, violation, rounding: 0.0 };
    let compliance = ComplianceFactor::of(problem, norm);
    // One solve saves sweeps.
    let at_once = || compliance.reach_at_once().or_else(|| monotone_reach(problem, |s| Some(norm.displacement(s))));
    let reach = if norm.is_over() { None } else { at_once() }.unwrap_or_else(|| vec![f64::INFINITY; problem.rows()]);
    let (distances, least) = (distances(&answer), least_reach(problem));
    let mut open = open_by(problem, &distances, error, &reach);
    let limits = distances.iter().map(|distance| distance / error).enumerate();
    let is_doubtful = |&(row, limit): &(usize, f64)| limit > least[row] && !open.contains(row);
    let doubtful: Vec<(usize, f64)> = limits.filter(is_doubtful).collect();
    within_reach(&compliance, &doubtful).into_iter().for_each(|row| open.insert(row));
    let of_force = ROUNDED_BOUND * norm.of_force(&unbalanced(&answer, &open).0);
    let imbalance = of_force + error;
    let mut closed = closed_alone(&answer, &open, imbalance);
    let in_question: Vec<usize> = (0..problem.rows()).filter(|&row| !open.contains(row)).collect();
    let is_doubtful = |row: &usize| multiplier[*row] < 0.0 && !closed.contains(*row);
    if in_question.iter().any(is_doubtful) && compliance.work(in_question.len()) <= MOST_WORK {
        for (&row, length) in in_question.iter().zip(compliance.moved_together(&in_question)) {
            if -multiplier[row] > length * imbalance {
                closed.insert(row);
            }
        }
    }
    Some(ProvenSet { open, closed })
}

/// The same without a factor: with the bound by the cycles of the hierarchy of K, and one solve by cycles for an
/// M-matrix. `None` if the cycles find no bound, or if K is singular.
pub fn proven_by_cycles(
    problem: &ContactProblem,
    multigrid: &Multigrid,
    watch: &Watch,
    [displacement, multiplier]: [&[f64]; 2],
    evidence: Evidence,
) -> Option<ProvenSet> {
    // Without a bound on the move of a travel, nothing is known of its rows.
    if multigrid.is_shifted() || !problem.without_stiffness().is_empty() {
        return None;
    }
    let Evidence { residual, violation, error, measured, .. } = evidence.bounded()?;
    let answer = Answer { problem, displacement, multiplier, residual, violation, rounding: 0.0 };
    let stiffness = multigrid.preconditioning(&problem.stiffness);
    let reach = monotone_reach(problem, |s| stiffness.solve(s, ROUGH, MOST_CYCLES).ok().map(|found| found.solution));
    let by_eigenvalues = || {
        let least = measured?.ritz;
        Some(measured_reach(problem, least, largest_eigenvalue(problem, multigrid, displacement, watch)?))
    };
    let reach = reach.or_else(by_eigenvalues).unwrap_or_else(|| vec![f64::INFINITY; problem.rows()]);
    let open = open_by(problem, &distances(&answer), error, &reach);
    let (force, is_residual) = unbalanced(&answer, &open);
    let of_force = match measured {
        Some(measured) if is_residual => Some(measured.of_residual),
        _ => stiffness.dual_norm(&force, watch).map(|norm| ROUNDED_BOUND * norm.most),
    };
    let closed = closed_alone(&answer, &open, of_force.map_or(f64::INFINITY, |force| force + error));
    Some(ProvenSet { open, closed })
}

/// The distance `g - B u` of each row, less its possible error from rounding of u; infinite without obstacle.
fn distances(answer: &Answer) -> Vec<f64> {
    let distances = answer.violation.iter().zip(negligible(answer.problem, answer.displacement));
    distances.map(|(violation, negligible)| -violation - negligible).collect()
}

/// The rows at these `distances` that are open beyond an error of `error` in the energy norm; `reach` bounds the
/// move of each row by it.
fn open_by(problem: &ContactProblem, distances: &[f64], error: f64, reach: &[f64]) -> ContactSet {
    ContactSet::from_fn(problem.rows(), |row| {
        let distance = distances[row];
        distance > 0.0 && (distance.is_infinite() || error == 0.0 || distance > reach[row] * error)
    })
}

/// The force that is out of balance without the multipliers of the `open` rows, and `true` if that is the residual.
fn unbalanced(answer: &Answer, open: &ContactSet) -> (Vec<f64>, bool) {
    let dropped: Vec<f64> =
        (0..answer.problem.rows()).map(|row| if open.contains(row) { -answer.multiplier[row] } else { 0.0 }).collect();
    let (mut force, is_residual) = (answer.residual.clone(), dropped.iter().all(|&force| force == 0.0));
    if !is_residual {
        force.iter_mut().zip(answer.problem.contact.mul_transposed(&dropped)).for_each(|(r, part)| *r += part);
    }
    (force, is_residual)
}

/// The rows that are closed, proven by one dof each: the shift of that dof moves no other row that is not `open`.
fn closed_alone(answer: &Answer, open: &ContactSet, imbalance: f64) -> ContactSet {
    let problem = answer.problem;
    // `|w|_K` of that shift.
    let mut lengths = vec![f64::INFINITY; problem.rows()];
    for (dof, &stiffness) in problem.diagonal().values.iter().enumerate() {
        let mut felt = problem.contact.column(dof).filter(|&(row, b)| b != 0.0 && !open.contains(row));
        if let (Some((row, b)), None) = (felt.next(), felt.next()) {
            lengths[row] = lengths[row].min(stiffness.sqrt() / b.abs());
        }
    }
    ContactSet::from_fn(problem.rows(), |row| -answer.multiplier[row] > lengths[row] * imbalance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::norm_on_equalities;

    /// A spring of stiffness one from a support to a wall, which it presses with 1e-9.
    #[test]
    fn an_answer_beside_its_support_proves_no_row_open() {
        let k = [(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)];
        let rows = [(0, 1, 1.0), (1, 0, 1.0), (2, 0, -1.0)];
        let problem = ContactProblem::of_entries(&k, &[0.0, 1.0 + 1e-9], &rows, &[1.0, 0.0, 0.0]);
        let norm = norm_on_equalities(&problem).unwrap().unwrap();
        let open = |off: f64| {
            let (displacement, multiplier) = ([off, 1.0 + off], [0.0, -1.0, 0.0]);
            proven_in(&problem, &norm, [&displacement, &multiplier], None).is_some_and(|proven| proven.open.contains(0))
        };
        // Both ends off by as much keep the energy and the forces.
        assert!(!open(-0.1) && !open(-1e-6));
    }

    #[test]
    fn what_is_out_of_balance_without_the_open_rows_is_free_of_their_forces() {
        // K = 4, f = 8 and u = 1: a row that is proven open has no force in the exact answer, and -4 on the other
        // balances.
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0], &[(0, 0, 1.0), (1, 0, -2.0)], &[1.0, 9.0]);
        let (displacement, multiplier) = ([1.0], [-4.0, -0.5]);
        let answer = Answer::of(&problem, &displacement, &multiplier);
        assert_eq!(answer.residual, [1.0]);
        for (open, balance) in [([false, true], 0.0), ([false, false], 1.0)] {
            let left = unbalanced(&answer, &open.into_iter().collect());
            assert_eq!((left.1, &left.0[..]), (!open[1], &[balance][..]));
        }
    }
}
