//! What a method found, on its way to a whole answer.

use std::sync::Arc;

use super::loading::Loading;
use crate::qp::method::Outcome;
use crate::qp::problem::ContactProblem;
use crate::solution::Seconds;

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

/// What refinement has done so far.
#[derive(Clone, Debug)]
pub(super) struct Refined {
    /// The displacement before the last step, length n.
    pub base: Vec<f64>,
    /// The largest measured contraction.
    pub contraction: f64,
    /// Steps after the first answer.
    pub steps: usize,
}
