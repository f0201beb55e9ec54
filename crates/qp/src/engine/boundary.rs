//! The engine with a factor, on the contact boundary: an answer there.

use std::sync::Arc;

use super::factored::{Factored, Reduced};
use super::interface::{Body, OnBoundary, Task};
use crate::certificate::Bounding;
use crate::error::Error;
use crate::solution::Certificate;

/// The result on the boundary, from which the displacement of the body follows.
#[derive(Debug)]
struct Condensed {
    engine: Arc<Factored>,
    found: Reduced,
}

impl Body for Condensed {
    fn displacement(&self) -> Vec<f64> {
        self.engine.displacement(&self.found)
    }
}

impl Factored {
    /// The result of the method with the certificate of the condensed problem: its conditions recomputed there, and its
    /// error bound if it is asked for. `None` if it does not meet the goal, or if the condensed problem is that of a
    /// refinement only.
    pub(super) fn found_on_boundary(
        &self,
        task: &Task,
        is_bounded: bool,
    ) -> Result<Option<(Reduced, Certificate)>, Error> {
        let settings = task.settings;
        let Some(found) = self.find(task)? else { return Ok(None) };
        let Reduced { problem, outcome, .. } = &found;
        let by = if is_bounded { self.condensed_bounding(problem, &settings.watch) } else { Bounding::Nothing };
        let certificate = problem.examine(&by, &outcome.displacement, &outcome.multiplier)?.certificate;
        let is_met = match is_bounded {
            true => settings.goal().is_met_by(&certificate),
            false => certificate.conditions_hold(settings.goal().tolerance),
        };
        Ok(is_met.then_some((found, certificate)))
    }

    /// The same as an answer of the whole problem.
    pub fn answer_on_boundary(self: Arc<Self>, task: &Task, is_bounded: bool) -> Result<Option<OnBoundary>, Error> {
        let Some((found, condensed_certificate)) = self.found_on_boundary(task, is_bounded)? else { return Ok(None) };
        Ok(Some(OnBoundary {
            multiplier: self.expand_multiplier(&found.outcome.multiplier, found.unit),
            contact_set: self.expand_set(&found.outcome.contact_set),
            iterations: found.outcome.iterations,
            condensed_certificate,
            body: Arc::new(Condensed { engine: self, found }),
        }))
    }
}
