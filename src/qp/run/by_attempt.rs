//! The engine for an attempt.

use std::sync::Arc;

use crate::error::Error;
use crate::qp::engine::{Engine, Factored, Hierarchical};
use crate::qp::plan::{Attempt, Means, WithFactor};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::Settings;

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
