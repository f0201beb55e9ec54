//! Contact problems with the mass as matrix: initial accelerations, projected predictions, impulses.

use crate::error::Error;
use crate::motion::DynamicProblem;
use crate::motion::step::{Found, Stepping};
use crate::qp::Settings;
use crate::solution::ContactSet;

/// The mass of a motion, prepared with its contact rows.
#[derive(Debug)]
pub(super) struct MassProjection {
    stepping: Stepping,
}

impl MassProjection {
    pub fn new(problem: &DynamicProblem, settings: &Settings) -> Result<Self, Error> {
        Ok(MassProjection { stepping: Stepping::of(problem, problem.mass().clone(), settings)? })
    }

    /// The x with `M x = force + B' lambda` and `B x <= bound`.
    pub fn solve(&self, force: Vec<f64>, bound: Vec<f64>, start: &ContactSet) -> Result<Found, Error> {
        self.stepping.solve(force, bound, start)
    }

    /// The smallest x in the norm of the mass with `B x <= bound`; `None`, without a solve, if that is zero.
    pub fn smallest(&self, bound: Vec<f64>, start: &ContactSet) -> Result<Option<Found>, Error> {
        if bound.iter().all(|&bound| bound >= 0.0) {
            return Ok(None);
        }
        let rows = bound.iter().map(|&bound| bound < 0.0).collect::<Vec<_>>();
        let closed = ContactSet::from_fn(start.rows(), |row| rows[row]);
        let nothing = vec![0.0; self.stepping.dofs()];
        self.solve(nothing, bound, &closed).map(Some)
    }
}
