//! Closed-form contact solutions, with which answers are compared: bars and blocks, Hertz contacts, punches, obstacle
//! problems, bars in impact, and bodies whose displacement is known at every point.

mod bar;
mod hertz;
mod impact;
pub mod manufactured;
mod obstacle_problem;
mod patch;
mod punch;

pub use bar::Bar;
pub use hertz::{LineContact, PointContact};
pub use impact::{BouncingBar, ImpactingBar};
pub use obstacle_problem::{DiscMembrane, ObstacleString};
pub use patch::{ContactPatch, Sides};
pub use punch::{Cone, FlatDisc, FlatStrip, Wedge};
