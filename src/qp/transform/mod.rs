//! Transforms of a contact problem into one that is easier to solve, each with its way back.

mod condensation;
mod pieces;
mod rows;
mod scaling;

pub use condensation::Condensation;
pub use pieces::Pieces;
pub use rows::RowSelection;
pub use scaling::Scaling;
