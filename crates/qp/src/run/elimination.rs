//! The answer of a problem whose equalities are eliminated.

use crate::error::Error;
use crate::method::Start;
use crate::problem::ContactProblem;
use crate::settings::Settings;
use crate::solution::{Certificate, Seconds, Solution};
use crate::transform::Elimination;

/// The answer of a problem without its equalities, put back.
pub(super) struct Rest {
    pub answer: Solution,
    /// The certificate of the rest, if the whole is to have no factor with its equalities.
    pub of_rest: Option<Certificate>,
}

/// The answer, found by `solve` without the equalities, with the equalities put back and without a certificate; `None`
/// if they are not eliminated, or if the rest has no answer of its own, or more than one: that is decided for the
/// whole.
///
/// # Errors
/// [`Error::Infeasible`] with rows of the whole; [`Error::Interrupted`].
pub(super) fn solved(
    problem: &ContactProblem,
    start: &Start,
    settings: &Settings,
    solve: impl Fn(&ContactProblem, &Start, &Settings) -> Result<Solution, Error>,
) -> Result<Option<Rest>, Error> {
    let Some(elimination) = Elimination::of(problem)? else { return Ok(None) };
    // The certificate of the whole and its proof follow.
    let settings = &Settings { prove: false, ..settings.clone() };
    let Ok(rest) = elimination.problem(problem) else { return Ok(None) };
    let start = Start {
        displacement: start.displacement.as_deref().map(|u| elimination.staying(u)),
        contact_set: start.contact_set.as_ref().map(|set| elimination.staying_rows(set)),
    };
    let answer = match solve(&rest, &start, settings) {
        Ok(solution) => solution,
        Err(Error::NotCertified { solution, .. }) => *solution,
        Err(Error::Interrupted) => return Err(Error::Interrupted),
        Err(Error::Infeasible { rows, weights, .. }) => {
            let (rows, weights) = elimination.contradiction(problem, &rows, &weights);
            let is_proven = problem.overlap(&rows, &weights).is_some();
            return if is_proven { Err(problem.infeasible(&rows, &weights)) } else { Ok(None) };
        }
        Err(_) => return Ok(None),
    };
    let seconds = Seconds { proof: 0.0, ..answer.seconds };
    let of_rest = elimination.is_cut().then_some(answer.certificate);
    Ok(Some(Rest { answer: elimination.expanded(problem, Solution { seconds, ..answer }), of_rest }))
}
