//! Values as JSON text.

use serde::Serialize;

use crate::error::Error;

/// One line, the fields in the order of their type, for a file that this program reads again.
///
/// # Errors
/// [`Error::Numerical`] for a value that JSON cannot hold.
pub(crate) fn compact_json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(failed)
}

/// The report that the command line prints: indented, fields in alphabetical order, `null` for a number that is not finite, and a line
/// end.
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
