//! Carries out a ladder: one loop makes the steps that the plan names, judges the answer of each once, keeps the best,
//! and records them all.

mod carried_out;
mod door;
mod ending;
mod proximal;

pub use carried_out::solved;
pub(super) use carried_out::{KeptRest, Run, Workbench, answered, check_rows};
