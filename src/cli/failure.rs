//! The error of a command: one sentence, the status of its report, one exit code.

use std::fmt::Display;

use serde_json::json;

use super::options::Format;
use super::outcome::{Ending, Outcome};
use crate::output::printable;
use crate::{Error, Failure};

/// If a message has more characters than this, its middle is left out: it may quote megabytes of a file.
const LONGEST_SENTENCE: usize = 800;

/// The message of an error on one line of bearable length.
pub(super) fn sentence(error: &impl Display) -> String {
    let message: Vec<char> = printable(&error.to_string()).chars().collect();
    let half = LONGEST_SENTENCE / 2;
    if message.len() <= LONGEST_SENTENCE {
        return message.into_iter().collect();
    }
    let (head, tail) = (&message[..half], &message[message.len() - half..]);
    head.iter().chain(&[' ', '.', '.', '.', ' ']).chain(tail).collect()
}

/// The outcome of a command that ended with an error, with its exit code; in JSON it is an object.
pub(super) fn failed(error: &Error, format: Format) -> Outcome {
    ended(&sentence(error), (error.status(), error.code()), error.failure(), format)
}

/// The same for a sentence with its status and code.
pub(super) fn ended(message: &str, (status, code): (&str, &str), failure: Failure, format: Format) -> Outcome {
    let ending = match failure {
        Failure::BadInput => Ending::BadInput,
        Failure::NoSolution => Ending::NoSolution,
        Failure::NotCertified => Ending::NotCertified,
    };
    let text = match format {
        Format::Text => String::new(),
        Format::Json => {
            let report = json!({ "status": status, "code": code, "message": message });
            format!("{report:#}\n")
        }
    };
    Outcome { ending, error: Some(message.into()), ..Outcome::done(text) }
}
