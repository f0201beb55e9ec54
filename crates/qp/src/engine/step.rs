//! The steps of an attempt on a scaled problem: each by one method, or by one that starts another.

use super::loading::Load;
use crate::error::Error;
use crate::method::interior_point::{self, InteriorPoint};
use crate::method::mprgp::Limits;
use crate::method::penalty::{self, AccuracyGoal, Penalty};
use crate::method::{Ending, Outcome, ScaledProblem, Start, active_set, dual_active_set};
use crate::plan::{PATIENCE, Step};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{ContactSet, Solution};

/// A step that an engine is to make.
pub(crate) struct Task<'a> {
    pub step: Step,
    /// The problem under some load, at some gaps.
    pub problem: &'a ContactProblem,
    pub load: &'a Load,
    pub start: &'a Start,
    pub limits: Limits,
    /// Accuracy, limits and a running clock, with the method of the attempt.
    pub settings: &'a Settings,
    /// The best answer of the steps before this one; `None` without one.
    pub best: Option<&'a Solution>,
}

/// The outcome of a step, by a method from a set if one is known; `None` if the step has no means here.
pub(super) fn outcome(
    step: Step,
    scaled: &ScaledProblem,
    (method, start): (Method, Option<ContactSet>),
    most_iterations: usize,
    goal: Option<AccuracyGoal>,
) -> Result<Option<Outcome>, Error> {
    match step {
        Step::Method => by_method(scaled, (method, start), most_iterations, goal).map(Some),
        Step::InteriorPoint => {
            let found = by_method(scaled, (Method::qp(), None), most_iterations, None)?;
            let variant = if found.is_settled() { "-interior-point" } else { found.variant };
            Ok(Some(Outcome { variant, ..found }))
        }
        Step::Continuation => continued(scaled, start, most_iterations).map(Some),
        Step::Dual => dual_active_set::solve(scaled),
        _ => Ok(None),
    }
}

fn by_method(
    scaled: &ScaledProblem,
    (method, start): (Method, Option<ContactSet>),
    most_iterations: usize,
    goal: Option<AccuracyGoal>,
) -> Result<Outcome, Error> {
    let Some(cold) = scaled.start()? else { return Ok(Outcome::at_rest(scaled.problem, Ending::Unheld)) };
    let by_sets = |start: ContactSet| active_set::solve(scaled, start, most_iterations.min(PATIENCE));
    match (method, start) {
        (Method::Qp(InteriorPoint { polish: true, .. }), Some(start)) => {
            let outcome = by_sets(start)?;
            Ok(Outcome { variant: if outcome.is_settled() { "-warm" } else { outcome.variant }, ..outcome })
        }
        (Method::Qp(InteriorPoint { polish, tolerance }), _) => {
            let found = interior_point::solve(scaled, tolerance)?;
            match polish {
                // The multipliers become those of a linear solve.
                true => Ok(Outcome { iterations: found.iterations, ..by_sets(found.contact_set)? }),
                false => Ok(found),
            }
        }
        (Method::Penalty(ladder), start) => {
            penalty::solve(scaled, ladder, start.unwrap_or(cold), most_iterations, goal)
        }
        (_, start) => by_sets(start.unwrap_or(cold)),
    }
}

/// The active-set loop, started again from the set that the penalty ladder reaches.
///
/// On fine meshes a contact zone that starts too wide shrinks by one row an iteration. A penalty that grows from the
/// stiffness to its best value reaches the zone in few iterations on every mesh. Along a chain of m rows the ladder
/// takes nearly `3 sqrt(m)` sets; one that takes more wanders, and ends where it is.
///
/// # Source
/// K. Ito and K. Kunisch, *Semi-smooth Newton methods for variational inequalities of the first kind*, ESAIM: M2AN 37
/// (2003) 41-62.
fn continued(scaled: &ScaledProblem, start: Option<ContactSet>, most_iterations: usize) -> Result<Outcome, Error> {
    let ladder = Penalty { penetration_threshold: 0.0, ..Penalty::default() };
    let start = start.unwrap_or_else(|| ContactSet::open(scaled.problem.rows()));
    let most_on_ladder = most_iterations.min(PATIENCE.max(3 * scaled.problem.rows().isqrt()));
    let approach = penalty::solve(scaled, ladder, start, most_on_ladder, None)?;
    if scaled.watch.is_over() {
        return Ok(Outcome { ending: Ending::Unsettled, variant: "-unsettled", ..approach });
    }
    let most_iterations = most_iterations.saturating_sub(approach.iterations).max(1);
    let second = active_set::solve(scaled, approach.contact_set.clone(), most_iterations)?;
    let variant = if second.is_settled() { "-continuation" } else { second.variant };
    Ok(Outcome { variant, ..second.after(approach) })
}
