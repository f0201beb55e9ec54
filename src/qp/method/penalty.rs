//! The penalty loop: `G = eps C (u - g)`, with eps ten times larger from rung to rung.
//!
//! ```text
//! for eps = eps0, 10 eps0, ...:
//!     repeat: solve (K + eps C) u = f + eps C g;  C <- heaviside(u - g)     until C repeats
//!     stop when norm(C (u - g)) < threshold
//! ```
//!
//! The relative error of the multiplier is k/(k + eps) and a rounding part that grows with eps. Both are equal near
//! eps = 1e8 k; there the ladder ends. The rounding part comes from forming u - g by cancellation, so each solve is
//! for the change against the last displacement, in which u - g is small.

use std::collections::HashSet;

use super::{Holding, Outcome, ScaledProblem};
use crate::error::Error;
use crate::qp::linear::{Cholesky, largest};
use crate::solution::{ContactSet, Iteration};

/// The penalty at which the two parts of the error meet: one over the square root of the machine precision.
pub const BEST_PENALTY: f64 = 1e8;

/// The ladder of penalties, in multiples of the local stiffness, and where it may end early.
#[derive(Clone, Copy)]
pub struct Ladder<'a> {
    /// First penalty.
    pub first: f64,
    /// Last penalty.
    pub last: f64,
    /// Penetration, relative to the largest displacement of a contact row, at which the ladder ends.
    pub threshold: f64,
    /// Are answers extrapolated to an infinite penalty, from two rungs with one set?
    pub extrapolate: bool,
    /// The relative energy error at which the ladder ends, if any.
    pub goal: Option<Goal<'a>>,
}

/// An accuracy, with the bound that is held against it.
#[derive(Clone, Copy)]
pub struct Goal<'a> {
    /// Relative error in the energy norm.
    pub accuracy: f64,
    /// The bound of an answer (displacement, multiplier).
    pub bound: &'a dyn Fn(&[f64], &[f64]) -> f64,
}

/// Factor from rung to rung.
const RUNG: f64 = 10.0;

/// A rung whose bound is above this share of the one before is the floor: more penalty only adds rounding.
const FLOOR: f64 = 0.5;

/// Solves on the last rung after the set has settled: in the second the shift is the displacement itself.
const FINAL_SOLVES: usize = 2;

/// Climbs the ladder from the set `start`.
///
/// # Errors
/// [`Error::Unbounded`] and [`Error::UnderHeld`] for a free motion that no row stops, [`Error::NotConvex`],
/// [`Error::Numerical`].
pub fn solve(
    scaled: &ScaledProblem,
    start: ContactSet,
    ladder: Ladder,
    max_iterations: usize,
) -> Result<Outcome, Error> {
    let problem = scaled.problem;
    let mut closed = start;
    let mut state =
        State { displacement: vec![0.0; problem.dofs()], violation: vec![f64::NEG_INFINITY; problem.rows()] };
    let mut history = Vec::new();
    let mut penalty = ladder.first;
    let mut settled;
    let mut stops = 0;
    let mut answer;
    let mut rung_before: Option<Rung> = None;
    let mut last_bound = f64::INFINITY;
    loop {
        let mut seen = HashSet::new();
        settled = false;
        while !settled
            && seen.insert(closed.clone())
            && history.len() + stops < max_iterations
            && (history.is_empty() || !scaled.watch().is_over())
        {
            scaled.watch().step("penalty loop", history.len() + 1);
            let cholesky = match scaled.hold(&closed, penalty)? {
                Holding::Held(cholesky) => cholesky,
                Holding::Free(motion) => match scaled.stopping_rows(&motion, &state.displacement, &closed) {
                    Some(stopped) => {
                        stops += 1;
                        closed = stopped;
                        continue;
                    }
                    None => return Err(motion.into_error()),
                },
            };
            history.push(Iteration { contact_set: closed.clone(), penalty });
            state.advance(scaled, &cholesky, &closed, penalty);
            let next = ContactSet::from_fn(problem.rows(), |row| state.violation[row] > 0.0);
            settled = next == closed;
            if settled {
                (0..FINAL_SOLVES).for_each(|_| state.advance(scaled, &cholesky, &closed, penalty));
            }
            closed = next;
        }
        let penetration = closed.iter().map(|row| state.violation[row]).fold(0.0, f64::max);
        let reach = largest(&problem.contact().mul(&state.displacement));
        let small = settled && penetration <= ladder.threshold * reach;
        let rung = Rung::new(&state, closed.clone(), penalty);
        answer = match (&rung_before, ladder.extrapolate && settled) {
            (Some(before), true) if before.closed == rung.closed => rung.extrapolated(before),
            (_, true) => rung.extrapolated(&rung_below(scaled, &rung)?),
            (_, false) => rung.clone(),
        };
        if let Some(goal) = ladder.goal.filter(|_| settled) {
            let bound = (goal.bound)(&answer.displacement, &answer.multiplier);
            if bound <= goal.accuracy || (bound > FLOOR * last_bound && bound.is_finite()) {
                break;
            }
            last_bound = bound;
        }
        rung_before = Some(rung);
        if small || scaled.watch().is_over() || penalty * RUNG > ladder.last || history.len() >= max_iterations {
            break;
        }
        penalty *= RUNG;
    }
    let (iterations, variant) = match (settled, ladder.extrapolate) {
        (false, _) => (history.len(), "-unsettled"),
        (true, false) => (history.len(), ""),
        (true, true) => (history.len(), "-extrapolated"),
    };
    let Rung { displacement, multiplier, .. } = answer;
    Ok(Outcome { displacement, multiplier, contact_set: closed, iterations, history, settled, variant })
}

