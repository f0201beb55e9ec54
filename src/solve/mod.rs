//! From a contact problem to a certified answer: select rows, scale, condense, method, expand, certify.

mod boundary;
mod estimate;
mod iterative;
mod loading;
mod path;
mod preparation;
mod prepared;
mod refinement;
mod rules;
mod settings;
mod stepping;

pub use crate::method::mprgp::Start;
pub use crate::method::parametric::{Event, Piece};
pub use boundary::BoundarySolution;
pub use estimate::Estimate;
pub use iterative::Iterative;
pub use path::Path;
pub use prepared::Prepared;
pub use settings::{Condense, Method, Precision, Settings};

use crate::error::Error;
use crate::method::interior_point::{self, InteriorPoint};
use crate::method::penalty::{self, BEST_PENALTY, Ladder};
use crate::method::{Outcome, ScaledProblem, active_set, dual_active_set};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration, Solution};
use estimate::Choice;

/// Iterations of the active-set loop after which its start is taken for a poor one.
const PATIENCE: usize = 16;

/// Solves a contact problem as a QP by the interior-point method, polished, certified to 1e-9.
///
/// # Errors
/// As [`solve`].
pub fn solve_qp(problem: &ContactProblem) -> Result<Solution, Error> {
    solve(problem, &Settings::with_method(Method::Qp))
}

/// Solves a contact problem; `Ok` means that the answer is certified to `settings.tolerance`.
///
/// # Errors
/// * [`Error::Setting`] for a setting outside its range,
/// * [`Error::Infeasible`] for contact rows that contradict each other,
/// * [`Error::Unbounded`] for a load that drives a motion which nothing stops,
/// * [`Error::UnderHeld`] for a motion that nothing resists: the answer would not be unique,
/// * [`Error::NotConvex`] for a stiffness with a negative eigenvalue,
/// * [`Error::NotCertified`] with the best answer, where it does not meet the tolerance,
/// * [`Error::NoRoom`] where `settings.memory` suffices for no way, [`Error::TooLarge`] where not for the one that was named,
/// * [`Error::Interrupted`] where the watch was asked to stop before there was an answer,
/// * [`Error::Numerical`] where memory does not suffice.
pub fn solve(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    let settings = &settings.started()?;
    if settings.method == Method::Mprgp {
        return iterative::solve(problem, settings);
    }
    let chooses = settings.method == Method::Auto;
    let estimate = Estimate::of(problem);
    match if chooses { estimate.choose(settings.memory.unwrap_or(f64::INFINITY))? } else { Choice::Factor } {
        Choice::Factor => {}
        Choice::Room { reason } => return by_multigrid(problem, settings, reason),
        // What the iteration cannot take, the direct path may, unless there is no time for it.
        Choice::Speed { reason } => match by_multigrid(problem, settings, reason) {
            Err(Error::NotCertified { .. }) if settings.watch.time_left().is_none() && !settings.watch.is_stopped() => {
            }
            Err(Error::Numerical { .. } | Error::NotConvex { .. }) if !settings.watch.is_stopped() => {}
            decided => return decided,
        },
    }
    let prepared = match Prepared::with_settings(problem, settings) {
        Err(Error::OutOfTime { needed, time }) => return Err(nothing_found(problem, needed, time)?),
        Err(Error::TooLarge { bytes, allowed, .. }) if chooses => {
            return by_multigrid(problem, settings, estimate.without_factor(bytes, allowed)?);
        }
        prepared => prepared?,
    };
    let preparation = prepared.seconds();
    let with_preparation = |mut solution: Solution| {
        solution.seconds.factor += preparation.factor;
        solution.seconds.solve += preparation.solve;
        solution
    };
    let fell_short = match prepared.solve(settings) {
        Ok(solution) => return Ok(with_preparation(solution)),
        Err(Error::NotCertified { solution, condition, value, tolerance }) => {
            let solution = Box::new(with_preparation(*solution));
            Error::NotCertified { solution, condition, value, tolerance }
        }
        Err(error @ Error::Numerical { .. }) => error,
        Err(error) => return Err(error),
    };
    if !prepared.is_a_shortcut() || settings.watch.is_over() {
        return Err(fell_short);
    }
    drop(prepared);
    // The time that the shortcut took is part of the answer's.
    let method = if settings.method == Method::Auto { Method::ActiveSet } else { settings.method };
    let safe = Settings { method, precision: Precision::Double, ..settings.clone() };
    let bound = |error: &Error| match error {
        Error::NotCertified { solution, .. } => solution.certificate.energy_error_bound,
        _ => f64::INFINITY,
    };
    match solve(problem, &safe) {
        // Where it is cut short, the shortcut may have come further.
        Err(error @ (Error::NotCertified { .. } | Error::Interrupted)) if bound(&fell_short) < bound(&error) => {
            Err(fell_short)
        }
        solved => solved.map(with_preparation),
    }
}

/// The answer without a factor, and why there is none.
///
/// # Errors
/// As [`Iterative::solve_gap`].
fn by_multigrid(problem: &ContactProblem, settings: &Settings, reason: String) -> Result<Solution, Error> {
    let reason = Some(reason);
    match iterative::solve(problem, settings) {
        Err(Error::NotCertified { solution, condition, value, tolerance }) => {
            let solution = Box::new(Solution { reason, ..*solution });
            Err(Error::NotCertified { solution, condition, value, tolerance })
        }
        found => found.map(|solution| Solution { reason, ..solution }),
    }
}

/// The answer before anything is found: no displacement and no force, and how far that is off.
///
/// # Errors
/// Those of the certificate.
fn nothing_found(problem: &ContactProblem, needed: f64, time: f64) -> Result<Error, Error> {
    let (displacement, multiplier) = (vec![0.0; problem.dofs()], vec![0.0; problem.rows()]);
    let certificate = problem.certify_in(None, &displacement, &multiplier)?;
    let solution = Solution {
        displacement,
        multiplier,
        contact_set: ContactSet::open(problem.rows()),
        method: "none".to_string(),
        iterations: 0,
        history: Vec::new(),
        certificate,
        proven: None,
        refinements: None,
        reason: None,
        condensed_dofs: problem.dofs(),
        seconds: Default::default(),
    };
    let condition = "the time of one factorisation (s)";
    Ok(Error::NotCertified { solution: Box::new(solution), condition, value: needed, tolerance: time })
}

/// Displacement and multiplier of the body with the rows of `closed` held at their gaps and all others free: one
/// iteration of the active-set loop. The multiplier has either sign.
///
/// # Errors
/// As [`solve`], without [`Error::NotCertified`]; [`Error::Infeasible`] where the rows of the set contradict each other.
pub fn with_contact_set(problem: &ContactProblem, closed: &ContactSet) -> Result<(Vec<f64>, Vec<f64>), Error> {
    Prepared::new(problem, Condense::Auto)?.with_contact_set(closed)
}

/// Runs the method of `settings`, and the last resort where that does not settle; the active-set steps start from `start`
/// where it is given.
///
/// `bound` is that of the energy error of an answer to the scaled problem.
fn run(
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
fn last_resort(scaled: &ScaledProblem, before: Outcome) -> Result<Outcome, Error> {
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
