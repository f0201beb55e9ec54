//! Carries out a ladder: one loop makes the steps that the plan names, judges the answer of each once, keeps the best,
//! and records them all.

mod carried_out;
mod elimination;
mod ending;
mod pieces;
mod proximal;

pub use carried_out::solved;
pub(super) use carried_out::{Run, Workbench, check_rows, engine_by};
pub(super) use elimination::KeptRest;
