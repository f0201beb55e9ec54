//! The engine for an attempt.

use std::sync::Arc;

use crate::error::Error;
use crate::qp::certificate::Bounding;
use crate::qp::engine::{Engine, Factored, Found, Hierarchical, Task};
use crate::qp::plan::{Attempt, Basis, Tried};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{Method, Settings};
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
    let settings = &attempt.settings(settings);
    Ok(match attempt.basis {
        Basis::Multigrid => Arc::new(Hierarchical::new(problem, settings)?),
        Basis::Factor | Basis::Problem => Arc::new(Factored::new(problem, settings)?),
    })
}

/// The engine of an attempt whose data cannot be prepared: each of its steps fails for the same reason, and the plan goes on.
#[derive(Debug)]
pub(in crate::qp) struct Unprepared {
    pub problem: ContactProblem,
    pub attempt: Attempt,
}

impl Engine for Unprepared {
    fn basis(&self) -> Basis {
        self.attempt.basis
    }

    fn serves(&self, _: Method) -> bool {
        false
    }

    fn seconds(&self) -> Seconds {
        Seconds::default()
    }

    fn tried(&self, _: &Settings) -> Tried {
        Tried::on_all_dofs(self.attempt.method)
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
