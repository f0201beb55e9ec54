//! Multigrid, MPRGP, the bound without a factor, and the choice between factor and multigrid.

#[path = "../support/bodies.rs"]
mod bodies;
#[path = "../support/oracles/mod.rs"]
mod oracles;
#[path = "../support/program.rs"]
mod program;

mod cycle_bound;
mod mprgp;
mod multigrid;
mod near_null_files;
mod obstacle;
mod pressed;
mod room;
