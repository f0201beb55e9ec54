//! The command line: arguments in, text or JSON out, and one exit code for each kind of ending.

mod about;
mod along;
mod ccx;
mod compare;
mod complementarity;
mod draw;
mod dynamic;
mod export;
mod failure;
mod input;
mod interrupt;
mod line;
mod memory;
mod modes;
mod new;
mod options;
mod outcome;
mod progress;
mod sensitivity;
mod settings;
mod shell;
mod solve;
mod sweep;
mod total_error;
mod tradeoff;
mod usage;
mod verify;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::qp::Watch;
use crate::scene::Scene;
use failure::{failed, sentence};
use interrupt::{INTERRUPTED, Kept};
use options::{Arguments, Command};
use outcome::{Ending, Outcome, Pictures, warn};
use progress::Progress;
use usage::with_nearest_option;

/// Runs the program with `arguments`, of which the first is its name, prints its report, and returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let given: Vec<OsString> = ccx::named(arguments.into_iter().collect());
    let arguments = match Arguments::try_parse_from(&given) {
        Ok(arguments) => arguments,
        Err(help) => {
            let help = with_nearest_option(help, &given);
            // With a closed pipe there is no reader for an error.
            let _ = help.print();
            return ExitCode::from(help.exit_code() as u8);
        }
    };
    let watch = if arguments.progress { progress::printed() } else { Watch::default() };
    let kept = Kept::default();
    interrupt::listen(&watch, &kept);
    watch.step("assembly", 0);
    if let Some(threads) = arguments.command.threads() {
        crate::fem::limit_threads(threads);
    }
    let line = || (!arguments.progress && !arguments.quiet).then(|| Progress::of(&watch));
    let shown = line();
    let format = arguments.command.format();
    let outcome = match arguments.command {
        Command::Solve(options) => solve::run(&options, &watch, &kept),
        Command::Compare(options) => compare::run(&options, &watch),
        Command::Sweep(options) => sweep::run(&options, &watch),
        Command::Sensitivity(options) => sensitivity::run(&options, &watch),
        Command::Tradeoff(options) => tradeoff::run(&options, &watch),
        Command::Ccx(options) => Ok(ccx::run(&options, &watch)),
        Command::Draw(options) => draw::run(&options),
        Command::Export(options) => export::run(&options),
        Command::New(options) => new::run(&options),
        Command::Verify(options) => verify::run(&options, &watch),
        Command::Completions(options) => Ok(shell::completions(&options)),
        Command::Man => Ok(shell::manual()),
        Command::Schema => Ok(Outcome::done(Scene::json_schema())),
    };
    drop(shown);
    // If the program is being ended with a kept report, it waits here.
    kept.take_to(drop);
    let is_cut = watch.acknowledge() && outcome.is_ok();
    let outcome = outcome.unwrap_or_else(|error| failed(&error, format));
    match &outcome.error {
        _ if is_cut => warn(&interrupt::sentence(&watch)),
        Some(error) => warn(&format!("error: {error}\n")),
        None => {}
    }
    let printed = io::stdout().write_all(outcome.text.as_bytes()).and_then(|()| io::stdout().flush());
    if let Err(error) = printed
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        warn(&format!("error: cannot write to standard output: {error}\n"));
        return ExitCode::from(Ending::BadInput as u8);
    }
    let draw = |pictures: Pictures| {
        watch.step("pictures", 0);
        let _shown = line();
        pictures()
    };
    match outcome.pictures.filter(|_| !watch.acknowledge()).map_or(Ok(()), draw) {
        Err(error) => {
            warn(&format!("error: {}\n", sentence(&error)));
            ExitCode::from(failed(&error, format).ending as u8)
        }
        _ if watch.is_stopped() => ExitCode::from(INTERRUPTED),
        _ => ExitCode::from(outcome.ending as u8),
    }
}
