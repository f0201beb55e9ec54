//! Multigrid, MPRGP, the bound without a factor, and the choice between factor and multigrid.

mod cycle_bound;
mod mortar;
mod mprgp;
mod multigrid;
mod near_null_files;
mod oblique;
mod obstacle;
mod pressed;
mod room;
mod stiffness;
