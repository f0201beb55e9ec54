//! The answer of a problem whose equalities are eliminated.

use crate::certificate::{EnergyNorm, motion_along};
use crate::error::Error;
use crate::method::Start;
use crate::problem::ContactProblem;
use crate::settings::Settings;
use crate::solution::{Certificate, Seconds, Solution};
use crate::transform::Elimination;

/// What a problem without its equalities says of the whole.
pub(super) enum Rest {
    /// Its answer, put back, with its certificate if the whole is to have no factor with its equalities.
    Answer(Box<Solution>, Option<Certificate>),
    /// It moves along a direction that nothing holds, as the error says in terms of the whole.
    Moves(Error),
    Open,
}

/// What is kept of a prepared problem without its equalities.
pub(crate) struct KeptRest<'a> {
    pub elimination: &'a Elimination,
    pub norm: &'a Option<EnergyNorm>,
    /// The answer of the rest of a problem.
    pub solve: &'a dyn Fn(&Start, &Settings) -> Result<Solution, Error>,
}

/// The answer, found by `solve` without the equalities, or by what is `kept`, with the equalities put back and without
/// a certificate; nothing if they are not eliminated, or if it is left to the whole whether there is an answer.
pub(super) fn solved(
    problem: &ContactProblem,
    start: &Start,
    settings: &Settings,
    kept: Option<&KeptRest>,
    solve: impl Fn(&ContactProblem, &Start, &Settings) -> Result<Solution, Error>,
) -> Result<Rest, Error> {
    let made = if kept.is_some() { None } else { Elimination::of(problem)? };
    let Some(elimination) = kept.map(|kept| kept.elimination).or(made.as_ref()) else { return Ok(Rest::Open) };
    let start = Start {
        displacement: start.displacement.as_deref().map(|u| elimination.staying(u)),
        contact_set: start.contact_set.as_ref().map(|set| elimination.staying_rows(set)),
    };
    // The certificate of the whole and its proof follow.
    let settings = &Settings { prove: false, ..settings.clone() };
    let anew = || elimination.problem(problem).and_then(|rest| solve(&rest, &start, settings));
    let answer = match kept.map_or_else(anew, |kept| (kept.solve)(&start, settings)) {
        Ok(solution) => solution,
        Err(Error::NotCertified { solution, .. }) => *solution,
        Err(Error::Interrupted) => return Err(Error::Interrupted),
        Err(Error::Infeasible { rows, weights, .. }) => {
            let (rows, weights) = elimination.contradiction(problem, &rows, &weights);
            let is_proven = problem.overlap(&rows, &weights).is_some();
            return if is_proven { Err(problem.infeasible(&rows, &weights)) } else { Ok(Rest::Open) };
        }
        Err(error) => {
            let moves = |direction| motion_along(problem, &elimination.motion(direction));
            return Ok(error.direction().and_then(moves).map_or(Rest::Open, Rest::Moves));
        }
    };
    let seconds = Seconds { proof: 0.0, ..answer.seconds };
    let of_rest = elimination.is_cut().then_some(answer.certificate);
    Ok(Rest::Answer(Box::new(elimination.expanded(problem, Solution { seconds, ..answer })), of_rest))
}
