//! Solves small contact problems in exact arithmetic, and compares the program's answers with the exact ones.
//!
//! Doubles are taken as exact rational numbers. `solve` decides every problem: solved (and whether the displacement is
//! unique), infeasible, unbounded, or not convex. Each verdict is verified in the original data before it is returned.

pub mod case;
pub mod complementarity;
pub mod dyadic;
mod evidence;
pub mod judge;
pub mod kinks;
mod lemke;
mod loads;
pub mod measure;
pub mod problem;
pub mod rows;
pub mod solve;
pub mod stiffness;
pub mod table;
mod tableau;
pub mod trial;
mod units;

use crate::draws::Draws;
