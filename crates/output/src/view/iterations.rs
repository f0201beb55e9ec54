//! The steps of the search for the contact set, each with its displaced body.

use std::sync::Arc;

use crate::plots::ticks::brief;
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Model};
use signorini_qp as qp;
use signorini_qp::{Iteration, Method, Penalty, Settings, solve};

/// Largest number of iterations that are shown.
const MOST_ITERATIONS: usize = 12;

pub(crate) struct Step {
    /// Its place in the history.
    pub index: usize,
    /// `iteration-3`, or `rung-3` of a penalty loop.
    pub name: String,
    /// The same in words.
    pub what: String,
    /// The body with the rows of the set held at their gaps, or by the penalty.
    pub answer: Answer,
}

/// The displacement and the multiplier of an iteration; `None` if it has none.
type Found = Option<(Vec<f64>, Vec<f64>)>;

/// For each contact set of the history of a body in the plane or in space: the displacement with the rows of the set
/// held at their gaps. For a penalty loop: one displacement for each penalty, with its settled set. A set that does not
/// hold the body by itself has no displacement and is left out.
pub(crate) fn iterations(model: &Arc<Model>, history: &[Iteration]) -> Result<Vec<Step>, Error> {
    if model.mesh().dimension() == 1 || history.is_empty() {
        return Ok(Vec::new());
    }
    let is_last_of_rung = |&index: &usize| {
        let penalty = history[index].penalty;
        penalty > 0.0 && history.get(index + 1).is_none_or(|next| next.penalty != penalty)
    };
    let rungs: Vec<usize> = (0..history.len()).filter(is_last_of_rung).collect();
    let (steps, name) = match rungs.is_empty() {
        true => ((0..history.len()).collect(), "iteration"),
        false => (rungs, "rung"),
    };
    let held_at = if name == "iteration" { model.problem().with_contact_sets().ok() } else { None };
    let find = |step: &Iteration| -> Found {
        match &held_at {
            Some(held_at) => held_at(&step.contact_set).map(|[u, lambda]| (u, lambda)),
            None if step.penalty > 0.0 => of_penalty(model, step.penalty),
            None => None,
        }
    };
    let chosen = evenly(steps.len(), MOST_ITERATIONS);
    let mut shown = Vec::new();
    for &place in &chosen {
        let (index, number) = (steps[place], place + 1);
        let step = &history[index];
        let Some((displacement, multiplier)) = find(step) else { continue };
        let mut what = match step.penalty > 0.0 {
            true => format!("penalty {} times the local stiffness", brief(step.penalty)),
            false => format!("iteration {number} of {}", steps.len()),
        };
        if chosen.len() < steps.len() {
            what += &format!(" ({} drawn)", chosen.len());
        }
        let answer = Answer::new(model.clone(), &displacement, &multiplier, &step.contact_set)?;
        shown.push(Step { index, name: format!("{name}-{number}"), what, answer });
    }
    Ok(shown)
}

/// The settled answer of the penalty loop at one penalty.
fn of_penalty(model: &Model, penalty: f64) -> Found {
    let ladder = Penalty { first: penalty, last: penalty, ..Penalty::default() };
    let settings = Settings::with_method(Method::Penalty(ladder));
    let solution = match solve(model.problem(), &settings) {
        Ok(solution) => solution,
        // Certified or not: only the last rung is exact.
        Err(qp::Error::NotCertified { solution, .. }) => *solution,
        Err(_) => return None,
    };
    Some((solution.displacement, [solution.multiplier, solution.equality_multiplier].concat()))
}

/// At most `most` indices below `count`, the first and the last among them, at even distances.
fn evenly(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::evenly;

    #[test]
    fn of_many_iterations_twelve_are_drawn_with_the_first_and_the_last() {
        assert_eq!(evenly(5, 12), [0, 1, 2, 3, 4]);
        for count in [13, 14, 40, 1000] {
            let chosen = evenly(count, 12);
            assert_eq!((chosen.len(), chosen[0], chosen[11]), (12, 0, count - 1));
            assert!(chosen.is_sorted_by(|a, b| a < b), "{chosen:?}");
        }
    }
}
