//! The steps of the search for the contact set, each with the body that it stands for.

use std::sync::Arc;

use crate::error::Error;
use crate::qp::with_contact_sets;
use crate::scene::{Answer, Model};
use crate::solution::Iteration;

/// More iterations than this are not shown one by one.
const MOST_ITERATIONS: usize = 12;

/// For each set of the history of a body in the plane its number, from 1, and the displacement with the rows of the set held at their
/// gaps. None where the method works with penalties or takes more than twelve iterations; a set that does not hold the body by itself
/// has no displacement to show.
///
/// # Errors
/// [`Error::Length`] for the history of another model.
pub(super) fn iterations(model: &Arc<Model>, history: &[Iteration]) -> Result<Vec<(usize, Answer)>, Error> {
    let with_penalty = history.iter().any(|step| step.penalty > 0.0);
    if model.mesh().dimension() != 2 || with_penalty || history.is_empty() || history.len() > MOST_ITERATIONS {
        return Ok(Vec::new());
    }
    let Ok(held_at) = with_contact_sets(model.problem()) else { return Ok(Vec::new()) };
    let mut answers = Vec::new();
    for (index, step) in history.iter().enumerate() {
        let Ok((displacement, multiplier)) = held_at(&step.contact_set) else { continue };
        answers.push((index + 1, Answer::new(model.clone(), &displacement, &multiplier, &step.contact_set)?));
    }
    Ok(answers)
}
