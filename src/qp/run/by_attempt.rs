//! The engine for an attempt.

use std::sync::Arc;

use crate::error::Error;
use crate::qp::certificate::Bounding;
use crate::qp::engine::{Engine, Factored, Found, Hierarchical, Task};
use crate::qp::plan::{Attempt, Means, Tried, WithFactor};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{ByFactor, Settings};
use crate::solution::Seconds;
use crate::watch::Watch;

/// The engine for an attempt.
///
/// # Errors
/// Those of the engine.
pub(in crate::qp) fn engine_of(
    problem: &ContactProblem,
    attempt: &Attempt,
    settings: &Settings,
) -> Result<Arc<dyn Engine>, Error> {
    Ok(match attempt.means {
        Means::Multigrid => Arc::new(Hierarchical::new(problem, settings)?),
        Means::Factor(with) => Arc::new(Factored::new(problem, &with, settings)?),
        Means::Problem => Arc::new(Factored::new(problem, &WithFactor::BY_RULES, settings)?),
    })
}

/// The engine of an attempt whose data cannot be prepared: each of its steps fails for the same reason, and the plan goes on.
#[derive(Debug)]
pub(in crate::qp) struct Unprepared {
    pub problem: ContactProblem,
    pub attempt: Attempt,
}

impl Engine for Unprepared {
    fn serves(&self, _: &Means) -> bool {
        false
    }

    fn seconds(&self) -> Seconds {
        Seconds::default()
    }

    fn tried(&self, _: Option<ByFactor>, _: &Settings) -> Tried {
        Tried::on_all_dofs(self.attempt.method())
    }

    fn make(&self, task: &Task) -> Result<Option<Found>, Error> {
        engine_of(&self.problem, &self.attempt, task.settings)?.make(task)
    }

    fn bounding(&self, _: &Watch, _: f64) -> Bounding<'_> {
        Bounding::OwnFactor
    }

    fn bytes(&self) -> f64 {
        0.0
    }
}
