//! The result of a method, before the whole answer is made from it.

use std::sync::Arc;

use super::loading::Loading;
use crate::qp::method::Outcome;
use crate::qp::problem::ContactProblem;
use crate::solution::Seconds;

/// The result of a method, with its load and gaps.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub loading: Arc<Loading>,
    pub gap: Vec<f64>,
    /// The problem that the method worked on.
    pub problem: ContactProblem,
    pub unit: i32,
    pub outcome: Outcome,
    pub seconds: Seconds,
    /// State of the refinement, if the factor is in single precision.
    pub refined: Option<Refined>,
}

/// State of the refinement so far.
#[derive(Clone, Debug)]
pub(super) struct Refined {
    /// The displacement before the last step, length n.
    pub base: Vec<f64>,
    /// The largest measured contraction.
    pub contraction: f64,
    /// Steps after the first answer.
    pub steps: usize,
}