/// The answer of one penalty.
#[derive(Clone)]
struct Rung {
    penalty: f64,
    closed: ContactSet,
    displacement: Vec<f64>,
    multiplier: Vec<f64>,
}

impl Rung {
    fn new(state: &State, closed: ContactSet, penalty: f64) -> Self {
        let force = |(row, violation): (usize, &f64)| {
            if closed.contains(row) { -penalty * violation.max(0.0) } else { 0.0 }
        };
        let multiplier = state.violation.iter().enumerate().map(force).collect();
        Rung { penalty, displacement: state.displacement.clone(), multiplier, closed }
    }

    /// Richardson's extrapolation to an infinite penalty: the error of either answer is one over its penalty, to the
    /// first order.
    fn extrapolated(&self, before: &Rung) -> Rung {
        let share = before.penalty / (self.penalty - before.penalty);
        let beyond = |now: &[f64], before: &[f64]| -> Vec<f64> {
            now.iter().zip(before).map(|(now, before)| now + share * (now - before)).collect()
        };
        let multiplier = beyond(&self.multiplier, &before.multiplier);
        Rung {
            displacement: beyond(&self.displacement, &before.displacement),
            multiplier: multiplier.into_iter().map(|value| value.min(0.0)).collect(),
            ..self.clone()
        }
    }
}

/// The answer with the same set and a tenth of the penalty.
fn rung_below(scaled: &ScaledProblem, rung: &Rung) -> Result<Rung, Error> {
    let penalty = rung.penalty / RUNG;
    let mut state = State { displacement: rung.displacement.clone(), violation: Vec::new() };
    match scaled.hold(&rung.closed, penalty)? {
        Holding::Held(cholesky) => {
            (0..=FINAL_SOLVES).for_each(|_| state.advance(scaled, &cholesky, &rung.closed, penalty));
            Ok(Rung::new(&state, rung.closed.clone(), penalty))
        }
        Holding::Free(motion) => Err(motion.into_error()),
    }
}

/// A displacement with the violation B u - g of each row, kept to the relative precision of the change that made it.
struct State {
    displacement: Vec<f64>,
    violation: Vec<f64>,
}

impl State {
    /// Solves (K + eps B_C'B_C) v = (f - K u) + eps B_C'(g - B u) and moves u to u + v.
    fn advance(&mut self, scaled: &ScaledProblem, cholesky: &Cholesky, closed: &ContactSet, penalty: f64) {
        let problem = scaled.problem;
        let distance: Vec<f64> = problem.violation(&self.displacement).iter().map(|violation| -violation).collect();
        let pull: Vec<f64> = distance
            .iter()
            .enumerate()
            .map(|(row, &distance)| if closed.contains(row) { penalty * distance } else { 0.0 })
            .collect();
        let (elastic, spring) = (problem.stiffness().mul(&self.displacement), problem.contact().mul_transposed(&pull));
        let force: Vec<f64> = (0..problem.dofs()).map(|dof| problem.load()[dof] - elastic[dof] + spring[dof]).collect();
        let change = cholesky.solve(&force);
        self.violation =
            problem.contact().mul(&change).iter().zip(&distance).map(|(moved, distance)| moved - distance).collect();
        self.displacement.iter_mut().zip(&change).for_each(|(u, v)| *u += v);
    }
}
