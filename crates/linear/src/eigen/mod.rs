//! Parts of the search for eigenvalues: a Krylov space, sweeps of several columns, and the count of negative
//! eigenvalues.

mod inertia;
mod krylov;
mod lanes;

pub use inertia::negative_eigenvalues;
pub use krylov::{Krylov, Pairs};
pub use lanes::{LANES, Lanes};
