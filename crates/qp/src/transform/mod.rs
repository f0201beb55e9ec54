//! Transforms of a contact problem into one that is easier to solve, each with its inverse transform.

mod condensation;
mod pieces;
mod rows;
mod scaling;

pub use condensation::Condensation;
pub(crate) use condensation::FEW_VALUES;
pub use pieces::Pieces;
pub use rows::RowSelection;
pub use scaling::Scaling;
