//! Files that are read, with their faults, and files that are written.
#![expect(clippy::too_many_lines, reason = "tables of cases")]

mod along;
mod bad_input;
mod corpus;
mod drawn_answers;
mod drawn_bodies;
mod faults;
mod lcp;
mod matrix_market;
mod out_folder;
mod petsc;
mod petsc_faults;
