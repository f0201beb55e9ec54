//! The program: its command line, its limits, its process, and its decisions.
#![expect(clippy::too_many_lines, reason = "tables of cases")]

mod answers;
mod auto;
mod blocks;
mod drop_in;
mod drop_in_references;
mod drop_in_steps;
mod exit_codes;
mod files_read;
mod guarantees;
mod habits;
mod lcp;
mod limits;
mod memory;
mod motion_runs;
mod new;
mod plan;
mod process;
mod promised;
mod schema;
mod sensitivity;
mod terminal;
mod time;
mod total_error;
mod total_error_about_axis;
mod total_error_estimated;
mod total_error_of_loads;
mod total_error_of_ties;
mod tradeoff;
mod tutorial;
mod verify;
mod warnings;
