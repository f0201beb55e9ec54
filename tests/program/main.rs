//! The program: its command line, its limits, its process, and its decisions.

mod answers;
mod auto;
mod blocks;
mod drop_in;
mod drop_in_steps;
mod exit_codes;
mod files_read;
mod guarantees;
mod habits;
mod limits;
mod memory;
mod motion_runs;
mod new;
mod plan;
mod process;
mod promised;
mod schema;
mod terminal;
mod time;
mod total_error;
mod total_error_about_axis;
mod total_error_of_loads;
mod tradeoff;
mod tutorial;
mod verify;
mod warnings;
