//! Values as JSON text.

use serde::Serialize;
use signorini_qp as qp;

use signorini_mechanics::Error;

/// One line, the fields in the order of their type, for a file that this program reads again.
pub(crate) fn compact_json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(failed)
}

fn failed(error: serde_json::Error) -> Error {
    qp::LinearError::Numerical { step: "writing JSON", reason: error.to_string() }.into()
}
