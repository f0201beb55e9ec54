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

use super::{Ending, Outcome, ScaledProblem, Solver, Start};
use crate::error::Error;
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

/// An accuracy, with the bound that must meet it.
#[derive(Clone, Copy)]
pub struct AccuracyGoal<'a> {
    /// Relative error in the energy norm.
    pub accuracy: f64,
    /// The bound of an answer (displacement, multiplier).
    pub bound: &'a dyn Fn(&[f64], &[f64]) -> f64,
}

/// The penalty loop on a scaled problem.
#[derive(Clone, Copy)]
pub struct PenaltyLoop<'a> {
    /// The scaled problem with penalties on its rows.
    pub scaled: &'a ScaledProblem<'a>,
    pub ladder: Penalty,
    /// The relative energy error at which the ladder ends, if any.
    pub goal: Option<AccuracyGoal<'a>>,
    /// Largest number of factorisations on all rungs together.
    pub most_iterations: usize,
}

/// Factor from rung to rung.
const RUNG: f64 = 10.0;

/// A rung with a bound above this share of the previous one is the floor: more penalty only adds rounding.
const FLOOR: f64 = 0.5;

/// Solves on the last rung after the set has settled: in the second the shift is the displacement itself.
const FINAL_SOLVES: usize = 2;

impl Solver for PenaltyLoop<'_> {
    /// Climbs the ladder from the contact set of `start`.
    fn solve(&self, start: Start) -> Result<Outcome, Error> {
        let PenaltyLoop { scaled, ladder, .. } = self;
        let mut climb = Climb::new(scaled.problem, start);
        let mut penalty = ladder.first;
        let mut last_bound = f64::INFINITY;
        let multiplier = loop {
            self.settle(&mut climb, penalty)?;
            let multiplier = climb.multiplier(penalty);
            if let Some(goal) = self.goal.filter(|_| climb.is_settled()) {
                let bound = (goal.bound)(&climb.state.displacement, &multiplier);
                if bound <= goal.accuracy || (bound > FLOOR * last_bound && bound.is_finite()) {
                    break multiplier;
                }
                last_bound = bound;
            }
            let is_small = climb.is_settled() && climb.penetrates_at_most(scaled.problem, ladder.penetration_threshold);
            let is_last = penalty * RUNG > ladder.last || climb.history.len() >= self.most_iterations;
            if is_small || scaled.watch().is_over() || is_last || climb.ending == Ending::Unheld {
                break multiplier;
            }
            penalty *= RUNG;
        };
        let variant = if climb.is_settled() { "" } else { "-unsettled" };
        let Climb { closed: contact_set, state: State { displacement, .. }, history, ending } = climb;
        Ok(Outcome { displacement, multiplier, contact_set, iterations: history.len(), history, ending, variant })
    }
}

impl PenaltyLoop<'_> {
    /// One rung: exchanges the rows of the set until it returns, or until the loop must end.
    fn settle(&self, climb: &mut Climb, penalty: f64) -> Result<(), Error> {
        let scaled = self.scaled;
        let mut seen = HashSet::new();
        climb.ending = Ending::Unsettled;
        while climb.ending == Ending::Unsettled
            && seen.insert(climb.closed.clone())
            && climb.history.len() < self.most_iterations
            && (climb.history.is_empty() || !scaled.watch().is_over())
        {
            scaled.watch().step("penalty loop", climb.history.len() + 1);
            let cholesky = match scaled.hold_with_more(&mut climb.closed, penalty, &climb.state.displacement)? {
                Ok(cholesky) => cholesky,
                Err(ending) => {
                    climb.ending = ending;
                    break;
                }
            };
            climb.history.push(Iteration { contact_set: climb.closed.clone(), penalty });
            let springs = PenaltySprings { factor: &cholesky, closed: &climb.closed, penalty };
            climb.state.advance(scaled.problem, &springs);
            let next = ContactSet::from_fn(scaled.problem.rows(), |row| climb.state.violation[row] > 0.0);
            climb.ending = Ending::of(next == climb.closed);
            if climb.is_settled() {
                (0..FINAL_SOLVES).for_each(|_| climb.state.advance(scaled.problem, &springs));
            }
            climb.closed = next;
        }
        Ok(())
    }
}

/// The state of the loop between two rungs.
struct Climb {
    closed: ContactSet,
    state: State,
    history: Vec<Iteration>,
    /// Settled if the last rung ended with the set that it began with.
    ending: Ending,
}

impl Climb {
    fn new(problem: &ContactProblem, start: Start) -> Self {
        let state =
            State { displacement: vec![0.0; problem.dofs()], violation: vec![f64::NEG_INFINITY; problem.rows()] };
        Climb { closed: start.into_set(problem.rows()), state, history: Vec::new(), ending: Ending::Unsettled }
    }

    fn is_settled(&self) -> bool {
        self.ending == Ending::Settled
    }

    /// The forces of the closed rows as springs of this penalty.
    fn multiplier(&self, penalty: f64) -> Vec<f64> {
        let force = |(row, violation): (usize, &f64)| {
            if self.closed.contains(row) { -penalty * violation.max(0.0) } else { 0.0 }
        };
        self.state.violation.iter().enumerate().map(force).collect()
    }

    /// Returns `true` if no closed row penetrates by more than this share of the largest displacement of a row.
    fn penetrates_at_most(&self, problem: &ContactProblem, share: f64) -> bool {
        let penetration = self.closed.iter().map(|row| self.state.violation[row]).fold(0.0, f64::max);
        penetration <= share * largest(&problem.contact().mul(&self.state.displacement))
    }
}

/// Closed rows as springs of one penalty eps.
struct PenaltySprings<'a> {
    /// K + eps B_C'B_C.
    factor: &'a Cholesky,
    closed: &'a ContactSet,
    penalty: f64,
}

/// A displacement with the violation B u - g of each row, kept to the relative precision of the change that made it.
struct State {
    displacement: Vec<f64>,
    violation: Vec<f64>,
}

impl State {
    /// Solves (K + eps B_C'B_C) v = (f - K u) + eps B_C'(g - B u) and moves u to u + v.
    fn advance(&mut self, problem: &ContactProblem, springs: &PenaltySprings) {
        let distance: Vec<f64> = problem.violation(&self.displacement).iter().map(|violation| -violation).collect();
        let pull: Vec<f64> = distance
            .iter()
            .enumerate()
            .map(|(row, &distance)| if springs.closed.contains(row) { springs.penalty * distance } else { 0.0 })
            .collect();
        let (elastic, spring) = (problem.stiffness().mul(&self.displacement), problem.contact().mul_transposed(&pull));
        let force: Vec<f64> = (0..problem.dofs()).map(|dof| problem.load()[dof] - elastic[dof] + spring[dof]).collect();
        let change = springs.factor.solve(&force);
        self.violation =
            problem.contact().mul(&change).iter().zip(&distance).map(|(moved, distance)| moved - distance).collect();
        self.displacement.iter_mut().zip(&change).for_each(|(u, v)| *u += v);
    }
}
