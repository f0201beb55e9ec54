//! The method without a factorisation of the body: one multigrid hierarchy, MPRGP, the certificate.

use std::time::Instant;

use super::step::Task;
use crate::cost::{Kept, NEAR_CYCLES, bytes, check_memory, check_time, seconds};
use crate::error::Error;
use crate::linear::multigrid::{Multigrid, NearNullSpace};
use crate::linear::threads_of_machine;
use crate::linear::watch::Watch;
use crate::method::Outcome;
use crate::method::Start;
use crate::method::mprgp::{Limits, Mprgp, takes_travels};
use crate::plan::Tried;
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{ContactSet, Seconds};

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
pub(crate) struct Hierarchical {
    problem: ContactProblem,
    pub multigrid: Multigrid,
    pub(super) seconds: Seconds,
}

impl Hierarchical {
    /// Builds the hierarchy from the near-null space of `problem`, or from constants if it has none.
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
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

    pub(super) fn tried(&self) -> Tried {
        Tried { method: Method::Mprgp, is_singular: self.multigrid.is_shifted(), ..Tried::default() }
    }

    pub(super) fn solve(&self, task: &Task) -> Result<Outcome, Error> {
        let Task { problem, limits, settings, .. } = *task;
        // Once the loop ends, its answer is still to be certified.
        let watch = &settings.watch.keeping(seconds::certificate(problem));
        Mprgp { problem, multigrid: &self.multigrid, limits, watch }.solve(task.start.clone())
    }

    /// As [`Engine::held`](super::Engine::held): the held rows are pairs of opposed rows, bounds that are equal.
    pub(super) fn held(
        &self,
        closed: &ContactSet,
        load: &[f64],
        gap: &[f64],
        watch: &Watch,
    ) -> Result<Option<[Vec<f64>; 2]>, Error> {
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

    pub(super) fn bytes(&self) -> f64 {
        bytes::of_hierarchy(self.problem.dofs() as f64, self.problem.stiffness().entries() as f64)
    }

    /// A contact set near that of the answer; `None` if the method meets a difficulty that another method must treat.
    pub fn near(&self, watch: &Watch) -> Option<Start> {
        let most_cycles = NEAR_CYCLES as usize;
        let limits = Limits { most_cycles, ..Limits::to(NEAR) };
        let mprgp = Mprgp { problem: &self.problem, multigrid: &self.multigrid, limits, watch };
        Some(mprgp.solve(Start::default()).ok()?.contact_set.into())
    }
}
