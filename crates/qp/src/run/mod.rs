//! Carries out a ladder: one loop makes the steps that the plan names, judges the answer of each once, keeps the best,
//! and records them all.

mod carried_out;
mod elimination;
mod ending;
mod pieces;
mod proximal;

pub(super) use carried_out::solve_any;
pub use carried_out::solved;
pub(super) use carried_out::{Run, Workbench, engine_by};
pub(super) use elimination::KeptRest;
