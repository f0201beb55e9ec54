//! signorini
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod analytical;
pub mod assembly;
pub mod body;
pub mod element;
pub mod error;
pub mod material;
pub mod mesh;
pub mod problem;
pub mod recovery;
pub mod scene;
pub mod solution;
pub mod sparse;

pub use error::Error;
pub use problem::ContactProblem;
pub use scene::{Model, Scene};
pub use solution::{Certificate, ContactSet, Solution};
