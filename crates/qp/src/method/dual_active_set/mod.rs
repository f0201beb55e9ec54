//! The dual active-set method for strictly convex problems: the last resort, slow and robust.
//!
//! It starts from the free point and repeatedly closes the row that is violated most. A row closes by a step in its
//! pressure; closed rows with a pressure that falls to zero in the step open. In every set the rows are independent and
//! all push, so that equal or dependent rows, and rows that are nearly parallel in energy, do no harm, and the dual
//! energy grows from set to set.
//!
//! ```text
//! base (u, y) = 0
//! repeat   pass: from the base to the nearest point of the polyhedron      (pass.rs)
//!          corrections of (u, y) on the set found, with accurate residuals
//! until all rows are met, by their accurate distances
//! ```
//!
//! A semidefinite K is made definite by a proximal term. The corrections and further passes remove it again, because
//! they start from the last answer.
//!
//! # Source
//! D. Goldfarb and A. Idnani, 1983, "A numerically stable dual method for solving strictly convex quadratic programs",
//! Mathematical Programming 27, pp. 1-33.

mod basis;
mod pass;
mod polyhedron;

use std::collections::HashSet;

use super::{Ending, Outcome, ScaledProblem, Solver, Start};
use crate::error::Error;
use crate::linear::{Augmented, norm};
use crate::problem::ContactProblem;
use pass::{Closed, Pass, Passed};
use polyhedron::{Contradiction, Polyhedron};

/// Largest number of passes: the second corrects errors hidden by the rounding of the first if dofs are of very
/// different scale.
const MOST_PASSES: usize = 10;

/// Least number of corrections of one set. The first gains all digits except the last, unless a part is so soft that
/// its energy is below the rounding of the others.
const CORRECTIONS: usize = 3;

/// Largest number of corrections of one set: a proximal term may need more.
const MOST_CORRECTIONS: usize = 30;

/// Another correction is worth its time if this one is below this share of the one before.
const SHRINKS: f64 = 0.5;

/// A change below this share of the free point is negligible, even if the answer is zero.
const NO_CHANGE: f64 = f64::EPSILON * f64::EPSILON;

/// A set with a last correction above this share of the answer has not converged.
const CONVERGED: f64 = 1e-10;

/// Rows are met to this number of units in the last place of their terms.
const ROW_MET: f64 = 4.0 * f64::EPSILON;

/// As [`ContactProblem::dual_active_set`].
pub(crate) fn dual_active_set(problem: &ContactProblem, is_definite: bool) -> Result<Outcome, Error> {
    let augmented = Augmented::new(problem.stiffness(), problem.contact(), None, 1);
    let scaled = ScaledProblem::new(problem, &augmented, is_definite);
    let Some(method) = DualActiveSet::of(&scaled)? else {
        return Err(Error::NotCondensed { step: "the dual active set" });
    };
    method.solve(Start::default())
}

/// The dual active-set method on a scaled problem, with its factorised polyhedron.
pub struct DualActiveSet<'a> {
    scaled: &'a ScaledProblem<'a>,
    polyhedron: Polyhedron,
}

impl<'a> DualActiveSet<'a> {
    /// Factorises the problem; `None` if that fails or the problem is too large for a dense basis of its rows.
    pub fn of(scaled: &'a ScaledProblem<'a>) -> Result<Option<Self>, Error> {
        Ok(Polyhedron::of(scaled)?.map(|polyhedron| DualActiveSet { scaled, polyhedron }))
    }
}

impl Solver for DualActiveSet<'_> {
    /// Solves the problem, or finds rows that contradict each other; it always starts from the free point.
    ///
    /// The answer is not settled if the method was cut short or if its corrections do not converge, for example if rows
    /// and stiffness do not hold the body: the method makes no claim about that.
    fn solve(&self, _: Start) -> Result<Outcome, Error> {
        let (dofs, rows) = (self.scaled.problem.dofs(), self.scaled.problem.rows());
        let mut search = Search {
            polyhedron: &self.polyhedron,
            closed: Closed { pressures: vec![0.0; rows], rests: vec![0.0; rows], ..Closed::default() },
            displacement: vec![0.0; dofs],
            point: vec![0.0; dofs],
        };
        let mut seen = HashSet::new();
        let mut ending = Ending::Unsettled;
        for _ in 0..MOST_PASSES {
            let passed = match search.pass(self.scaled) {
                Ok(passed) => passed,
                Err(Contradiction { rows, weights }) => {
                    ending = Ending::Infeasible { rows, weights };
                    break;
                }
            };
            let converged = search.correct();
            let violated = search.violates();
            ending = Ending::of(passed == Passed::Met && converged && !violated);
            let pulls = search.closed.pressures.iter().any(|&pressure| pressure < 0.0);
            // A set that returns once would return in every further pass.
            if ending == Ending::Settled && !pulls
                || self.scaled.watch().is_over()
                || !seen.insert(search.closed.basis.set(rows))
            {
                break;
            }
        }
        let Closed { basis, pressures, history, .. } = search.closed;
        let (displacement, multiplier) = self.polyhedron.expand(&search.displacement, &pressures);
        let (contact_set, iterations) = (basis.set(rows), history.len());
        let variant = if ending == Ending::Settled { "-dual" } else { "-dual-unsettled" };
        Ok(Outcome { displacement, multiplier, contact_set, iterations, history, ending, variant })
    }
}

