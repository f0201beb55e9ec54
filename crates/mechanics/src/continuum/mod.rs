//! The guaranteed error against the continuum, in the plane and in space: from a displacement that stays out of the
//! obstacles between nodes too, a stress in balance, and the difference of their energies.

mod answer;
mod axis;
mod balance;
#[cfg(test)]
mod bodies;
mod bound;
mod check;
mod displacement;
mod fans;
mod force;
mod integration;
mod johnson_mercier;
#[cfg(test)]
mod keys;
mod mesh;
mod normal;
mod part_stress;
mod problem;
mod seams;
mod simplex;
mod stress;
mod system;
#[cfg(test)]
mod two_bodies;

pub use answer::{ContinuumAnswer, Judged, Strain};
pub use bound::Bracket;
pub(crate) use fans::SAME_PLACE;
pub use fans::Unjoined;
pub use mesh::{Cells, SimplexMesh};
pub use problem::{
    Circle, Condition, ContinuumProblem, Distance, Enclosure, Facing, Held, Linear, Medium, Pressed, RigidFace, Surface,
};
pub use simplex::{Point, pairs};
