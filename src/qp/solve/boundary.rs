//! The answer on the contact boundary alone: contact set, multipliers and forces, without the displacement of the body.

use std::sync::Arc;

use super::loading::Loading;
use super::refinement::Refined;
use super::{Prepared, Settings};
use crate::error::Error;
use crate::qp::method::Outcome;
use crate::qp::problem::ContactProblem;
use crate::solution::{Certificate, ContactSet, Seconds, Solution};

/// What a prepared problem says of its contact boundary at some gap and load.
///
/// The multipliers are those of the whole answer. Nothing in it costs a sweep through the factor of the body, unless it
/// is asked for: [`displacement`](Self::displacement) takes one, [`solution`](Self::solution) two.
#[derive(Clone, Debug)]
pub struct BoundarySolution<'a> {
    /// Contact multiplier lambda, one entry per contact row, in the problem's unit of force, `<= 0` in compression.
    pub multiplier: Vec<f64>,
    /// The closed rows.
    pub contact_set: ContactSet,
    /// Iterations of the method.
    pub iterations: usize,
    /// The certificate of the *condensed* problem, in its dimensionless units: its conditions are recomputed from the
    /// condensed stiffness, load and rows, not from the problem itself. That takes the displacement of the body.
    pub condensed_certificate: Certificate,
    pub(super) prepared: &'a Prepared,
    pub(super) found: Found,
}

/// What a method found, with the load and the gaps that it was found for.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub loading: Arc<Loading>,
    pub gap: Vec<f64>,
    /// The problem that the method worked on.
    pub problem: ContactProblem,
    pub unit: i32,
    pub outcome: Outcome,
    pub seconds: Seconds,
    /// Where the factor is in single precision.
    pub refined: Option<Refined>,
}

impl BoundarySolution<'_> {
    /// Total contact force `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        -self.multiplier.iter().sum::<f64>()
    }

    /// The displacement u of the whole body, one entry per dof, in the problem's unit of length; not certified.
    pub fn displacement(&self) -> Vec<f64> {
        self.prepared.displacement(&self.found)
    }

    /// The whole answer, with the certificate of the problem itself.
    ///
    /// # Errors
    /// [`Error::NotCertified`] and [`Error::Infeasible`], as [`solve`](super::solve).
    pub fn solution(self, settings: &Settings) -> Result<Solution, Error> {
        self.prepared.complete(self.found, settings)
    }
}
