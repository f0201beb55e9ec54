//! From a contact problem to a certified answer: select rows, scale, method, expand, certify.

mod settings;

use std::time::Instant;

pub use settings::{Method, Settings};

use crate::error::Error;
use crate::method::interior_point::{self, InteriorPoint};
use crate::method::penalty::{self, BEST_PENALTY, Ladder};
use crate::method::{Outcome, ScaledProblem, active_set};
use crate::problem::{ContactProblem, EnergyNorm};
use crate::solution::{ContactSet, Iteration, Seconds, Solution};
use crate::transform::{RowSelection, Scaling};

/// Iterations of the active-set loop after which its start is taken for a poor one.
const PATIENCE: usize = 100;

/// Solves a contact problem by the QP method, polished, certified to 1e-9.
///
/// # Errors
/// As [`solve`].
pub fn solve_qp(problem: &ContactProblem) -> Result<Solution, Error> {
    solve(problem, &Settings::default())
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
/// * [`Error::Numerical`] where memory does not suffice.
pub fn solve(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    settings.check()?;
    let clock = Instant::now();
    let selection = RowSelection::of(problem)?;
    let norm = EnergyNorm::of(problem.stiffness())?;
    let mut factor_seconds = clock.elapsed().as_secs_f64();

    let reference = reference_displacement(selection.problem(), norm.as_ref());
    let scaling = Scaling::of(selection.problem(), reference)?;
    let scaled = ScaledProblem::new(scaling.problem(), norm.is_some())?;
    let outcome = run(&scaled, settings).map_err(|error| expand_error(error, &selection, &scaling))?;
    factor_seconds += scaled.factor_seconds();

    let displacement = scaling.expand_displacement(&outcome.displacement);
    let multiplier = selection.expand_multiplier(&scaling.expand_multiplier(&outcome.multiplier));
    let certificate = problem.certify_in(norm.as_ref(), &displacement, &multiplier)?;
    let expand_iteration =
        |step: Iteration| Iteration { contact_set: selection.expand_set(&step.contact_set), penalty: step.penalty };
    let solution = Solution {
        displacement,
        multiplier,
        contact_set: selection.expand_set(&outcome.contact_set),
        method: format!("{}{}", settings.method.name(), outcome.variant),
        iterations: outcome.iterations,
        history: outcome.history.into_iter().map(expand_iteration).collect(),
        certificate,
        seconds: Seconds { factor: factor_seconds, solve: clock.elapsed().as_secs_f64() },
    };
    if solution.certificate.meets(settings.tolerance) {
        return Ok(solution);
    }
    interior_point::check_feasible(&scaled, settings.interior_point_tolerance)
        .map_err(|error| expand_error(error, &selection, &scaling))?;
    let (condition, value) = solution.certificate.worst();
    Err(Error::NotCertified { solution: Box::new(solution), condition, value, tolerance: settings.tolerance })
}

/// Displacement and multiplier of the body with the rows of `closed` held at their gaps and all others free: one
/// iteration of the active-set loop. The multiplier has either sign.
///
/// # Errors
/// As [`solve`], without [`Error::NotCertified`]; [`Error::Infeasible`] where the rows of the set contradict each other.
pub fn with_contact_set(problem: &ContactProblem, closed: &ContactSet) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let selection = RowSelection::of(problem)?;
    let norm = EnergyNorm::of(problem.stiffness())?;
    let scaling = Scaling::of(selection.problem(), reference_displacement(selection.problem(), norm.as_ref()))?;
    let scaled = ScaledProblem::new(scaling.problem(), norm.is_some())?;
    let held = active_set::with_contact_set(&scaled, &selection.restrict_set(closed))
        .map_err(|error| expand_error(error, &selection, &scaling))?;
    let displacement = scaling.expand_displacement(&held.displacement);
    Ok((displacement, selection.expand_multiplier(&scaling.expand_multiplier(&held.multiplier))))
}

fn run(scaled: &ScaledProblem, settings: &Settings) -> Result<Outcome, Error> {
    let start = scaled.start()?;
    let outcome = match settings.method {
        Method::Auto | Method::Qp => {
            let found = match scaled.problem.rows() {
                0 => InteriorPoint::nothing_found(scaled.problem),
                _ => interior_point::solve(scaled, settings.interior_point_tolerance)?,
            };
            if settings.polish { polish(scaled, found, settings)? } else { unpolished(found) }
        }
        Method::ActiveSet => settle(scaled, start, settings)?,
        Method::Penalty => {
            let ladder = Ladder {
                first: settings.first_penalty,
                last: settings.last_penalty,
                threshold: settings.penetration_threshold,
            };
            penalty::solve(scaled, start, ladder, settings.max_iterations)?
        }
    };
    scaled.check_unique(&outcome)?;
    Ok(outcome)
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
    if first.settled || settings.max_iterations <= PATIENCE {
        return Ok(first);
    }
    let ladder = Ladder { first: 1.0, last: BEST_PENALTY, threshold: 0.0 };
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

/// The size that displacements are expected to have.
///
/// What the load alone does, or what the obstacle enforces, bounds it where the stiffness is definite; the gaps and the
/// load over the stiffness bound it where a soft support would let the free body run away.
fn reference_displacement(problem: &ContactProblem, norm: Option<&EnergyNorm>) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let stiffness = largest(&mut problem.stiffness().diagonal().into_iter());
    let load = largest(&mut problem.load().iter().map(|f| f.abs()));
    let static_reach = if stiffness > 0.0 { load / stiffness } else { 0.0 };
    let local = largest(&mut problem.gap().iter().map(|g| g.abs())).max(static_reach);
    let Some(norm) = norm else { return local };
    let free = norm.free_displacement(problem.load());
    let enforced = largest(&mut problem.gap().iter().map(|g| -g));
    let reach = largest(&mut free.iter().map(|u| u.abs())).max(enforced);
    if local > 0.0 { local.min(reach) } else { reach }
}

/// Rows and directions of an error in the terms of the original problem.
fn expand_error(error: Error, selection: &RowSelection, scaling: &Scaling) -> Error {
    let normalised = |direction: Vec<f64>| {
        let mut direction = scaling.expand_displacement(&direction);
        let size = direction.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        direction.iter_mut().for_each(|value| *value /= size);
        direction
    };
    match error {
        Error::Unbounded { motion, direction } => Error::Unbounded { motion, direction: normalised(direction) },
        Error::UnderHeld { motion, direction } => Error::UnderHeld { motion, direction: normalised(direction) },
        Error::Infeasible { rows, .. } => {
            let rows: Vec<usize> = rows.into_iter().map(|row| selection.kept()[row]).collect();
            let reason = format!("no displacement satisfies the contact rows {rows:?} together (indices from 0)");
            Error::Infeasible { reason, rows }
        }
        other => other,
    }
}