/// The best answer so far, in the units of the polyhedron.
struct Search<'a> {
    polyhedron: &'a Polyhedron,
    closed: Closed,
    displacement: Vec<f64>,
    /// L' u.
    point: Vec<f64>,
}

impl Search<'_> {
    /// The imbalance `L^-1 (f - B'y - K u)`, and the distances of the rows, both from accurate sums.
    fn residuals(&self) -> (Vec<f64>, Vec<f64>) {
        let problem = &self.polyhedron.problem;
        let forces = [negative(&self.closed.pressures), negative(&self.closed.rests)];
        let imbalance = problem.accurate_residual_of(&self.displacement, &[&forces[0], &forces[1]]);
        (self.polyhedron.of_force(&imbalance), negative(&problem.accurate_violation(&self.displacement)))
    }

    /// One pass from the answer so far. The basis is computed from the data again, without the errors of its updates.
    fn pass(&mut self, scaled: &ScaledProblem) -> Result<Passed, Contradiction> {
        let residuals = self.residuals();
        let base = norm(&self.point);
        let mut pass = Pass::new(self.polyhedron, &mut self.closed, residuals, base);
        let ending = pass.run(scaled.watch())?;
        let change = pass.point;
        self.advance(&change);
        self.closed.basis = pass::of_rows(self.polyhedron, self.closed.basis.rows());
        Ok(ending)
    }

    fn advance(&mut self, change: &[f64]) {
        self.point.iter_mut().zip(change).for_each(|(entry, change)| *entry += change);
        let moved = self.polyhedron.displacement(change);
        self.displacement.iter_mut().zip(&moved).for_each(|(u, moved)| *u += moved);
    }

    /// The change of the point that balances the forces with the closed rows at their gaps, and the change of their
    /// pressures.
    fn correction(&self, imbalance: &[f64], distances: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let on_closed: Vec<f64> = self.closed.basis.rows().iter().map(|&row| distances[row]).collect();
        self.closed.basis.nearest(imbalance, &on_closed)
    }

    /// Corrects the answer on its set until another correction gains nothing. Returns `true` if it converges.
    fn correct(&mut self) -> bool {
        let mut last = f64::INFINITY;
        for turn in 0..MOST_CORRECTIONS {
            let (imbalance, distances) = self.residuals();
            let (change, changes) = self.correction(&imbalance, &distances);
            let step = norm(&change);
            if turn >= CORRECTIONS && step > SHRINKS * last {
                break;
            }
            self.advance(&change);
            let Closed { basis, pressures, rests, .. } = &mut self.closed;
            for (&row, change) in basis.rows().iter().zip(&changes) {
                let (before, change) = (pressures[row], rests[row] + change);
                pressures[row] = before + change;
                rests[row] = change - (pressures[row] - before);
            }
            last = step;
            if step <= NO_CHANGE * self.polyhedron.reach {
                break;
            }
        }
        last <= CONVERGED * norm(&self.point)
    }

    /// Returns `true` if an open row is violated beyond rounding. A violation within the rounding of the closed rows
    /// does not count: otherwise two rows that differ by their scale only would be exchanged without end.
    fn violates(&self) -> bool {
        let problem = &self.polyhedron.problem;
        let distances = negative(&problem.accurate_violation(&self.displacement));
        let at_rest = vec![0.0; self.displacement.len()];
        let (to_closed, _) = self.correction(&at_rest, &distances);
        let explained = problem.contact().mul(&self.polyhedron.displacement(&to_closed));
        let terms = problem.contact().mul_abs(&self.displacement);
        let violation = |row: usize| explained[row] - distances[row];
        (0..distances.len()).any(|row| violation(row) > ROW_MET * (terms[row] + problem.gap()[row].abs()))
    }
}

fn negative(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| -value).collect()
}
