//! The command-line program: see `signorini --help`.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    signorini::cli::run(std::env::args_os())
}
