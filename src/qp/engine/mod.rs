//! Engines: a problem prepared once, and solved for many gaps, loads and starts. One engine has a factor of the stiffness, the other a
//! multigrid hierarchy; [`Prepared`] is the interface to both and uses only the trait `case::Engine`.

mod answer;
mod boundary;
mod case;
mod evidence;
mod factored;
mod found;
mod loading;
mod multigrid;
mod on_boundary;
mod path;
mod preparation;
mod prepared;
mod reduction;
mod refinement;
mod run;
mod walk;

pub use boundary::BoundarySolution;
#[cfg(feature = "cli")]
pub(super) use multigrid::certify_by_multigrid;
pub use path::Path;
pub use prepared::Prepared;

use crate::error::Error;
use crate::qp::problem::ContactProblem;
use crate::qp::settings::Settings;
use crate::solution::ContactSet;

/// Displacement and multiplier of a body with some rows held at their gaps and all others free.
pub(super) type Held = Result<(Vec<f64>, Vec<f64>), Error>;

/// Factorises `problem`; the function returned gives displacement and multiplier with the rows of a set held at their gaps.
///
/// # Errors
/// As [`with_contact_sets`](super::with_contact_sets).
pub(super) fn with_contact_sets(problem: &ContactProblem) -> Result<impl Fn(&ContactSet) -> Held, Error> {
    let factored = factored::Factored::new(problem, &Settings::default())?;
    Ok(move |closed: &ContactSet| factored.with_contact_set(closed))
}
