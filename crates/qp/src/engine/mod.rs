//! Engines: a problem prepared once, for many gaps, loads and starts. One engine has a factor of the stiffness, the
//! other a multigrid hierarchy. An engine makes the steps that a ladder asks for, and judges nothing.

mod factored;
mod found;
mod preparation;

use std::sync::Arc;
use std::time::Instant;

use crate::certificate::Bounding;
use crate::cost::{Kept, NEAR_CYCLES, bytes, check_memory, check_time, seconds};
use crate::error::{Error, Result};
use crate::linear::multigrid::{Multigrid, NearNullSpace};
use crate::linear::threads_of_machine;
use crate::linear::watch::Watch;
use crate::method::mprgp::{Limits, Mprgp, takes_travels};
use crate::method::{Outcome, Start};
use crate::plan::{Step, Tried};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{ContactSet, Seconds};
pub(super) use factored::{Factored, Load};
pub(super) use found::{Reduced, Task, balanced, displacement, on_boundary, response, settled, walk};
pub(super) use preparation::factored;

#[derive(Clone, Debug)]
pub enum Engine {
    Factor(Arc<Factored>),
    Levels(Arc<Hierarchical>),
}

impl Engine {
    pub fn factor(&self) -> Option<&Arc<Factored>> {
        if let Engine::Factor(factored) = self { Some(factored) } else { None }
    }

    pub fn hierarchy(&self) -> Option<&Multigrid> {
        if let Engine::Levels(levels) = self { Some(&levels.multigrid) } else { None }
    }

    pub fn seconds(&self) -> Seconds {
        match self {
            Engine::Factor(factored) => factored.seconds,
            Engine::Levels(levels) => levels.seconds,
        }
    }

    pub fn tried(&self, method: Method) -> Tried {
        match self {
            Engine::Factor(factored) => Tried { method: factored.chosen(method), ..factored.tried },
            Engine::Levels(levels) => {
                Tried { method: Method::Mprgp, is_singular: levels.multigrid.is_shifted(), ..Tried::default() }
            }
        }
    }

    /// Makes a step: what it found for the whole problem, and the seconds of its factors; `None` without means.
    pub fn make(&self, task: &Task) -> Result<Option<(Outcome, f64)>> {
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

    pub fn bytes(&self) -> f64 {
        match self {
            Engine::Factor(factored) => factored.bytes(),
            Engine::Levels(levels) => {
                let problem = &levels.problem;
                bytes::of_hierarchy(problem.dofs() as f64, problem.stiffness().entries() as f64)
            }
        }
    }

    pub fn proof_seconds(&self) -> f64 {
        self.factor().map_or(0.0, |factored| factored.proof_seconds)
    }

    /// Displacement and multiplier under `load` (length n) with the rows of `closed` held at `gap` (one entry per row),
    /// pushing or pulling, and all others free; `None` if these rows do not hold the body, or contradict each other.
    pub fn held(&self, closed: &ContactSet, load: &[f64], gap: &[f64], watch: &Watch) -> Result<Option<[Vec<f64>; 2]>> {
        match self {
            Engine::Factor(factored) => Ok(balanced(factored, closed, load, gap)),
            Engine::Levels(levels) => levels.held(closed, load, gap, watch),
        }
    }
}

/// With fewer dofs a second thread costs about what it saves.
const WORTH_THREADS: usize = 50_000;

/// A start for another method ends at this relative imbalance of forces.
const NEAR: f64 = 1e-4;

/// Relative imbalance of forces at which a balance with held rows ends.
const HELD: f64 = 1e-11;

/// Largest number of cycles of a balance with held rows.
const MOST_HELD_CYCLES: usize = 400;

/// A contact problem with the multigrid hierarchy of its stiffness: built once, for all gaps, loads and starts.
///
/// Nothing is scaled here: the hierarchy gives each node a unit, in which MPRGP compares relative quantities. The bound
/// on the energy error takes a few more cycles; it rests on a measured eigenvalue, as its certificates say.
#[derive(Debug)]
pub struct Hierarchical {
    problem: ContactProblem,
    pub multigrid: Multigrid,
    pub seconds: Seconds,
}

impl Hierarchical {
    /// Builds the hierarchy from the near-null space of `problem`, or from constants if it has none.
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self> {
        let Settings { watch, threads, .. } = settings;
        if watch.acknowledge() {
            return Err(Error::Interrupted);
        }
        if !takes_travels(problem) {
            let dof = problem.without_stiffness().first().copied().unwrap_or_default();
            return Err(Error::without_hierarchy(dof));
        }
        check_memory(problem, Kept::Multigrid, settings.memory)?;
        seconds::learn(watch);
        let entries = problem.stiffness().lower().entries();
        let estimate = seconds::hierarchy(problem.dofs() as f64, entries as f64);
        check_time(watch, estimate + seconds::certificate(problem))?;
        watch.step("multigrid hierarchy", 0);
        let clock = Instant::now();
        let threads = threads.unwrap_or_else(|| if problem.dofs() < WORTH_THREADS { 1 } else { threads_of_machine() });
        let multigrid = watch.timed(estimate, || match problem.near_null() {
            Some(near_null) => Multigrid::new(problem.stiffness(), near_null, threads),
            None => Multigrid::new(problem.stiffness(), &NearNullSpace::constants(problem.stiffness())?, threads),
        })?;
        let of_all = clock.elapsed().as_secs_f64();
        let seconds = Seconds { factor: of_all, solve: of_all, ..Seconds::default() };
        Ok(Hierarchical { problem: problem.clone(), multigrid, seconds })
    }

    pub fn solve(&self, task: &Task) -> Result<Outcome> {
        let Task { problem, limits, settings, .. } = *task;
        // Once the loop ends, its answer is still to be certified.
        let watch = &settings.watch.keeping(seconds::certificate(problem));
        Mprgp { problem, multigrid: &self.multigrid, limits, watch }.solve(task.start.clone())
    }

    /// As [`Engine::held`](super::Engine::held): the held rows are pairs of opposed rows, bounds that are equal.
    pub fn held(&self, closed: &ContactSet, load: &[f64], gap: &[f64], watch: &Watch) -> Result<Option<[Vec<f64>; 2]>> {
        let rows: Vec<usize> = closed.iter().collect();
        let problem = &self.problem.with_held(load.to_vec(), [&[], &rows], gap)?;
        let limits = Limits { most_cycles: MOST_HELD_CYCLES, ..Limits::to(HELD) };
        let outcome = Mprgp { problem, multigrid: &self.multigrid, limits, watch }.solve(Start::default())?;
        if !outcome.is_settled() {
            return Ok(None);
        }
        let [_, forces] = problem.split(outcome.multiplier);
        let mut multiplier = vec![0.0; self.problem.rows()];
        rows.iter().zip(forces).for_each(|(&row, force)| multiplier[row] = force);
        Ok(Some([outcome.displacement, multiplier]))
    }

    /// A contact set near that of the answer; `None` if the method meets a difficulty that another method must treat.
    pub fn near(&self, watch: &Watch) -> Option<Start> {
        let most_cycles = NEAR_CYCLES as usize;
        let limits = Limits { most_cycles, ..Limits::to(NEAR) };
        let mprgp = Mprgp { problem: &self.problem, multigrid: &self.multigrid, limits, watch };
        Some(mprgp.solve(Start::default()).ok()?.contact_set.into())
    }
}
