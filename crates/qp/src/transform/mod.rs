//! Transforms of a contact problem into one that is easier to solve, each with its inverse transform.

mod condensation;
mod elimination;
mod pieces;
mod rows;
mod scaling;

pub use condensation::Condensation;
pub use elimination::Elimination;
pub use pieces::Pieces;
pub use rows::RowSelection;
pub use scaling::Scaling;
