//! signorini
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod error;
pub mod output;
pub mod problem;
pub mod solution;
pub mod sparse;

pub use error::Error;
pub use problem::ContactProblem;
pub use solution::{Certificate, ContactSet, Solution};
