//! Parts of the search for eigenvalues: a Krylov space, and the count of negative eigenvalues.

mod inertia;
mod krylov;

pub use inertia::negative_eigenvalues;
pub use krylov::{Krylov, Pairs};
