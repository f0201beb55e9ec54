//! The output of a command, and its messages while it runs.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use crate::qp;
use serde::Serialize;

use super::options::Format;
use crate::Error;
use crate::output::{remove_shown, write_files};
use crate::study::Status;

/// The exit code of a command; a usage error is 2, from the argument parser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    Certified = 0,
    BadInput = 1,
    NoSolution = 3,
    NotCertified = 4,
}

/// The output of a command: the text for standard output, the exit code with the sentence about it for standard error,
/// and the pictures to draw after the text.
pub(super) struct Outcome {
    pub text: String,
    /// `None` if there is no error.
    pub error: Option<String>,
    pub ending: Ending,
    pub pictures: Option<Pictures>,
}

/// Fields and pictures are written after the report, because they take longer.
pub(super) type Pictures = Box<dyn FnOnce() -> Result<(), Error>>;

/// Erases the current line of a terminal.
pub(super) const ERASED: &str = "\r\x1b[K";

/// Writes to standard error, on a terminal in place of the line of progress; if standard error is closed, the message
/// is dropped.
pub(super) fn warn(text: &str) {
    if text.is_empty() {
        return;
    }
    let erased = if io::stderr().is_terminal() { ERASED } else { "" };
    let _ = io::stderr().write_all(format!("{erased}{text}").as_bytes());
}

/// The error for an option, or a part of a scene, that does not fit the input.
pub(super) fn unfit<T>(path: &str, message: impl Into<String>) -> Result<T, Error> {
    Err(Error::Scene { path: path.into(), message: message.into() })
}

/// A report in both forms: text and JSON.
pub(super) struct Report {
    text: String,
    json: String,
}

/// A report with the names of its entries of the meshed part.
#[derive(Serialize)]
pub(super) struct OfPart<T> {
    #[serde(flatten)]
    report: T,
    /// Empty without planes of symmetry.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    of_meshed_part: &'static [&'static str],
}

impl<T: Serialize> OfPart<T> {
    /// The report, in which these entries are of the meshed part if it is a part of the whole.
    pub fn new(report: T, is_part: bool, names: &'static [&'static str]) -> Self {
        OfPart { report, of_meshed_part: if is_part { names } else { &[] } }
    }
}

impl Report {
    /// The report `value` with its text.
    pub fn new(value: &impl Serialize, text: String) -> Result<Self, Error> {
        let failed =
            |error: serde_json::Error| qp::LinearError::Numerical { step: "writing JSON", reason: error.to_string() };
        // Through a value: indented, fields in alphabetical order, `null` for a number that is not finite.
        let value = serde_json::to_value(value).map_err(failed)?;
        Ok(Report { text, json: format!("{value:#}\n") })
    }

    /// The object of `report.json`.
    pub fn value(&self) -> Result<serde_json::Value, Error> {
        let failed =
            |error: serde_json::Error| qp::LinearError::Numerical { step: "reading JSON", reason: error.to_string() };
        Ok(serde_json::from_str(&self.json).map_err(failed)?)
    }

    /// Writes `report.json` into the folder, and takes out what an earlier run shows there.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        remove_shown(folder)?;
        write_files(folder, &[("report.json", &self.json)])
    }

    /// The same with its text in a file of its own.
    pub fn write_with_text(&self, folder: &Path, name: &str) -> Result<(), Error> {
        write_files(folder, &[(name, &self.text)])?;
        self.write(folder)
    }

    /// The report in this form.
    pub fn formatted(self, format: Format) -> String {
        match format {
            Format::Text => self.text,
            Format::Json => self.json,
        }
    }

    /// The outcome of a command that prints the report in this form and certifies nothing.
    pub fn printed(self, format: Format) -> Outcome {
        Outcome::done(self.formatted(format))
    }

    /// The outcome of a command that prints the report in this form; its answers have this status.
    pub fn outcome(self, format: Format, status: Status) -> Outcome {
        let ending = match status {
            Status::Certified => Ending::Certified,
            Status::NotCertified | Status::Unstable | Status::BeyondSmallDisplacements => Ending::NotCertified,
        };
        let error = (ending != Ending::Certified).then(|| format!("{}; the report says why", status.words()));
        Outcome { ending, error, ..self.printed(format) }
    }
}

impl Outcome {
    /// The outcome of a successful command without a report.
    pub fn done(text: String) -> Self {
        Outcome { text, error: None, ending: Ending::Certified, pictures: None }
    }

    /// The same with a sentence that says more of its error.
    pub fn because(self, error: Option<String>) -> Self {
        Outcome { error: error.or(self.error), ..self }
    }

    pub fn with_pictures(self, pictures: impl FnOnce() -> Result<(), Error> + 'static) -> Self {
        Outcome { pictures: Some(Box::new(pictures)), ..self }
    }
}
