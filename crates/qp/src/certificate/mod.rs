//! The certificate of an answer, recomputed from the problem by code that shares nothing with the methods.
//!
//! It recomputes the conditions of the solution, a bound on the error in energy, and the rows proven open or closed.
//! For a problem without a unique answer it recomputes the rows that contradict each other and the modes that nothing
//! holds.

mod bound;
mod conditions;
mod energy_norm;
mod infeasible;
mod mode;
mod pressed;
mod proof;
mod reach;
mod scales;
mod units;
mod verdict;

pub(crate) use conditions::{Bounding, Evidence, Examined};
pub(crate) use energy_norm::EnergyNorm;
pub(crate) use mode::{NullMode, Rounding};
pub(crate) use proof::WithEvidence;
