//! Motion: schemes compared with closed forms, the command, refused input.

mod bounce;
mod driven;
mod fox_goodwin;
mod impact;
mod impact_command;
mod impact_errors;
mod peaks;
mod penalty_loop;
mod reactions;
mod symmetry;
mod trust;
mod watch;
