//! Random damage to files, and random contact problems.

pub mod damage;
pub mod problem;
