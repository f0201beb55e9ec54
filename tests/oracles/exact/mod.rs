//! Small contact problems solved in exact arithmetic, and the program's answers held against them.
//!
//! Doubles are taken as the rationals that they are. `solve` decides every problem: solved (and whether the displacement is
//! unique), infeasible, unbounded, or not convex; each verdict is verified in the original data before it is returned.
#![allow(dead_code)]

mod case;
mod dyadic;
mod judge;
mod lemke;
mod loads;
mod measure;
mod rows;
mod solve;
mod stiffness;
mod table;
mod tableau;
mod trial;

pub use judge::Fault;
pub use stiffness::KINDS;
pub use table::Table;
pub use trial::{Trial, draw};

use super::draws::Draws;
