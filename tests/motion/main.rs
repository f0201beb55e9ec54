//! Motion: schemes against closed forms, the command, what is refused.

#[path = "../support/program.rs"]
mod program;

mod bounce;
mod impact;
mod impact_command;
mod impact_errors;
