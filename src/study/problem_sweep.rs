//! A problem that moves to another end: gaps, load or both change linearly.

use serde::Serialize;

use super::Summary;
use super::kept_answers::{KeptAnswers, points};
use super::scene::{even_gaps, problem_summary};
use crate::error::Error;
use crate::qp::problem::ContactProblem;
use crate::qp::{Prepared, Settings, Start, between};
use crate::solution::Solution;

/// One point of the path.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemPoint {
    /// Position on the path: 0 for the problem itself, 1 for its other end.
    pub t: f64,
    /// The solution with its numbers.
    #[serde(flatten)]
    pub summary: Summary,
}

/// A row that touches or releases on the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProblemEvent {
    /// The exact position.
    pub t: f64,
    /// The contact row.
    pub row: usize,
    /// `true` if the row touches, `false` if it releases.
    pub touches: bool,
}

/// A problem at several points of the path.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemSweep {
    /// The answers at the points, from 0 to 1.
    pub points: Vec<ProblemPoint>,
    /// The events between the points; `None` if they are not known: the load changes, or the problem is not condensed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<Vec<ProblemEvent>>,
}

/// Solves `first` at `count` points of the path to `last`, the same body and rows with other gaps, another load, or both. An answer that
/// is not certified counts as an answer here.
///
/// The body is factorised once, or a hierarchy is built once, and every solve starts from the last answer. An interrupted sweep holds the
/// points that were solved before.
///
/// # Errors
/// As [`solve`](crate::solve()); [`Error::Interrupted`] if no point was solved.
pub(crate) fn sweep_problem(
    first: &ContactProblem,
    last: &ContactProblem,
    count: usize,
    settings: &Settings,
) -> Result<ProblemSweep, Error> {
    let kept = KeptAnswers::of(count, first.dofs(), settings);
    let settings = &kept.settings(settings);
    let prepared = Prepared::for_gaps(first, count, settings).map_err(|error| kept.explain(error))?;
    let same_load = first.load() == last.load();
    let solved_at = |t: f64, known: Start| {
        let problem = first.with(between(first.load(), last.load(), t), between(first.gap(), last.gap(), t))?;
        let prepared = match same_load {
            true => prepared.starting_from(known),
            false => prepared.with_load(problem.load().to_vec())?.starting_from(known),
        };
        let solved = prepared.solve(problem.gap()).map_err(|error| kept.explain(error));
        Ok((problem, solved))
    };
    let point = |t: f64, problem: ContactProblem, solution: Solution| {
        Ok(ProblemPoint { t, summary: problem_summary(&problem, solution, settings.goal(), 0.0) })
    };
    let points = points("point", &even_gaps(0.0, 1.0, count), settings, solved_at, point)?;
    let is_known = same_load && !settings.watch.acknowledge() && prepared.hierarchy().is_none();
    let path = if is_known { prepared.path(first.gap(), last.gap()).ok() } else { None };
    let event = |event: &crate::qp::Event| ProblemEvent { t: event.at, row: event.row, touches: event.touches };
    Ok(ProblemSweep { points, events: path.map(|path| path.events().iter().map(event).collect()) })
}
