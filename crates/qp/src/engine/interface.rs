//! What an engine is asked, and what it answers.

use std::fmt::Debug;
use std::sync::Arc;

use super::loading::Load;
use crate::certificate::Bounding;
use crate::error::Error;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::method::parametric::{Event, Piece};
use crate::method::{Outcome, Start};
use crate::plan::{Limits, Means, Step, Tried};
use crate::problem::ContactProblem;
use crate::settings::{ByFactor, Settings};
use crate::solution::{Certificate, ContactSet, Seconds, Solution};

/// A step that an engine is to make.
pub(crate) struct Task<'a> {
    pub step: Step,
    /// The problem under some load, at some gaps.
    pub problem: &'a ContactProblem,
    pub load: &'a Load,
    pub start: &'a Start,
    pub limits: Limits,
    /// The method, if the attempt names it; `None` for the one that the rules chose, or the only one.
    pub method: Option<ByFactor>,
    /// Accuracy, limits and a running clock; method and arrangement are those of the attempt.
    pub settings: &'a Settings,
    /// The best answer of the steps before this one; `None` without one.
    pub best: Option<&'a Solution>,
}

/// What a step found, in terms of the whole problem.
pub(crate) struct Found {
    pub outcome: Outcome,
    pub factor_seconds: f64,
}

/// The answer on the contact boundary, in terms of the whole problem, with the certificate of the condensed problem.
#[derive(Clone, Debug)]
pub(crate) struct OnBoundary {
    pub multiplier: Vec<f64>,
    pub contact_set: ContactSet,
    pub iterations: usize,
    pub condensed_certificate: Certificate,
    pub body: Arc<dyn Body>,
}

/// The body of an answer on its boundary.
pub(crate) trait Body: Debug + Send + Sync {
    /// The displacement of the whole body, not certified.
    fn displacement(&self) -> Vec<f64>;
}

/// The way back from the unknowns of an engine to the rows of the problem.
pub(crate) trait Expansion: Debug + Send + Sync {
    /// One multiplier for each row of the problem.
    fn multiplier(&self, reduced: &[f64]) -> Vec<f64>;

    /// The set of the rows of the problem.
    fn contact_set(&self, reduced: &ContactSet) -> ContactSet;
}

/// The stretches of a path as an engine finds them, and the events at which rows touch and release.
#[derive(Clone, Debug)]
pub(crate) struct Walk {
    pub pieces: Vec<Piece>,
    pub events: Vec<Event>,
    pub to_rows: Arc<dyn Expansion>,
}

/// A problem prepared once for many gaps, loads and starts. A function that an engine cannot provide keeps its default.
pub(crate) trait Engine: Debug + Send + Sync {
    /// Returns `true` if the prepared data are means of this kind.
    fn serves(&self, means: &Means) -> bool;

    /// The seconds that the preparation took, part by part.
    fn seconds(&self) -> Seconds;

    /// The method of an attempt, as in a [`Task`], and its unknowns.
    fn tried(&self, method: Option<ByFactor>) -> Tried;

    /// Makes a step; `None` if the step has no means here.
    fn make(&self, task: &Task) -> Result<Option<Found>, Error>;

    /// The means of a certificate, with bounds that end when `watch` says so.
    fn bounding(&self, watch: &Watch) -> Bounding<'_>;

    /// Bytes of the prepared data, estimated.
    fn bytes(&self) -> f64;

    /// Estimated seconds of a proof of the open and closed rows.
    fn proof_seconds(&self) -> f64 {
        0.0
    }

    /// The answer on the contact boundary, if it meets the goal there; `is_bounded` if it needs a bound on its error.
    fn on_boundary(self: Arc<Self>, _task: &Task, _is_bounded: bool) -> Result<Option<OnBoundary>, Error> {
        Ok(None)
    }

    /// The displacement without a certificate; `None` if the method did not settle on a set, or if an answer of the
    /// method is only valid with a certificate.
    fn settled(&self, _task: &Task) -> Result<Option<Vec<f64>>, Error> {
        Ok(None)
    }

    /// The displacement that a load causes if no row is closed; `None` without a factor of a definite stiffness.
    fn response(&self, _load: &Load) -> Option<Vec<f64>> {
        None
    }

    /// The exact way from a task to the gaps `to`; `None` if the task has no answer on the boundary that meets its
    /// goal.
    fn walk(self: Arc<Self>, _from: &Task, _to: &[f64]) -> Result<Option<Walk>, Error> {
        Err(Error::NotCondensed { step: "the exact path" })
    }

    /// Displacement and multiplier under `load` (length n) with the rows of `closed` held at `gap` (one entry per row),
    /// pushing or pulling, and all others free; `None` if these rows do not hold the body, or contradict each other.
    fn held(
        &self,
        closed: &ContactSet,
        load: &[f64],
        gap: &[f64],
        watch: &Watch,
    ) -> Result<Option<[Vec<f64>; 2]>, Error>;

    /// Values of the factor; zero if the methods factorise by themselves.
    fn factor_entries(&self) -> usize {
        0
    }

    fn hierarchy(&self) -> Option<&Multigrid> {
        None
    }
}
