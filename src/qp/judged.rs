//! The verdict: an answer that meets its goal, or the best answer inside an error that states what falls short.

use super::problem::ContactProblem;
use crate::error::Error;
use crate::qp::linear::NullSpace;
use crate::qp::method::Outcome;
use crate::qp::settings::Settings;
use crate::solution::{Certificate, ContactSet, Goal, Seconds, Solution};

/// The outcome of the method called `name` as a solution, with its certificate and nothing else.
pub(super) fn answer(outcome: Outcome, name: &str, certificate: Certificate) -> Solution {
    let Outcome { displacement, multiplier, contact_set, iterations, history, variant, .. } = outcome;
    Solution {
        condensed_dofs: displacement.len(),
        displacement,
        multiplier,
        contact_set,
        method: format!("{name}{variant}"),
        iterations,
        history,
        certificate,
        proven: None,
        cut_short: None,
        refinements: None,
        lost_pivot: None,
        reason: None,
        why: None,
        attempts: Vec::new(),
        seconds: Seconds::default(),
    }
}

/// The solution if its certificate meets the goal.
///
/// # Errors
/// [`Error::NotCertified`] with the solution, and the condition that decides.
pub(super) fn judged(solution: Solution, goal: Goal) -> Result<Solution, Error> {
    let solution = Solution { certificate: solution.certificate.judged(goal), ..solution };
    if goal.is_met_by(&solution.certificate) {
        return Ok(solution);
    }
    Err(fallen_short(solution, goal))
}

/// The error of a solution that is not certified, with the condition that decides.
pub(super) fn fallen_short(solution: Solution, goal: Goal) -> Error {
    let (condition, value, tolerance) = solution.certificate.decisive(goal.required());
    Error::NotCertified { solution: Box::new(solution), condition, value, tolerance }
}

/// The same ending with `change` applied to its solution, also to one that falls short.
pub(super) fn with_solution(
    ending: Result<Solution, Error>,
    change: impl FnOnce(Solution) -> Solution,
) -> Result<Solution, Error> {
    match ending {
        Ok(solution) => Ok(change(solution)),
        Err(Error::NotCertified { solution, condition, value, tolerance }) => {
            Err(Error::NotCertified { solution: Box::new(change(*solution)), condition, value, tolerance })
        }
        Err(error) => Err(error),
    }
}

/// The ending of a solve under `settings`: if it is not certified, with what the limit of time cut short.
///
/// # Errors
/// Those of the ending; without time for a first factorisation [`Error::NotCertified`] with the body at rest.
pub(super) fn in_time(
    problem: &ContactProblem,
    settings: &Settings,
    ending: Result<Solution, Error>,
) -> Result<Solution, Error> {
    match ending {
        Err(Error::OutOfTime { .. }) => Err(cut_short(at_rest(problem)?, settings)),
        Err(Error::NotCertified { solution, .. }) if solution.cut_short.is_none() && settings.watch.cut().is_some() => {
            Err(cut_short(*solution, settings))
        }
        ending => ending,
    }
}

/// The error of a solution that the limit of time cut short.
fn cut_short(solution: Solution, settings: &Settings) -> Error {
    fallen_short(Solution { cut_short: settings.watch.cut(), ..solution }, settings.goal())
}

/// The error to return if a claim cannot be rechecked: an answer that is not certified stays as it is; a claim becomes
/// the body at rest, which is not certified either, with the claim as the reason if there was time to recheck it.
///
/// # Errors
/// Those of the certificate.
pub(super) fn not_decided(problem: &ContactProblem, settings: &Settings, before: Error) -> Result<Error, Error> {
    match before {
        before @ Error::NotCertified { .. } => Ok(before),
        _ if settings.watch.cut().is_some() => Ok(cut_short(at_rest(problem)?, settings)),
        claim => {
            let cut_short = Some("a claim of the method could not be rechecked".to_string());
            let reason = Some(format!("not rechecked: {claim}"));
            Ok(fallen_short(Solution { cut_short, reason, ..at_rest(problem)? }, settings.goal()))
        }
    }
}

/// The error for a stiffness that resists a motion, mainly of `dof`, by a `share` of its terms that the rounding of its entries
/// exceeds: the body at rest, which is not certified.
///
/// # Errors
/// Those of the certificate.
pub(super) fn within_rounding(problem: &ContactProblem, dof: usize, share: f64) -> Result<Error, Error> {
    let reason = format!(
        "the stiffness holds a motion, mainly at dof {dof} (indices from 0), but only within the rounding of its entries; give the \
         rigid-body modes if the body floats"
    );
    let solution = Box::new(Solution { reason: Some(reason), ..at_rest(problem)? });
    let condition = "the rounding of the stiffness, which its support of a motion must exceed,";
    Ok(Error::NotCertified { solution, condition, value: NullSpace::OF_ENTRIES, tolerance: share })
}

/// The answer before anything is found: no displacement and no force, with its certificate.
fn at_rest(problem: &ContactProblem) -> Result<Solution, Error> {
    let (displacement, multiplier) = (vec![0.0; problem.dofs()], vec![0.0; problem.rows()]);
    let certificate = problem.certify_in(None, &displacement, &multiplier)?;
    let (contact_set, history) = (ContactSet::open(problem.rows()), Vec::new());
    let nothing =
        Outcome { displacement, multiplier, contact_set, iterations: 0, history, settled: false, variant: "" };
    Ok(answer(nothing, "none", certificate))
}
