//! The engine with a factor, on the contact boundary: an answer there, and its path while the gaps move.

use std::sync::Arc;

use super::factored::{Factored, Reduced};
use super::interface::{Body, Expansion, OnBoundary, Task, Walk};
use crate::certificate::Bounding;
use crate::error::Error;
use crate::linear::ldexp;
use crate::method::parametric::ParametricLcp;
use crate::solution::{Certificate, ContactSet};

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

/// The way back from the rows that the methods work on, at this exponent of the reference displacement.
#[derive(Debug)]
struct ToRows {
    engine: Arc<Factored>,
    unit: i32,
}

impl Expansion for ToRows {
    fn multiplier(&self, reduced: &[f64]) -> Vec<f64> {
        self.engine.expand_multiplier(reduced, self.unit)
    }

    fn contact_set(&self, reduced: &ContactSet) -> ContactSet {
        self.engine.expand_set(reduced)
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

    /// The way from the answer of a task to the answer at the gaps `to`; `None` if the task has no answer on the
    /// boundary that meets its goal.
    pub fn walk_to(self: Arc<Self>, from: &Task, to: &[f64]) -> Result<Option<Walk>, Error> {
        let reduction = &self.reduction;
        let is_walkable = reduction.is_definite();
        let Some(condensed) = reduction.condensation.as_ref().filter(|_| is_walkable) else {
            return Err(Error::NotCondensed { step: "the exact path" });
        };
        self.check_gap(to)?;
        let Some((found, _)) = self.found_on_boundary(from, true)? else { return Ok(None) };
        let Reduced { loading, unit, problem, outcome, .. } = &found;
        let free = condensed.contact.mul(&condensed.free_displacement(&loading.sweep));
        let at_end = reduction.scaling.gap(&reduction.selection.gap(to), *unit);
        let constant =
            free.iter().zip(problem.gap()).map(|(&free, gap)| ldexp(free, loading.unit - unit) - gap).collect();
        let slope = problem.gap().iter().zip(&at_end).map(|(first, last)| first - last).collect();
        let compliance = ParametricLcp::new(condensed.compliance(), constant, slope);
        let (pieces, mut events) = compliance.walk(&outcome.contact_set, &from.settings.watch)?;
        events.iter_mut().for_each(|event| event.row = reduction.selection.kept[event.row]);
        Ok(Some(Walk { pieces, events, to_rows: Arc::new(ToRows { unit: *unit, engine: self.clone() }) }))
    }
}
