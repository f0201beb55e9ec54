//! Files that are read, with their faults, and files that are written.

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
