//! The program: its command line, its limits, its process, the choices that it makes.

#[path = "../support/program.rs"]
mod program;

mod auto;
mod command_line;
mod kept_limits;
mod limits;
mod process;
mod tradeoff;
