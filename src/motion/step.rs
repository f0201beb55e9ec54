//! What every scheme needs for a step: the trait that it implements, the prepared contact problem of its steps, sums of vectors.

use std::fmt;

use super::{DynamicProblem, State};
use crate::error::Error;
use crate::qp::problem::ContactProblem;
use crate::qp::{Prepared, Settings};
use crate::solution::ContactSet;

/// A scheme with everything prepared that does not change from step to step.
pub(super) trait Advance: fmt::Debug + Send + Sync {
    /// The first state.
    fn start(&self, problem: &DynamicProblem, step: f64, state: State) -> Result<State, Error>;
    /// The state after one step.
    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error>;
}

/// A matrix prepared for one contact problem after another on the rows of a motion.
#[derive(Debug)]
pub(super) struct Stepping {
    prepared: Prepared,
}

/// What a step found: change of the displacement, multipliers, closed rows.
pub(super) struct Found {
    pub change: Vec<f64>,
    pub multiplier: Vec<f64>,
    pub contact_set: ContactSet,
}

impl Stepping {
    /// Factorises the matrix of `problem`; its load and gaps say nothing but which rows there are.
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        let prepared = Prepared::new(problem, settings)?;
        // A step is done whole or not at all: there is no half of it to return.
        let unhurried = Settings { watch: settings.watch.unhurried(), time: None, ..settings.clone() };
        Ok(Stepping { prepared: prepared.with_settings(&unhurried)? })
    }

    /// Number of dofs.
    pub fn dofs(&self) -> usize {
        self.prepared.dofs()
    }

    /// Solves with a force and gaps, from the set of the last step.
    pub fn solve(&self, force: Vec<f64>, gap: Vec<f64>, start: &ContactSet) -> Result<Found, Error> {
        let boundary = self.prepared.with_load(force)?.starting_from(start).step(&gap)?;
        let change = boundary.displacement();
        Ok(Found { change, multiplier: boundary.multiplier, contact_set: boundary.contact_set })
    }

    /// The change that a force alone causes, as if no row were closed; `None` without a factor of the matrix.
    pub fn response(&self, force: Vec<f64>) -> Result<Option<Vec<f64>>, Error> {
        Ok(self.prepared.with_load(force)?.response())
    }

    /// The change of the displacement alone; certified only where the method did not settle on a set.
    pub fn change(&self, force: Vec<f64>, gap: Vec<f64>, start: &ContactSet) -> Result<Vec<f64>, Error> {
        let at_step = self.prepared.with_load(force)?.starting_from(start);
        match at_step.settled(&gap)? {
            Some(change) => Ok(change),
            None => Ok(at_step.step(&gap)?.displacement()),
        }
    }
}

/// `a + factor b`, entry by entry.
pub(super) fn plus(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}
