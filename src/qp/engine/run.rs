//! Runs a method on a scaled problem, and the last resort if that does not settle.

use crate::error::Error;
use crate::qp::method::active_set::ActiveSet;
use crate::qp::method::dual_active_set::DualActiveSet;
use crate::qp::method::interior_point::{Barrier, InteriorPoint};
use crate::qp::method::penalty::{self, Penalty, PenaltyLoop};
use crate::qp::method::{Outcome, ScaledProblem, Solver, Start};
use crate::qp::plan::{PATIENCE, takes_last_resort};
use crate::qp::settings::{Method, Settings};
use crate::solution::ContactSet;

/// Runs the method of `settings`, and the last resort if that does not settle; the active-set steps start from `start` if it is
/// given.
///
/// `bound` is that of the energy error of an answer to the scaled problem.
pub(super) fn run(
    scaled: &ScaledProblem,
    start: Option<ContactSet>,
    settings: &Settings,
    bound: &dyn Fn(&[f64], &[f64]) -> f64,
) -> Result<Outcome, Error> {
    let found = run_method(scaled, start, settings, bound).and_then(|outcome| {
        if !outcome.settled && takes_last_resort(settings) { last_resort(scaled, outcome) } else { Ok(outcome) }
    });
    let unique = |outcome: Outcome| scaled.check_unique(&outcome).map(|()| outcome);
    match found.and_then(unique) {
        Err(claim @ (Error::Unbounded { .. } | Error::UnderHeld { .. })) if !scaled.is_evident(&claim) => {
            // The claim holds only if the rows can be met together and there is no balance; rounding may hide a balance.
            let balance = DualActiveSet::of(scaled)?.map(|method| method.solve(Start::default())).transpose()?;
            match balance {
                Some(balance) if balance.settled || !scaled.is_true(&claim) => unique(balance),
                _ => Err(claim),
            }
        }
        found => found,
    }
}

/// The outcome of the method of `settings` without the last resort.
fn run_method(
    scaled: &ScaledProblem,
    start: Option<ContactSet>,
    settings: &Settings,
    bound: &dyn Fn(&[f64], &[f64]) -> f64,
) -> Result<Outcome, Error> {
    let cold = scaled.start()?;
    match settings.method {
        Method::Qp(InteriorPoint { polish: true, tolerance }) => match start {
            Some(start) => {
                let outcome = settle(scaled, start, settings)?;
                Ok(Outcome { variant: if outcome.settled { "-warm" } else { outcome.variant }, ..outcome })
            }
            None => {
                let found = Barrier { scaled, tolerance }.solve(Start::default())?;
                // The multipliers become those of a linear solve.
                let polished = settle(scaled, found.contact_set, settings)?;
                Ok(Outcome { iterations: found.iterations, ..polished })
            }
        },
        Method::Qp(InteriorPoint { polish: false, tolerance }) => Barrier { scaled, tolerance }.solve(Start::default()),
        Method::Penalty(ladder) => {
            let goal = settings.accuracy.map(|accuracy| penalty::Goal { accuracy, bound });
            let climb = PenaltyLoop { scaled, ladder, goal, most_iterations: settings.max_iterations };
            climb.solve(start.unwrap_or(cold).into())
        }
        Method::Auto | Method::ActiveSet | Method::Mprgp => settle(scaled, start.unwrap_or(cold), settings),
    }
}

/// The outcome of the dual active-set method after another method fell short; the earlier outcome if it finds nothing.
///
/// # Errors
/// Those of [`DualActiveSet`].
pub(super) fn last_resort(scaled: &ScaledProblem, before: Outcome) -> Result<Outcome, Error> {
    if before.is_last_resort() || scaled.watch().is_over() {
        return Ok(before);
    }
    Ok(match DualActiveSet::of(scaled)? {
        Some(method) => method.solve(Start::default())?.after(before),
        None => before,
    })
}

/// The active-set loop; if it takes long, it is started again from the set that the penalty ladder reaches.
///
/// On fine meshes a contact zone that starts too wide shrinks by one row an iteration. A penalty that grows from the stiffness
/// to its best value reaches the zone in few iterations on every mesh.
///
/// # Source
/// K. Ito and K. Kunisch, *Semi-smooth Newton methods for variational inequalities of the first kind*, ESAIM: M2AN 37
/// (2003) 41-62.
fn settle(scaled: &ScaledProblem, start: ContactSet, settings: &Settings) -> Result<Outcome, Error> {
    let most_iterations = settings.max_iterations;
    let first = ActiveSet { scaled, most_iterations: most_iterations.min(PATIENCE) }.solve(start.into())?;
    if first.settled || most_iterations <= PATIENCE || scaled.watch().is_over() {
        return Ok(first);
    }
    let ladder = Penalty { penetration_threshold: 0.0, ..Penalty::default() };
    let approach = PenaltyLoop { scaled, ladder, goal: None, most_iterations }.solve(first.contact_set.into())?;
    if scaled.watch().is_over() {
        return Ok(Outcome { settled: false, variant: "-unsettled", ..approach });
    }
    let mut second = ActiveSet { scaled, most_iterations }.solve(approach.contact_set.into())?;
    second.history = [first.history, approach.history, second.history].concat();
    second.iterations = second.history.len();
    second.variant = if second.settled { "-continuation" } else { second.variant };
    Ok(second)
}
