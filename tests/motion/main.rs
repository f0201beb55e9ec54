//! Motion: schemes compared with closed forms, the command, refused input.

#[path = "../support/closed_forms/mod.rs"]
mod exact_solutions;
#[path = "../support/program.rs"]
mod program;

mod bounce;
mod impact;
mod impact_command;
mod impact_errors;
mod peaks;
mod penalty_loop;
mod reactions;
mod trust;
mod watch;
