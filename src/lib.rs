//! signorini
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod analytical;
pub mod assembly;
pub mod body;
pub mod cli;
pub mod element;
pub mod error;
pub mod formulation;
pub mod material;
pub mod matrix_market;
pub mod mesh;
pub mod method;
pub mod output;
pub mod problem;
pub mod recovery;
pub mod scene;
pub mod solution;
pub mod solve;
pub mod sparse;
pub mod study;
pub mod transform;

pub use error::Error;
pub use problem::ContactProblem;
pub use scene::{Model, Scene};
pub use solution::{Certificate, ContactSet, Solution};
pub use solve::{Method, Settings, solve, solve_qp};
pub use sparse::{SparseMatrix, SymmetricMatrix};
