//! Refinement: with the available factor an answer is brought to the digits of doubles, or to the requested accuracy.
//!
//! With the factor K~, in single precision or in double precision with the digits that condensation and bending have
//! left, every step solves a contact problem for the residual,
//!
//! ```text
//! minimise 1/2 d' K~ d - (f - K u)' d   subject to   B d <= g - B u
//! ```
//!
//! condensed, by the same method, and adds d to u. The residual is computed with twice the working precision. If d is
//! zero, the conditions are those of the problem itself; until then the error shrinks by `|I - K~^-1 K|` from step to
//! step. With a factor in single precision that contraction is measured; it widens the bound of the certificate, which
//! uses K~ only.

use std::sync::Arc;

use super::factored::{Factored, Loaded, Reduced, Refined};
use super::interface::{Found, Task};
use super::loading::Loading;
use crate::error::Error;
use crate::linear::dot;
use crate::method::{Ending, Outcome};
use crate::plan::Step;
use crate::solution::{ContactSet, Solution};

/// Number of steps after which no more digits can be gained.
const MOST_STEPS: usize = 30;

/// A contraction above this makes the bound of the certificate worthless.
const LARGEST_CONTRACTION: f64 = 0.2;

/// Steps below this share of the displacement are rounding and do not show the contraction.
const LEAST_STEP: f64 = 1e-9;

/// A step below this share of the displacement no longer changes it.
const NOTHING: f64 = 4.0 * f64::EPSILON;

/// The target accuracy is this share of the requested one, because the contraction is an estimate.
const AIM: f64 = 0.1;

impl Factored {
    /// Refines the result of the method with the factor in single precision.
    ///
    /// # Errors
    /// [`Error::Numerical`] if the stiffness is too ill-conditioned for single precision, and those of the method.
    pub(super) fn refined(&self, first: Reduced, task: &Task) -> Result<Reduced, Error> {
        let (load, gap, settings) = (first.loading.load.clone(), first.gap.clone(), task.settings);
        let mut rest = load.clone();
        let mut found = first;
        let mut refined = Refined { base: vec![0.0; self.problem.dofs()], contraction: 0.0, steps: 0 };
        let mut last_length = f64::INFINITY;
        loop {
            let step = self.expand(&found.loading, found.unit, &found.outcome.displacement);
            let displacement: Vec<f64> = refined.base.iter().zip(&step).map(|(u, d)| u + d).collect();
            // K~ d is the residual of the load and the contact force.
            let multiplier = self.expand_multiplier(&found.outcome.multiplier, found.unit);
            let contact = self.problem.contact().mul_transposed(&multiplier);
            let work: f64 = step.iter().zip(rest.iter().zip(&contact)).map(|(d, (r, c))| d * (r + c)).sum();
            let elastic = self.problem.stiffness().mul(&displacement);
            let (length, size) = (work.max(0.0).sqrt(), dot(&displacement, &elastic).max(0.0).sqrt());
            let ratio = if last_length > 0.0 { length / last_length } else { 0.0 };
            if last_length.is_finite() && last_length > LEAST_STEP * size {
                refined.contraction = refined.contraction.max(ratio);
            }
            if refined.contraction > LARGEST_CONTRACTION {
                let reason =
                    "the stiffness is too ill-conditioned for single precision; take double precision".to_string();
                return Err(Error::Numerical { step: "refinement of a factor in single precision", reason });
            }
            let good_enough = settings
                .accuracy
                .is_some_and(|accuracy| refined.steps > 0 && length * refined.contraction <= AIM * accuracy * size);
            let no_gain = refined.steps > 0 && (length <= NOTHING * size || ratio > 0.5);
            if good_enough || no_gain || settings.watch.is_over() || refined.steps == MOST_STEPS {
                return Ok(Reduced {
                    gap,
                    loading: Arc::new(found.loading.with_load(load)),
                    refined: Some(refined),
                    ..found
                });
            }
            rest = load.iter().zip(&elastic).map(|(f, k)| f - k).collect();
            let (contact_set, seconds) = (self.expand_set(&found.outcome.contact_set), found.factor_seconds);
            let answer = Answer { displacement: &displacement, multiplier: &multiplier, contact_set: &contact_set };
            let Some(next) = self.step_from(task, &answer)? else { return Ok(found) };
            let Outcome { history, iterations, .. } = std::mem::replace(&mut found, next).outcome;
            // A step that keeps the set adds nothing to the history.
            let kept = found
                .outcome
                .history
                .iter()
                .all(|entry| Some(&entry.contact_set) == history.last().map(|last| &last.contact_set));
            found.outcome.history = if kept { history } else { [history, found.outcome.history].concat() };
            found.outcome.iterations = iterations;
            found.factor_seconds += seconds;
            refined.base = displacement;
            refined.steps += 1;
            last_length = length;
        }
    }

    /// The step d: the answer to the contact problem for the residual of an `answer` (u, lambda), started from its
    /// contact set, together with the whole multiplier.
    fn step_from(&self, task: &Task, answer: &Answer) -> Result<Option<Reduced>, Error> {
        let Answer { displacement, multiplier, contact_set } = *answer;
        // The contact force is balanced on its own dofs; only the imbalance is swept.
        let imbalance = task.problem.accurate_residual(displacement, multiplier);
        let contact = task.problem.contact().mul_transposed(multiplier);
        let released: Vec<f64> = contact.iter().map(|force| -force).collect();
        let gap: Vec<f64> = task.problem.accurate_violation(displacement).iter().map(|violation| -violation).collect();
        let loading = match self.reduction.condensation {
            Some(_) => Loading::of(&self.reduction, imbalance, &self.reduction.selection.gap(&gap))
                .with_contact_force(&self.reduction, &released),
            None => {
                let rest = imbalance.iter().zip(&released).map(|(r, b)| r + b).collect();
                Loading::of(&self.reduction, rest, &self.reduction.selection.gap(&gap))
            }
        };
        let loaded = Loaded { loading: Arc::new(loading), gap };
        self.find_step(loaded, &Task { step: Step::Method, start: &contact_set.into(), ..*task })
    }

    /// The best answer, refined by one step. `None` if there is no answer for its residual: it may still be good
    /// enough.
    pub(super) fn refined_answer(&self, task: &Task, best: &Solution) -> Option<Found> {
        task.settings.watch.step("refinement", 0);
        let Solution { displacement, multiplier, contact_set, .. } = best;
        let Ok(Some(step)) = self.step_from(task, &Answer { displacement, multiplier, contact_set }) else {
            return None;
        };
        let moved = self.expand(&step.loading, step.unit, &step.outcome.displacement);
        let outcome = Outcome {
            displacement: displacement.iter().zip(&moved).map(|(u, d)| u + d).collect(),
            multiplier: self.expand_multiplier(&step.outcome.multiplier, step.unit),
            contact_set: self.expand_set(&step.outcome.contact_set),
            ..Outcome::at_rest(task.problem, Ending::Settled)
        };
        Some(Found { outcome, factor_seconds: step.factor_seconds, refined: None })
    }
}

/// An answer to be refined.
struct Answer<'a> {
    displacement: &'a [f64],
    multiplier: &'a [f64],
    contact_set: &'a ContactSet,
}
