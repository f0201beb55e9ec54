//! The penalty loop: `G = eps C (u - g)`, with eps ten times larger from rung to rung.
//!
//! ```text
//! for eps = eps0, 10 eps0, ...:
//!     repeat: solve (K + eps C) u = f + eps C g;  C <- heaviside(u - g)     until C repeats
//!     stop when norm(C (u - g)) < threshold
//! ```
//!
//! The relative error of the multiplier is k/(k + eps) plus a rounding part that grows with eps. Both are equal near
//! eps = 1e8 k; there the ladder ends. The rounding part comes from cancellation in u - g, so each solve is for the
//! change from the last displacement, in which u - g is small.

use std::collections::HashSet;

use super::{Ending, Outcome, ScaledProblem};
use crate::error::Result;
use crate::linear::{Cholesky, largest};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration};

/// The penalty at which the two parts of the error are equal: one over the square root of the machine precision.
pub const BEST_PENALTY: f64 = 1e8;

/// The ladder of penalties of [`Method::Penalty`](crate::Method::Penalty), and the conditions under which it ends
/// early.
///
/// ```
/// use signorini_qp::{Method, Penalty, Settings};
///
/// let settings = Settings::with_method(Method::Penalty(Penalty { last: 1e3, ..Penalty::default() }));
/// assert_eq!(settings.method.name(), "penalty");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty {
    /// First penalty, in multiples of the local stiffness.
    pub first: f64,
    /// Last penalty, in multiples of the local stiffness; 1e8 balances penetration and rounding.
    pub last: f64,
    /// Penetration at which the ladder ends, relative to the largest displacement of a contact row.
    pub penetration_threshold: f64,
}

impl Penalty {
    /// The ladder from 1 to [`BEST_PENALTY`].
    pub(crate) const DEFAULT: Penalty = Penalty { first: 1.0, last: BEST_PENALTY, penetration_threshold: 1e-10 };
}

impl Default for Penalty {
    fn default() -> Self {
        Penalty::DEFAULT
    }
}

/// Factor from rung to rung.
const RUNG: f64 = 10.0;

/// A rung with a bound above this share of the previous one is the floor: more penalty only adds rounding.
const FLOOR: f64 = 0.5;

/// Solves on the last rung after the set has settled: in the second the shift is the displacement itself.
const FINAL_SOLVES: usize = 2;

/// A relative error in the energy norm, and the bound on that of an answer (displacement, multiplier).
pub type AccuracyGoal<'a> = (f64, &'a dyn Fn(&[f64], &[f64]) -> f64);

/// Climbs the ladder from the set `closed`, by at most `most_iterations` factorisations in all, or to its goal.
pub fn solve(
    scaled: &ScaledProblem,
    ladder: Penalty,
    closed: ContactSet,
    most_iterations: usize,
    goal: Option<AccuracyGoal>,
) -> Result<Outcome> {
    let problem = scaled.problem;
    let (displacement, violation) = (vec![0.0; problem.dofs()], vec![f64::NEG_INFINITY; problem.rows()]);
    let mut climb = Climb { closed, displacement, violation, history: Vec::new(), ending: Ending::Unsettled };
    let (mut penalty, mut last_bound) = (ladder.first, f64::INFINITY);
    let multiplier = loop {
        climb.settle(scaled, penalty, most_iterations)?;
        let (multiplier, is_settled) = (climb.multiplier(penalty), climb.ending == Ending::Settled);
        if let Some((accuracy, bound)) = goal.filter(|_| is_settled) {
            let bound = bound(&climb.displacement, &multiplier);
            if bound <= accuracy || (bound > FLOOR * last_bound && bound.is_finite()) {
                break multiplier;
            }
            last_bound = bound;
        }
        // The largest penetration of a closed row, as a share of the largest displacement of a row.
        let is_small = || {
            let penetration = climb.closed.iter().map(|row| climb.violation[row]).fold(0.0, f64::max);
            penetration <= ladder.penetration_threshold * largest(&problem.contact().mul(&climb.displacement))
        };
        let is_last = penalty * RUNG > ladder.last || climb.history.len() >= most_iterations;
        if is_settled && is_small() || scaled.watch.is_over() || is_last || climb.ending == Ending::Unheld {
            break multiplier;
        }
        penalty *= RUNG;
    };
    let Climb { closed: contact_set, displacement, history, ending, .. } = climb;
    let variant = if ending == Ending::Settled { "" } else { "-unsettled" };
    Ok(Outcome { displacement, multiplier, contact_set, iterations: history.len(), history, ending, variant })
}

/// The state of the loop between two rungs.
struct Climb {
    closed: ContactSet,
    displacement: Vec<f64>,
    /// B u - g of each row, kept to the relative precision of the change that made it.
    violation: Vec<f64>,
    history: Vec<Iteration>,
    /// Settled if the last rung ended with the set that it began with.
    ending: Ending,
}

impl Climb {
    /// One rung: exchanges the rows of the set until it returns, or until the loop must end.
    fn settle(&mut self, scaled: &ScaledProblem, penalty: f64, most_iterations: usize) -> Result<()> {
        let mut seen = HashSet::new();
        self.ending = Ending::Unsettled;
        while self.ending == Ending::Unsettled
            && seen.insert(self.closed.clone())
            && self.history.len() < most_iterations
            && (self.history.is_empty() || !scaled.watch.is_over())
        {
            scaled.watch.step("penalty loop", self.history.len() + 1);
            let factor = match scaled.hold_with_more(&mut self.closed, penalty, &self.displacement)? {
                Ok(factor) => factor,
                Err(ending) => {
                    self.ending = ending;
                    break;
                }
            };
            self.history.push(Iteration { contact_set: self.closed.clone(), penalty });
            self.advance(scaled.problem, &factor, penalty);
            let next = ContactSet::from_fn(scaled.problem.rows(), |row| self.violation[row] > 0.0);
            self.ending = Ending::of(next == self.closed);
            if self.ending == Ending::Settled {
                (0..FINAL_SOLVES).for_each(|_| self.advance(scaled.problem, &factor, penalty));
            }
            self.closed = next;
        }
        Ok(())
    }

    /// The forces of the closed rows as springs of this penalty.
    fn multiplier(&self, penalty: f64) -> Vec<f64> {
        let force = |(row, violation): (usize, &f64)| {
            if self.closed.contains(row) { -penalty * violation.max(0.0) } else { 0.0 }
        };
        self.violation.iter().enumerate().map(force).collect()
    }

    /// Solves (K + eps B_C'B_C) v = (f - K u) + eps B_C'(g - B u), by the factor of its matrix, and moves u to u + v.
    fn advance(&mut self, problem: &ContactProblem, factor: &Cholesky, penalty: f64) {
        let distance: Vec<f64> = problem.violation(&self.displacement).iter().map(|violation| -violation).collect();
        let on_row = |(row, distance): (usize, &f64)| if self.closed.contains(row) { penalty * distance } else { 0.0 };
        let pull: Vec<f64> = distance.iter().enumerate().map(on_row).collect();
        let (elastic, spring) = (problem.stiffness().mul(&self.displacement), problem.contact().mul_transposed(&pull));
        let force: Vec<f64> = (0..problem.dofs()).map(|dof| problem.load()[dof] - elastic[dof] + spring[dof]).collect();
        let change = factor.solve(&force);
        self.violation =
            problem.contact().mul(&change).iter().zip(&distance).map(|(moved, distance)| moved - distance).collect();
        self.displacement.iter_mut().zip(&change).for_each(|(u, v)| *u += v);
    }
}
