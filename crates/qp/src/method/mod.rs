//! The methods: each takes a scaled problem and returns displacement, multiplier, contact set and history.
//!
//! No module here uses the notion of a body: the terms are those of the QP.

pub mod active_set;
mod bounds;
pub mod dual_active_set;
pub mod interior_point;
pub mod mprgp;
pub mod parametric;
pub mod penalty;
mod scaled;
mod start;
mod support;

pub(crate) use scaled::SIGN_TOLERANCE;
pub use scaled::{Ending, Outcome, ScaledProblem};
pub use start::Start;
