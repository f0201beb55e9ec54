//! The command line: arguments in, text or JSON out, and one exit code for each kind of ending.

mod compare;
mod dynamic;
mod export;
mod input;
mod interrupt;
mod memory;
mod options;
mod progress;
mod settings;
mod solve;
mod sweep;
mod tradeoff;
mod verify;

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::error::Error;
use crate::output::printable;
use crate::scene::Scene;
use crate::watch::Watch;
use interrupt::INTERRUPTED;
use options::{Arguments, Command, Format};
use progress::Progress;

/// How a command ended, as an exit code; a usage error is 2, from the argument parser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    Certified = 0,
    BadInput = 1,
    NoSolution = 3,
    NotCertified = 4,
}

/// What a command leaves: the text for standard output, how it ended, and what is drawn once the text is out.
struct Outcome {
    text: String,
    ending: Ending,
    pictures: Option<Pictures>,
}

/// Fields and pictures take their time, and nobody should have to wait for numbers because of them.
type Pictures = Box<dyn FnOnce() -> Result<(), Error>>;

/// Runs the program with `arguments`, the first of which is its name.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(help) => {
            // A closed pipe leaves nobody to tell.
            let _ = help.print();
            return ExitCode::from(help.exit_code() as u8);
        }
    };
    let watch = if arguments.progress { progress::told() } else { Watch::default() };
    interrupt::listen(&watch);
    watch.step("assembly", 0);
    let line = || (!arguments.progress).then(|| Progress::of(&watch));
    let shown = line();
    let format = arguments.command.format();
    let outcome = match arguments.command {
        Command::Solve(options) => solve::run(&options, &watch),
        Command::Compare(options) => compare::run(&options, &watch),
        Command::Sweep(options) => sweep::run(&options, &watch),
        Command::Tradeoff(options) => tradeoff::run(&options, &watch),
        Command::Export(options) => export::run(&options),
        Command::Verify(options) => verify::run(&options),
        Command::Schema => Ok(Outcome::certified(format!("{:#}\n", Scene::json_schema()))),
    };
    drop(shown);
    if watch.is_stopped() && outcome.is_ok() {
        warn(&interrupt::sentence(&watch));
    }
    let outcome = outcome.unwrap_or_else(|error| {
        let message = sentence(&error);
        warn(&format!("error: {message}\n"));
        let ending = ending_of(&error);
        let text = match format {
            Format::Json => format!("{:#}\n", failure_json(&error, &message)),
            Format::Text => String::new(),
        };
        Outcome { text, ending, pictures: None }
    });
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
    match outcome.pictures.filter(|_| !watch.is_stopped()).map_or(Ok(()), draw) {
        Err(error) => {
            warn(&format!("error: {}\n", sentence(&error)));
            ExitCode::from(ending_of(&error) as u8)
        }
        _ if watch.is_stopped() => ExitCode::from(INTERRUPTED),
        _ => ExitCode::from(outcome.ending as u8),
    }
}

/// Takes the line of a terminal that is being written back.
const ERASED: &str = "\r\x1b[K";

/// Writes to standard error, on a terminal in place of the line of progress; where it is closed there is nobody to tell.
fn warn(text: &str) {
    if text.is_empty() {
        return;
    }
    let erased = if io::stderr().is_terminal() { ERASED } else { "" };
    let _ = io::stderr().write_all(format!("{erased}{text}").as_bytes());
}

impl Outcome {
    fn certified(text: String) -> Self {
        Outcome::judged(text, true)
    }

    /// Certified or not, with that exit code.
    fn judged(text: String, certified: bool) -> Self {
        let ending = if certified { Ending::Certified } else { Ending::NotCertified };
        Outcome { text, ending, pictures: None }
    }

    fn with_pictures(self, pictures: impl FnOnce() -> Result<(), Error> + 'static) -> Self {
        Outcome { pictures: Some(Box::new(pictures)), ..self }
    }
}

/// More characters than this of a message are left out of its middle: a file may repeat megabytes in it.
const LONGEST_SENTENCE: usize = 800;

/// The message of an error on one line of bearable length.
fn sentence(error: &Error) -> String {
    let message: Vec<char> = printable(&error.to_string()).chars().collect();
    let half = LONGEST_SENTENCE / 2;
    if message.len() <= LONGEST_SENTENCE {
        return message.into_iter().collect();
    }
    let (head, tail) = (&message[..half], &message[message.len() - half..]);
    head.iter().chain(&[' ', '.', '.', '.', ' ']).chain(tail).collect()
}

fn ending_of(error: &Error) -> Ending {
    match error {
        Error::Infeasible { .. } | Error::Unbounded { .. } | Error::UnderHeld { .. } => Ending::NoSolution,
        Error::NotCertified { .. } | Error::OutOfTime { .. } | Error::Interrupted => Ending::NotCertified,
        _ => Ending::BadInput,
    }
}

fn failure_json(error: &Error, message: &str) -> serde_json::Value {
    let status = match error {
        Error::Infeasible { .. } => "infeasible",
        Error::Unbounded { .. } => "unbounded",
        Error::UnderHeld { .. } => "under_held",
        Error::NotConvex { .. } => "not_convex",
        Error::Numerical { .. } => "failed",
        Error::Interrupted => "interrupted",
        Error::OutOfTime { .. } => "out_of_time",
        _ => "bad_input",
    };
    serde_json::json!({ "status": status, "code": error.code(), "message": message })
}
