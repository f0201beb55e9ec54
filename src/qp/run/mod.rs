//! Carries out a ladder: one loop makes the steps that the plan names, judges the answer of each once, keeps the best, and records them
//! all.

mod by_attempt;
mod carried_out;
mod ending;
mod pieces;

pub(super) use by_attempt::engine_of;
pub(super) use carried_out::{Run, Workbench, solve_any, solved};
