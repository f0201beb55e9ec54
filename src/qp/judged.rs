//! The verdict: an answer that meets its goal, or the best answer inside an error that says what falls short.

use super::problem::ContactProblem;
use crate::error::Error;
use crate::solution::{ContactSet, Goal, Seconds, Solution};

/// The solution if its certificate meets the goal.
///
/// # Errors
/// [`Error::NotCertified`] with the solution, and the condition that decides.
pub(super) fn judged(solution: Solution, goal: Goal) -> Result<Solution, Error> {
    if goal.is_met_by(&solution.certificate) {
        return Ok(solution);
    }
    let (condition, value, tolerance) = goal.decisive(&solution.certificate);
    Err(Error::NotCertified { solution: Box::new(solution), condition, value, tolerance })
}

/// The same ending with `change` made to its solution, also to one that falls short.
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

/// The ending where there is no time for a first factorisation, of `needed` seconds with `left` to go: the body at rest.
///
/// # Errors
/// Those of the certificate.
pub(super) fn out_of_time(problem: &ContactProblem, needed: f64, left: f64) -> Result<Error, Error> {
    let condition = "the time of one factorisation (s)";
    Ok(Error::NotCertified { solution: Box::new(at_rest(problem)?), condition, value: needed, tolerance: left })
}

/// The ending where a claim about the problem could not be rechecked: the body at rest, and the claim as the reason.
///
/// # Errors
/// Those of the certificate.
pub(super) fn not_rechecked(problem: &ContactProblem, claim: &Error) -> Result<Error, Error> {
    let solution = Box::new(Solution { reason: Some(format!("not rechecked: {claim}")), ..at_rest(problem)? });
    let condition = "a claim that could not be rechecked";
    Ok(Error::NotCertified { solution, condition, value: 0.0, tolerance: 0.0 })
}

/// The answer before anything is found: no displacement and no force, and how far that is off.
fn at_rest(problem: &ContactProblem) -> Result<Solution, Error> {
    let (displacement, multiplier) = (vec![0.0; problem.dofs()], vec![0.0; problem.rows()]);
    let certificate = problem.certify_in(None, &displacement, &multiplier)?;
    Ok(Solution {
        displacement,
        multiplier,
        contact_set: ContactSet::open(problem.rows()),
        method: "none".to_string(),
        iterations: 0,
        history: Vec::new(),
        certificate,
        proven: None,
        refinements: None,
        lost_pivot: None,
        reason: None,
        attempts: Vec::new(),
        condensed_dofs: problem.dofs(),
        seconds: Seconds::default(),
    })
}
