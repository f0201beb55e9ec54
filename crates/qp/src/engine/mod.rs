//! Engines: a problem prepared once, for many gaps, loads and starts. One engine has a factor of the stiffness, the
//! other a multigrid hierarchy. An engine makes the steps that a ladder asks for, and judges nothing.

mod factored;
mod found;
mod loading;
mod multigrid;
mod preparation;
mod step;

use std::sync::Arc;

use crate::certificate::Bounding;
use crate::error::Error;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::method::Outcome;
use crate::plan::{Means, Step, Tried};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{ContactSet, Seconds};
pub(super) use factored::Factored;
pub(super) use found::{Reduced, balanced, displacement, on_boundary, response, settled, walk};
pub(super) use loading::Load;
pub(super) use multigrid::Hierarchical;
pub(super) use preparation::factored;
pub(super) use step::Task;

/// A problem prepared once for many gaps, loads and starts.
#[derive(Clone, Debug)]
pub(crate) enum Engine {
    Factor(Arc<Factored>),
    /// The levels of a multigrid hierarchy.
    Levels(Arc<Hierarchical>),
}

impl Engine {
    /// The engine with these means, under the settings of an attempt; `None` for the problem alone.
    pub fn new(means: Means, problem: &ContactProblem, settings: &Settings) -> Result<Option<Self>, Error> {
        Ok(match means {
            Means::Problem => None,
            Means::Multigrid => Some(Engine::Levels(Arc::new(Hierarchical::new(problem, settings)?))),
            Means::Factor => Some(Engine::Factor(Arc::new(factored(problem, settings)?))),
        })
    }

    pub fn means(&self) -> Means {
        match self {
            Engine::Factor(_) => Means::Factor,
            Engine::Levels(_) => Means::Multigrid,
        }
    }

    pub fn factor(&self) -> Option<&Arc<Factored>> {
        if let Engine::Factor(factored) = self { Some(factored) } else { None }
    }

    pub fn hierarchy(&self) -> Option<&Multigrid> {
        if let Engine::Levels(levels) = self { Some(&levels.multigrid) } else { None }
    }

    /// The seconds that the preparation took, part by part.
    pub fn seconds(&self) -> Seconds {
        match self {
            Engine::Factor(factored) => factored.seconds,
            Engine::Levels(levels) => levels.seconds,
        }
    }

    /// The method of an attempt, and its unknowns.
    pub fn tried(&self, method: Method) -> Tried {
        match self {
            Engine::Factor(factored) => factored.tried(method),
            Engine::Levels(levels) => levels.tried(),
        }
    }

    /// Makes a step: what it found, in terms of the whole problem, and the seconds of its factors; `None` if the step
    /// has no means here.
    pub fn make(&self, task: &Task) -> Result<Option<(Outcome, f64)>, Error> {
        Ok(match (self, task.step, task.best) {
            (Engine::Levels(levels), ..) => Some((levels.solve(task)?, 0.0)),
            (Engine::Factor(factored), Step::Refinement, Some(best)) => found::refined(factored, task, best),
            (Engine::Factor(factored), Step::Repair, Some(best)) => found::repaired(factored, task, best),
            (_, Step::Refinement | Step::Repair, None) => None,
            (Engine::Factor(factored), ..) => found::find(factored, task)?.map(|found| found::whole(factored, found)),
        })
    }

    /// The means of a certificate, with bounds that end when `watch` says so.
    pub fn bounding(&self, watch: &Watch) -> Bounding<'_> {
        match self {
            Engine::Factor(factored) => factored.bounding(watch),
            Engine::Levels(levels) => Bounding::Cycles(&levels.multigrid, watch.clone()),
        }
    }

    /// Bytes of the prepared data, estimated.
    pub fn bytes(&self) -> f64 {
        match self {
            Engine::Factor(factored) => factored.bytes(),
            Engine::Levels(levels) => levels.bytes(),
        }
    }

    /// Estimated seconds of a proof of the open and closed rows.
    pub fn proof_seconds(&self) -> f64 {
        self.factor().map_or(0.0, |factored| factored.proof_seconds)
    }

    /// Displacement and multiplier under `load` (length n) with the rows of `closed` held at `gap` (one entry per row),
    /// pushing or pulling, and all others free; `None` if these rows do not hold the body, or contradict each other.
    pub fn held(
        &self,
        closed: &ContactSet,
        load: &[f64],
        gap: &[f64],
        watch: &Watch,
    ) -> Result<Option<[Vec<f64>; 2]>, Error> {
        match self {
            Engine::Factor(factored) => Ok(balanced(factored, closed, load, gap)),
            Engine::Levels(levels) => levels.held(closed, load, gap, watch),
        }
    }
}
