//! Runs a method on a scaled problem, and the last resort where that does not settle.

use super::settings::{Method, Settings};
use crate::error::Error;
use crate::qp::method::interior_point::{self, InteriorPoint};
use crate::qp::method::penalty::{self, BEST_PENALTY, Ladder};
use crate::qp::method::{Outcome, ScaledProblem, active_set, dual_active_set};
use crate::solution::{ContactSet, Iteration};

/// Iterations of the active-set loop after which its start is taken for a poor one.
const PATIENCE: usize = 16;

/// Runs the method of `settings`, and the last resort where that does not settle; the active-set steps start from `start`
/// where it is given.
///
/// `bound` is that of the energy error of an answer to the scaled problem.
pub(super) fn run(
    scaled: &ScaledProblem,
    start: Option<ContactSet>,
    settings: &Settings,
    bound: &dyn Fn(&[f64], &[f64]) -> f64,
) -> Result<Outcome, Error> {
    let found = run_method(scaled, start, settings, bound).and_then(|outcome| {
        let is_final = outcome.settled || !settings.allows_last_resort(f64::INFINITY);
        if is_final { Ok(outcome) } else { last_resort(scaled, outcome) }
    });
    let unique = |outcome: Outcome| scaled.check_unique(&outcome).map(|()| outcome);
    match found.and_then(unique) {
        Err(claim @ (Error::Unbounded { .. } | Error::UnderHeld { .. })) if !scaled.is_evident(&claim) => {
            // Only of rows that can be met together, and where there is no balance, which rounding may hide.
            match dual_active_set::solve(scaled)? {
                Some(balance) if balance.settled || !scaled.is_true(&claim) => unique(balance),
                _ => Err(claim),
            }
        }
        found => found,
    }
}

/// The outcome of the method of `settings` as it stands.
fn run_method(
    scaled: &ScaledProblem,
    start: Option<ContactSet>,
    settings: &Settings,
    bound: &dyn Fn(&[f64], &[f64]) -> f64,
) -> Result<Outcome, Error> {
    let cold = scaled.start()?;
    Ok(match settings.method {
        Method::Qp if settings.polish && start.is_some() => {
            let outcome = settle(scaled, start.unwrap_or(cold), settings)?;
            Outcome { variant: if outcome.settled { "-warm" } else { outcome.variant }, ..outcome }
        }
        Method::Qp => {
            let found = match scaled.problem.rows() {
                0 => InteriorPoint::nothing_found(scaled.problem),
                _ => interior_point::solve(scaled, settings.interior_point_tolerance)?,
            };
            if settings.polish { polish(scaled, found, settings)? } else { unpolished(found) }
        }
        Method::Auto | Method::ActiveSet => settle(scaled, start.unwrap_or(cold), settings)?,
        Method::Penalty => {
            let ladder = Ladder {
                first: settings.first_penalty,
                last: settings.last_penalty,
                threshold: settings.penetration_threshold,
                extrapolate: settings.extrapolate,
                goal: settings.accuracy.map(|accuracy| penalty::Goal { accuracy, bound }),
            };
            penalty::solve(scaled, start.unwrap_or(cold), ladder, settings.max_iterations)?
        }
        Method::Mprgp => {
            let reason = "its hierarchy stands in `Iterative`, which is prepared without a factorisation".to_string();
            return Err(Error::Numerical { step: "MPRGP on a factorised problem", reason });
        }
    })
}

/// What the dual active-set method finds where another fell short; what that left where it finds nothing.
///
/// # Errors
/// Those of [`dual_active_set::solve`].
pub(super) fn last_resort(scaled: &ScaledProblem, before: Outcome) -> Result<Outcome, Error> {
    if before.is_last_resort() || scaled.watch().is_over() {
        return Ok(before);
    }
    Ok(match dual_active_set::solve(scaled)? {
        Some(found) => found.after(before),
        None => before,
    })
}

/// The active-set loop; should it take long, it is started again from the set that the penalty ladder arrives at.
///
/// On fine meshes a contact zone that starts too wide shrinks by one row an iteration. A penalty that grows from the
/// stiffness to its best value gets there in few iterations whatever the mesh.
///
/// # Source
/// K. Ito and K. Kunisch, *Semi-smooth Newton methods for variational inequalities of the first kind*, ESAIM: M2AN 37
/// (2003) 41-62.
fn settle(scaled: &ScaledProblem, start: ContactSet, settings: &Settings) -> Result<Outcome, Error> {
    let first = active_set::solve(scaled, start, settings.max_iterations.min(PATIENCE))?;
    if first.settled || settings.max_iterations <= PATIENCE || scaled.watch().is_over() {
        return Ok(first);
    }
    let ladder = Ladder { first: 1.0, last: BEST_PENALTY, threshold: 0.0, extrapolate: false, goal: None };
    let approach = penalty::solve(scaled, first.contact_set, ladder, settings.max_iterations)?;
    if scaled.watch().is_over() {
        return Ok(Outcome { settled: false, variant: "-unsettled", ..approach });
    }
    let mut second = active_set::solve(scaled, approach.contact_set, settings.max_iterations)?;
    second.history = [first.history, approach.history, second.history].concat();
    second.iterations = second.history.len();
    second.variant = if second.settled { "-continuation" } else { second.variant };
    Ok(second)
}

/// The active-set loop started from the set of the QP: the multipliers become those of a linear solve.
fn polish(scaled: &ScaledProblem, found: InteriorPoint, settings: &Settings) -> Result<Outcome, Error> {
    let iterations = found.iterations;
    let polished = settle(scaled, found.contact_set, settings)?;
    Ok(Outcome { iterations, ..polished })
}

fn unpolished(found: InteriorPoint) -> Outcome {
    let step = Iteration { contact_set: found.contact_set.clone(), penalty: 0.0 };
    Outcome {
        displacement: found.displacement,
        multiplier: found.multiplier,
        contact_set: found.contact_set,
        iterations: found.iterations,
        history: vec![step],
        settled: true,
        variant: "-unpolished",
    }
}
