//! Engines: a problem prepared once, and solved for many gaps, loads and starts. One has a factor of the stiffness, the other a
//! multigrid hierarchy; [`Prepared`] is the door to both.

mod answer;
mod boundary;
mod case;
mod evidence;
mod factored;
mod found;
mod loading;
mod multigrid;
mod path;
mod preparation;
mod prepared;
mod reduction;
mod refinement;

pub use boundary::BoundarySolution;
pub use path::Path;
pub use prepared::Prepared;

use crate::error::Error;
use crate::qp::problem::ContactProblem;
use crate::qp::settings::Settings;
use crate::solution::ContactSet;

/// Displacement and multiplier of `problem` with the rows of `closed` held at their gaps.
///
/// # Errors
/// As [`with_contact_set`](super::with_contact_set).
pub(super) fn with_contact_set(problem: &ContactProblem, closed: &ContactSet) -> Result<(Vec<f64>, Vec<f64>), Error> {
    factored::Factored::new(problem, &Settings::default())?.with_contact_set(closed)
}
