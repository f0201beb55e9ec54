//! Refinement: with the available factor an answer is brought to the digits of doubles.
//!
//! With the factor K~, which has the digits that condensation and bending have left, every step solves a contact
//! problem for the residual,
//!
//! ```text
//! minimise 1/2 d' K~ d - (f - K u)' d   subject to   B d <= g - B u
//! ```
//!
//! condensed, by the same method, and adds d to u. The residual is computed with twice the working precision. If d is
//! zero, the conditions are those of the problem itself; until then the error shrinks by `|I - K~^-1 K|` from step to
//! step.

use std::sync::Arc;

use super::factored::{Factored, Loaded, Reduced};
use super::interface::{Found, Task};
use super::loading::Loading;
use crate::error::Error;
use crate::method::{Ending, Outcome};
use crate::plan::Step;
use crate::solution::Solution;

impl Factored {
    /// The step d: the answer to the contact problem for the residual of an `answer` (u, lambda), started from its
    /// contact set, together with the whole multiplier.
    fn step_from(&self, task: &Task, answer: &Solution) -> Result<Option<Reduced>, Error> {
        let Solution { displacement, multiplier, contact_set, .. } = answer;
        // The contact force is balanced on its own dofs; only the imbalance is swept.
        let imbalance = task.problem.accurate_residual(displacement, multiplier);
        let contact = task.problem.contact().mul_transposed(multiplier);
        let released: Vec<f64> = contact.iter().map(|force| -force).collect();
        let gap: Vec<f64> = task.problem.accurate_violation(displacement).iter().map(|violation| -violation).collect();
        let loading = match self.reduction.condensation {
            Some(_) => Loading::of(&self.reduction, &imbalance, &self.reduction.selection.gap(&gap))
                .with_contact_force(&self.reduction, &released),
            None => {
                let rest: Vec<f64> = imbalance.iter().zip(&released).map(|(r, b)| r + b).collect();
                Loading::of(&self.reduction, &rest, &self.reduction.selection.gap(&gap))
            }
        };
        let loaded = Loaded { loading: Arc::new(loading), gap };
        self.find_step(loaded, &Task { step: Step::Method, start: &contact_set.into(), ..*task })
    }

    /// The best answer, refined by one step. `None` if there is no answer for its residual: it may still be good
    /// enough.
    pub(super) fn refined_answer(&self, task: &Task, best: &Solution) -> Option<Found> {
        task.settings.watch.step("refinement", 0);
        let Ok(Some(step)) = self.step_from(task, best) else { return None };
        let moved = self.expand(&step.loading, step.unit, &step.outcome.displacement);
        let outcome = Outcome {
            displacement: best.displacement.iter().zip(&moved).map(|(u, d)| u + d).collect(),
            multiplier: self.expand_multiplier(&step.outcome.multiplier, step.unit),
            contact_set: self.expand_set(&step.outcome.contact_set),
            ..Outcome::at_rest(task.problem, Ending::Settled)
        };
        Some(Found { outcome, factor_seconds: step.factor_seconds })
    }
}
