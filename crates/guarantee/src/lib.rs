//! The guaranteed error against the continuum, in the plane and in space: from a displacement that stays out of the
//! obstacles between nodes too, a stress in balance, and the difference of their energies.
//!
//! ```
//! use signorini_guarantee::Linear;
//! // Loads are linear on each side of a body: the pressure of water of weight 2 above the bottom of a tank, at y = -3.
//! let pressure = Linear::of(|[_, y, _]| -2.0 * y);
//! assert_eq!(pressure.at([5.0, -3.0, 0.0]), 6.0);
//! ```
//!
//! The hidden modules are for the crates of this workspace.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(clippy::missing_errors_doc, reason = "the sentence of an error says what is wrong")]

mod answer;
mod axis;
mod balance;
#[cfg(test)]
mod bodies;
#[doc(hidden)]
mod bound;
mod check;
mod displacement;
mod error;
#[doc(hidden)]
mod fans;
mod force;
mod integration;
mod johnson_mercier;
#[cfg(test)]
mod keys;
#[doc(hidden)]
mod mesh;
mod normal;
mod part_stress;
#[doc(hidden)]
mod problem;
mod seams;
#[doc(hidden)]
mod simplex;
mod stress;
mod system;
#[cfg(test)]
mod two_bodies;

pub use answer::ContinuumAnswer;
#[doc(hidden)]
pub use answer::{Judged, Strain};
#[doc(hidden)]
pub use bound::Bracket;
pub use error::Error;
#[doc(hidden)]
pub use fans::{SAME_PLACE, Unjoined};
#[doc(hidden)]
pub use mesh::{Cells, SimplexMesh};
#[doc(hidden)]
pub use problem::{
    Circle, Condition, ContinuumProblem, Distance, Enclosure, Facing, Held, Linear, Medium, Pressed, RigidFace, Surface,
};
#[doc(hidden)]
pub use simplex::{Point, pairs};
