//! An error as a command leaves it: one sentence, the status of its report, one exit code.

use serde_json::json;

use super::options::Format;
use super::outcome::{Ending, Outcome};
use crate::error::Error;
use crate::output::printable;

/// More characters than this of a message are left out of its middle: a file may repeat megabytes in it.
const LONGEST_SENTENCE: usize = 800;

/// The message of an error on one line of bearable length.
pub(super) fn sentence(error: &Error) -> String {
    let message: Vec<char> = printable(&error.to_string()).chars().collect();
    let half = LONGEST_SENTENCE / 2;
    if message.len() <= LONGEST_SENTENCE {
        return message.into_iter().collect();
    }
    let (head, tail) = (&message[..half], &message[message.len() - half..]);
    head.iter().chain(&[' ', '.', '.', '.', ' ']).chain(tail).collect()
}

/// The exit code of an error and the status of its report: the one place that tells kinds of errors apart.
fn kind(error: &Error) -> (Ending, &'static str) {
    match error {
        Error::Infeasible { .. } => (Ending::NoSolution, "infeasible"),
        Error::Unbounded { .. } => (Ending::NoSolution, "unbounded"),
        Error::UnderHeld { .. } => (Ending::NoSolution, "under_held"),
        Error::NotCertified { .. } => (Ending::NotCertified, "not_certified"),
        Error::OutOfTime { .. } => (Ending::NotCertified, "out_of_time"),
        Error::Interrupted => (Ending::NotCertified, "interrupted"),
        Error::NotConvex { .. } => (Ending::BadInput, "not_convex"),
        Error::Numerical { .. } => (Ending::BadInput, "failed"),
        _ => (Ending::BadInput, "bad_input"),
    }
}

/// The outcome of a command that ended with an error; in JSON it is an object.
pub(super) fn failed(error: &Error, format: Format) -> Outcome {
    let (ending, status) = kind(error);
    let text = match format {
        Format::Text => String::new(),
        Format::Json => {
            let report = json!({ "status": status, "code": error.code(), "message": sentence(error) });
            format!("{report:#}\n")
        }
    };
    Outcome { ending, ..Outcome::done(text) }
}
