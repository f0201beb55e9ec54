//! Files that are read, with their faults, and files that are written.

#[path = "../support/oracles/mod.rs"]
mod oracles;
#[path = "../support/output_fixture/mod.rs"]
mod output_fixture;
#[path = "../support/program.rs"]
mod program;

mod along;
mod bad_input;
mod corpus;
mod drawn_answers;
mod drawn_bodies;
mod faults;
mod matrix_market;
mod out_folder;
mod output_files;
mod output_pictures;
mod output_plots;
mod output_ticks;
mod petsc;
mod petsc_faults;
