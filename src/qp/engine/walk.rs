//! The path of an answer while its gaps move, as an engine finds it.

use std::fmt::Debug;
use std::sync::Arc;

use crate::qp::method::parametric::{Event, Piece};
use crate::solution::ContactSet;

/// The way back from the unknowns of an engine to the rows of the problem.
pub(super) trait Expansion: Debug + Send + Sync {
    /// One multiplier for each row of the problem.
    fn multiplier(&self, reduced: &[f64]) -> Vec<f64>;

    /// The set of the rows of the problem.
    fn contact_set(&self, reduced: &ContactSet) -> ContactSet;
}

/// The stretches of a path as an engine finds them, and the events at which rows touch and release.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    pub pieces: Vec<Piece>,
    pub events: Vec<Event>,
    pub to_rows: Arc<dyn Expansion>,
}
