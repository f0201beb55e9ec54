//! Closed-form contact solutions, to hold answers against: bars and blocks, Hertz contacts, punches, obstacle problems,
//! and bodies whose displacement is known at every point.

mod bar;
mod hertz;
pub mod manufactured;
mod obstacle_problem;
mod patch;
mod punch;

pub use bar::Bar;
pub use hertz::{LineContact, PointContact};
pub use obstacle_problem::{DiscMembrane, ObstacleString};
pub use patch::{ContactPatch, Sides};
pub use punch::{Cone, FlatDisc, FlatStrip, Wedge};
