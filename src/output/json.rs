//! Values as JSON text.

use serde::Serialize;

use crate::error::Error;

/// One line, the fields in the order of their type: a file that this program reads again.
///
/// # Errors
/// [`Error::Numerical`] for a value that JSON cannot hold.
pub(crate) fn compact_json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(failed)
}

/// A report as the command line prints it: indented, the fields in alphabetical order, a number that is not finite as null,
/// and a line end.
///
/// # Errors
/// [`Error::Numerical`] for a value that JSON cannot hold.
#[cfg(feature = "cli")]
pub fn report_json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_value(value).map(|value| format!("{value:#}\n")).map_err(failed)
}

fn failed(error: serde_json::Error) -> Error {
    Error::Numerical { step: "writing JSON", reason: error.to_string() }
}
