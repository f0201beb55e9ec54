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
//!
//! Obstacles that forces press are travels: dofs t without stiffness, `b'u + c t <= g`, c > 0, under a force F > 0.
//!
//! The energy does not see a travel, but its rows do. Some row of it presses in the exact answer, because only rows
//! carry F, and none is violated: `t* = min (g - b'u*)/c`. With the bound E on the error of the body in energy and the
//! reach r of each row in the body, each term is known up to `r E / c`, and so is their least one. The proof is then
//! that of the body alone, with rows that this uncertainty brings nearer.

use super::bound::Answer;
use super::bound::general::negligible;
use super::conditions::{Bounding, Evidence, examined};
use super::energy_norm::{EnergyNorm, ROUNDED_BOUND};
use super::reach::{ComplianceFactor, measured_reach, monotone_reach, within_reach};
use super::scales::least_reach;
use crate::error::Result;
use crate::linear::SymmetricMatrix;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, ProvenSet};

/// Rows that may be the least are swept one by one up to this number.
const MOST_SWEPT: usize = 200;

/// Rounding of a place on the way of a travel: a few units in the last place of its terms.
const PLACE_ROUNDING: f64 = 8.0 * f64::EPSILON;

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
    let by_eigenvalues = || measured_reach(problem, (multigrid, measured?.ritz), displacement, watch);
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

/// A travel: its dof, and its rows with their shares c > 0 along its load.
struct Travel {
    dof: usize,
    rows: Vec<(usize, f64)>,
}

/// The rows that an answer proves if dofs without stiffness are travels, and the rest is definite by itself.
pub fn proven_pressed(
    problem: &ContactProblem,
    [displacement, multiplier]: [&[f64]; 2],
    evidence: Evidence,
) -> Result<Option<ProvenSet>> {
    let Some(travels) = travels(problem).filter(|_| evidence.error.is_finite()) else { return Ok(None) };
    let is_body = |dof: &usize| travels.iter().all(|travel| travel.dof != *dof);
    let dofs: Vec<usize> = (0..problem.dofs()).filter(is_body).collect();
    let mut place = vec![None; problem.dofs()];
    dofs.iter().enumerate().for_each(|(index, &dof)| place[dof] = Some(index));
    let of_body = |values: &[f64]| dofs.iter().map(|&dof| values[dof]).collect::<Vec<f64>>();
    let lower = problem.stiffness.lower().select(dofs.len(), |row| place[row], dofs.iter().copied());
    let contact = problem.contact.select(problem.rows(), Some, dofs.iter().copied());
    let stiffness = SymmetricMatrix::from_lower(lower)?;
    let body = ContactProblem::computed(stiffness, of_body(&problem.load), contact, problem.gap.clone())?;
    let Some(norm) = EnergyNorm::of(&body.stiffness, &body.contact)? else { return Ok(None) };
    let displacement = of_body(displacement);
    let mut violation = body.accurate_violation(&displacement);
    for travel in &travels {
        travel.bring_near(&body, &norm, ROUNDED_BOUND * evidence.error, &mut violation);
    }
    let evidence = Evidence { residual: of_body(&evidence.residual), violation, measured: None, ..evidence };
    Ok(proven_in(&body, &norm, [&displacement, multiplier], Some(evidence)))
}

/// The travels; `None` without any, or if a dof without stiffness is none: all of its rows stop the same sense of
/// it, no other travel is in them, and a force drives it against them.
fn travels(problem: &ContactProblem) -> Option<Vec<Travel>> {
    let dofs = problem.without_stiffness();
    let mut is_taken = vec![false; problem.rows()];
    let of_dof = |&dof: &usize| {
        let sense = problem.load[dof].signum();
        let rows: Vec<(usize, f64)> =
            problem.contact.column(dof).filter(|entry| entry.1 != 0.0).map(|(row, c)| (row, sense * c)).collect();
        let is_own = |&(row, c): &(usize, f64)| c > 0.0 && !std::mem::replace(&mut is_taken[row], true);
        (problem.load[dof] != 0.0 && rows.iter().all(is_own)).then_some(Travel { dof, rows })
    };
    let travels: Vec<Travel> = dofs.iter().map(of_dof).collect::<Option<_>>()?;
    (!travels.is_empty()).then_some(travels)
}

impl Travel {
    /// Moves the rows of this travel to the place where it can be at most: `violation` is `b'u - g` before, and
    /// `b'u + c t - g` after, with all that is not known of t. The displacement of the body has an error of at most
    /// `error` in energy.
    fn bring_near(&self, body: &ContactProblem, norm: &EnergyNorm, error: f64, violation: &mut [f64]) {
        let compliance = ComplianceFactor::of(body, norm);
        let rough = compliance.reach_at_once().unwrap_or_else(|| vec![f64::INFINITY; body.rows()]);
        let place = |&(row, c): &(usize, f64)| -violation[row] / c;
        let nearest = self.rows.iter().map(place).fold(f64::INFINITY, f64::min);
        let mut off: Vec<f64> = self.rows.iter().map(|&(row, c)| error * rough[row] / c).collect();
        let candidates = |off: &[f64]| -> Vec<usize> {
            let surely = self.rows.iter().zip(off).map(|(row, off)| place(row) + off).fold(f64::INFINITY, f64::min);
            (0..off.len()).filter(|&index| place(&self.rows[index]) - off[index] <= surely).collect()
        };
        let first = candidates(&off);
        if first.len() <= MOST_SWEPT {
            for &index in &first {
                let (row, c) = self.rows[index];
                off[index] = off[index].min(error * compliance.reach(row) / c);
            }
        }
        let unsure = candidates(&off).into_iter().map(|index| off[index]).fold(0.0, f64::max);
        for &(row, c) in &self.rows {
            let rounding = PLACE_ROUNDING * (violation[row].abs() + (c * nearest).abs() + body.gap[row].abs());
            violation[row] += c * (nearest + unsure) + rounding;
        }
    }
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
    fn a_travel_may_be_farther_by_the_reach_of_its_row_over_its_share() {
        // Two dofs of stiffness 4 move the row by the root of 1/2 for an error of one. The travel has a share of 1/2 in
        // the row, which is open by 3 without it.
        let entries = [(0, 0, 4.0), (1, 1, 4.0)];
        let body = ContactProblem::of_entries(&entries, &[0.0; 2], &[(0, 0, 1.0), (0, 1, 1.0)], &[3.0]);
        let norm = norm_on_equalities(&body).unwrap().unwrap();
        let mut violation = [-3.0];
        Travel { dof: 2, rows: vec![(0, 0.5)] }.bring_near(&body, &norm, 1.0, &mut violation);
        assert!((0.5..0.5 + 1e-5).contains(&violation[0].powi(2)), "{violation:?}");
    }

    #[test]
    fn a_row_of_a_travel_is_open_if_it_is_so_by_more_than_the_error_of_the_body() {
        // u + t <= 3 and u + t <= 4 under a load of one on t: u = 7/4 and t = 5/4.
        let rows = [(0, 0, 1.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 1.0)];
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0, 1.0], &rows, &[3.0, 4.0]);
        for (error, is_open) in [(1e-3, true), (10.0, false)] {
            let (residual, violation) = (vec![0.0; 2], vec![0.0, -1.0]);
            let evidence = Evidence { residual, violation, error, measured: None, norm: None };
            let proven = proven_pressed(&problem, [&[1.75, 1.25], &[-1.0, 0.0]], evidence).unwrap().unwrap();
            assert_eq!([0, 1].map(|row| proven.open.contains(row)), [false, is_open], "{error}");
        }
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
