//! Transforms of a contact problem into one that is easier to solve, each with its way back.

mod rows;
mod scaling;

pub use rows::RowSelection;
pub use scaling::Scaling;
