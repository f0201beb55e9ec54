//! The engine with a factor: the path of an answer while its gaps move.

use std::sync::Arc;

use super::factored::{Factored, Reduced};
use super::interface::{Expansion, Task, Walk};
use crate::error::Error;
use crate::linear::ldexp;
use crate::method::parametric::Compliance;
use crate::solution::ContactSet;

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
        let free = condensed.contact().mul(&condensed.free_displacement(&loading.sweep));
        let at_end = reduction.scaling.gap(&reduction.selection.gap(to), *unit);
        let constant =
            free.iter().zip(problem.gap()).map(|(&free, gap)| ldexp(free, loading.unit - unit) - gap).collect();
        let slope = problem.gap().iter().zip(&at_end).map(|(first, last)| first - last).collect();
        let compliance = Compliance::new(condensed.compliance(), constant, slope);
        let (pieces, mut events) = compliance.walk(&outcome.contact_set, &from.settings.watch)?;
        events.iter_mut().for_each(|event| event.row = reduction.selection.kept()[event.row]);
        Ok(Some(Walk { pieces, events, to_rows: Arc::new(ToRows { unit: *unit, engine: self.clone() }) }))
    }
}
