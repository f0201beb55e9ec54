//! A problem that moves to another end: gaps, load or both change linearly.

use super::Summary;
use super::kept_answers::{KeptAnswers, points};
use super::scene::Sweep;
use crate::error::Error;
use serde::Serialize;
use signorini_qp::{ContactProblem, Prepared, Settings, Solution, Start};

/// The answer to a problem whose gaps and load lie between those of a directory and those of its other end.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemPoint {
    /// Position on the path: 0 for the problem itself, 1 for its other end.
    pub t: f64,
    /// The answer at this point of the path with its certificate, forces and warnings.
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
    /// `true` if the row closes as t grows, `false` if it opens.
    pub touches: bool,
}

/// The answers of a problem directory at several points of the way to its other end.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemSweep {
    /// The answers at the points, from 0 to 1.
    pub points: Vec<ProblemPoint>,
    /// The events between the points; `None` if they are not known: the load changes, or the problem is not condensed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<Vec<ProblemEvent>>,
}

impl ProblemSweep {
    /// Solves `first` at `count` points of the path to `last`, the same body and rows with other gaps, another load, or
    /// both. An answer that is not certified counts as an answer here.
    ///
    /// The body is factorised once, or a hierarchy is built once, and every solve starts from the last answer. An
    /// interrupted sweep holds the points that were solved before.
    ///
    /// # Errors
    /// As [`solve`](signorini_qp::solve()); [`qp::Error::Interrupted`](signorini_qp::Error::Interrupted) if no point
    /// was solved.
    pub fn of(first: &ContactProblem, last: &ContactProblem, count: usize, settings: &Settings) -> Result<Self, Error> {
        let kept = KeptAnswers::of(count, first.dofs(), settings);
        let settings = &kept.settings(settings);
        let prepared = Prepared::for_gaps(first, count, settings).map_err(|error| kept.explain(error.into()))?;
        let same_load = first.load() == last.load();
        let solved_at = |t: f64, known: Start| {
            let problem = first.towards(last, t)?;
            let prepared = match same_load {
                true => prepared.starting_from(known),
                false => prepared.with_load(problem.load().to_vec())?.starting_from(known),
            };
            let solved = prepared.solve(problem.gap()).map_err(|error| kept.explain(error.into()));
            Ok((problem, solved))
        };
        let point = |t: f64, problem: ContactProblem, solution: Solution| {
            Ok(ProblemPoint { t, summary: Summary::of_problem(&problem, solution, settings.goal(), 0.0) })
        };
        let points = points("point", &Sweep::even_gaps(0.0, 1.0, count), settings, solved_at, point)?;
        let is_known = same_load && !settings.watch.acknowledge() && prepared.hierarchy().is_none();
        let path = if is_known { prepared.path(first.gap(), last.gap()).ok() } else { None };
        let of_path = path.as_ref().map(|path| path.events().iter());
        let events = of_path.map(|events| {
            events.map(|event| ProblemEvent { t: event.at, row: event.row, touches: event.touches }).collect()
        });
        Ok(ProblemSweep { points, events })
    }
}
