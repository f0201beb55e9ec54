//! The guaranteed error against the continuum, in the plane: from a displacement that stays out of the obstacles between nodes too, a
//! stress in balance, and the difference of their energies.

mod answer;
mod bound;
mod check;
mod displacement;
mod force;
mod johnson_mercier;
mod judge;
mod problem;
mod stress;
mod system;
mod triangulation;

pub use answer::PlaneAnswer;
pub use bound::Bracket;
pub use judge::Judged;
pub use problem::{Circle, Condition, Distance, Enclosure, Facing, PlaneProblem};
pub use triangulation::{Point, Triangulation};
