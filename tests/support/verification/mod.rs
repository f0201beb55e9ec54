//! Classical problems, each with the answer of the program and the exact one.

pub mod answer;
pub mod closed_forms;
pub mod contact_patch;
pub mod punches;
pub mod reference_errors;
pub mod round_bodies;
