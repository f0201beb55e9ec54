//! The answer on the contact boundary alone: contact set, multipliers and forces, without the displacement of the body.

use std::fmt::Debug;
use std::sync::Arc;

use crate::error::Error;
use crate::solution::{Certificate, ContactSet, Solution};

/// The answer of a prepared problem on its contact boundary at some gap and load.
///
/// The multipliers are those of the whole answer. Nothing here costs a sweep through the factor of the body, unless it is asked
/// for: [`displacement`](Self::displacement) takes one, [`solution`](Self::solution) two.
#[derive(Clone, Debug)]
pub struct BoundarySolution {
    /// Contact multiplier lambda, one entry per contact row, in the problem's unit of force, `<= 0` in compression.
    pub multiplier: Vec<f64>,
    /// The closed rows.
    pub contact_set: ContactSet,
    /// Linear solves of the method, or its interior-point steps, as in [`Solution::iterations`].
    pub iterations: usize,
    /// The certificate of the *condensed* problem, in its dimensionless units: its conditions are recomputed from the condensed
    /// stiffness, load and rows, not from the problem itself, which would need the displacement of the body.
    pub condensed_certificate: Certificate,
    pub(super) inside: Arc<dyn Inside>,
}

/// The means to compute the answer inside the body.
pub(super) trait Inside: Debug + Send + Sync {
    /// The displacement of the whole body, not certified.
    fn displacement(&self) -> Vec<f64>;

    /// The whole answer, certified.
    ///
    /// # Errors
    /// As [`BoundarySolution::solution`].
    fn solution(&self) -> Result<Solution, Error>;
}

impl Inside for Solution {
    fn displacement(&self) -> Vec<f64> {
        self.displacement.clone()
    }

    fn solution(&self) -> Result<Solution, Error> {
        Ok(self.clone())
    }
}

impl BoundarySolution {
    /// Total contact force `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        -self.multiplier.iter().sum::<f64>()
    }

    /// The displacement u of the whole body, one entry per dof, in the problem's unit of length; not certified.
    pub fn displacement(&self) -> Vec<f64> {
        self.inside.displacement()
    }

    /// The whole answer, with the certificate of the problem itself.
    ///
    /// # Errors
    /// [`Error::NotCertified`] and [`Error::Infeasible`], as [`solve`](crate::solve()).
    pub fn solution(self) -> Result<Solution, Error> {
        self.inside.solution()
    }
}

impl From<Solution> for BoundarySolution {
    /// The boundary of an answer that was not condensed.
    fn from(solution: Solution) -> Self {
        BoundarySolution {
            multiplier: solution.multiplier.clone(),
            contact_set: solution.contact_set.clone(),
            iterations: solution.iterations,
            condensed_certificate: solution.certificate,
            inside: Arc::new(solution),
        }
    }
}
