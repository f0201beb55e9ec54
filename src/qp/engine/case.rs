//! What an engine is asked for, and what it answers: all that [`Prepared`](super::Prepared) knows of it.

use std::fmt::Debug;
use std::sync::Arc;

use super::boundary::BoundarySolution;
use super::loading::Load;
use super::walk::Walk;
use crate::error::Error;
use crate::qp::linear::multigrid::Multigrid;
use crate::qp::method::Start;
use crate::qp::plan::Tried;
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{Method, Settings};
use crate::solution::{Seconds, Solution};

/// What an engine is asked for.
pub(super) struct Case<'a> {
    pub load: &'a Load,
    /// Gaps, one entry per row.
    pub gap: &'a [f64],
    pub start: &'a Start,
    /// Settings whose clock runs.
    pub settings: &'a Settings,
    /// The same as they were given: what is asked for later has the time anew.
    pub given: &'a Settings,
    /// Whether an answer on the boundary needs a bound on its error; without one its conditions alone are held against the
    /// tolerance, which costs no triangular solve.
    pub is_bounded: bool,
}

/// The factor of an engine.
pub(super) struct FactorSize {
    /// Unknowns that the methods work on.
    pub unknowns: usize,
    /// Values of the factor; zero if the methods factorise by themselves.
    pub entries: usize,
    pub multiplications: f64,
    /// `true` if its values are in single precision.
    pub is_single: bool,
}

/// A problem prepared once for many gaps, loads and starts. What an engine has no means for keeps its default.
pub(super) trait Engine: Debug + Send + Sync {
    /// The problem as it came.
    fn problem(&self) -> &ContactProblem;

    /// Returns `true` if `method` works on what was prepared.
    fn serves(&self, method: Method) -> bool;

    /// What the preparation cost.
    fn seconds(&self) -> Seconds;

    /// What a solve with `settings` tries here.
    fn tried(&self, settings: &Settings) -> Tried;

    /// The whole answer, certified.
    ///
    /// # Errors
    /// As [`Prepared::solve`](super::Prepared::solve).
    fn solve(&self, case: &Case) -> Result<Solution, Error>;

    /// The answer on the contact boundary.
    ///
    /// # Errors
    /// As [`Prepared::boundary`](super::Prepared::boundary).
    fn boundary(self: Arc<Self>, case: &Case) -> Result<BoundarySolution, Error> {
        Ok(self.solve(case)?.into())
    }

    /// The displacement without a certificate; `None` if the method did not settle on a set, or only a certified answer is known
    /// to be one.
    ///
    /// # Errors
    /// As [`Engine::boundary`].
    fn settled(&self, _case: &Case) -> Result<Option<Vec<f64>>, Error> {
        Ok(None)
    }

    /// The displacement that a load causes if no row is closed; `None` without a factor of a definite stiffness.
    fn response(&self, _load: &Load) -> Option<Vec<f64>> {
        None
    }

    /// A contact set near that of the answer, at a small part of its cost.
    fn near(&self, _settings: &Settings) -> Option<Start> {
        None
    }

    /// The exact way from a case to the gaps `to`.
    ///
    /// # Errors
    /// As [`Prepared::path`](super::Prepared::path).
    fn walk(self: Arc<Self>, _from: &Case, _to: &[f64]) -> Result<Walk, Error> {
        Err(Error::NotCondensed { step: "the exact path" })
    }

    /// The factor, if there is one.
    fn factor(&self) -> Option<FactorSize> {
        None
    }

    /// The multigrid hierarchy, if there is one.
    fn hierarchy(&self) -> Option<&Multigrid> {
        None
    }
}
