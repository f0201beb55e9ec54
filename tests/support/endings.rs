//! What a solve ends with, for tests that judge an answer whether it is certified or not.

use signorini::qp::Error;
use signorini::{ContactProblem, Method, Settings, Solution, solve};

/// The answer of a solve, certified or not; panics if there is none.
#[track_caller]
pub fn best(ending: Result<Solution, Error>) -> Solution {
    ending.unwrap_or_else(|error| match error {
        Error::NotCertified { solution, .. } => *solution,
        error => panic!("{error}"),
    })
}

/// The certified answer of a method; that of the penalty method need not be certified.
#[track_caller]
pub fn answer_by(method: Method, problem: &ContactProblem) -> Solution {
    let ending = solve(problem, &Settings::with_method(method));
    if method == Method::penalty() {
        best(ending)
    } else {
        ending.unwrap_or_else(|error| panic!("{method:?}: {error}"))
    }
}
