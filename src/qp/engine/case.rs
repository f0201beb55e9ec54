//! The questions to an engine and its answers: all that [`Prepared`](super::Prepared) uses.

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

/// A question to an engine: gaps, load, start and settings.
pub(super) struct Case<'a> {
    pub load: &'a Load,
    /// Gaps, one entry per row.
    pub gap: &'a [f64],
    pub start: &'a Start,
    /// Settings with a running clock.
    pub settings: &'a Settings,
    /// The same settings as they were given: later questions start with the full time again.
    pub given: &'a Settings,
    /// `true` if an answer on the boundary needs a bound on its error; otherwise only its conditions are compared with the
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

/// A problem prepared once for many gaps, loads and starts. A function that an engine cannot provide keeps its default.
pub(super) trait Engine: Debug + Send + Sync {
    /// The problem as it came.
    fn problem(&self) -> &ContactProblem;

    /// Returns `true` if `method` works on the prepared data.
    fn serves(&self, method: Method) -> bool;

    /// The time of the preparation.
    fn seconds(&self) -> Seconds;

    /// The methods and means that a solve with `settings` tries here.
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

    /// The displacement without a certificate; `None` if the method did not settle on a set, or if an answer of the method is
    /// only valid with a certificate.
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

    /// A contact set near that of the answer, at a small part of the cost of the answer.
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
