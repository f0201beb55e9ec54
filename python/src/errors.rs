//! Errors of the library as exceptions. Their classes are defined in `package/signorini/_errors.py`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use signorini::Error;

use crate::arrays::{of_indices, of_reals};
use crate::solution::Solution;

/// Makes an exception of the class of this name, with a message and attributes.
fn raised(py: Python<'_>, class: &str, sentence: &str, attributes: &Bound<'_, PyDict>) -> PyErr {
    let make = || -> PyResult<PyErr> {
        let exception = py.import("signorini._errors")?.getattr(class)?.call1((sentence,))?;
        for (name, value) in attributes {
            exception.setattr(name.extract::<String>()?, value)?;
        }
        Ok(PyErr::from_value(exception))
    };
    make().unwrap_or_else(|error| error)
}

fn plain(py: Python<'_>, class: &str, sentence: &str) -> PyErr {
    raised(py, class, sentence, &PyDict::new(py))
}

/// Makes the exception for an argument of the right type with a wrong value.
pub fn bad_input(py: Python<'_>, sentence: impl AsRef<str>) -> PyErr {
    plain(py, "BadInput", sentence.as_ref())
}

/// Makes the exception for an argument of a wrong type.
pub fn bad_type(py: Python<'_>, sentence: impl AsRef<str>) -> PyErr {
    plain(py, "BadType", sentence.as_ref())
}

/// Makes the exception for a lack of memory.
pub fn no_memory(py: Python<'_>, sentence: impl AsRef<str>) -> PyErr {
    plain(py, "TooLarge", sentence.as_ref())
}

/// Makes the exception for a panic that was caught.
pub fn panicked(py: Python<'_>, message: &str) -> PyErr {
    let sentence = format!("the library failed unexpectedly: {message}; please report this with the problem");
    plain(py, "InternalError", &sentence)
}

/// Makes the exception for an interrupt, with the best answer so far.
pub fn interrupted(py: Python<'_>, best: Option<Py<PyAny>>) -> PyErr {
    let attributes = PyDict::new(py);
    let sentence = match &best {
        Some(_) => "interrupted; the best answer so far is in `solution`",
        None => "interrupted before there was an answer",
    };
    match attributes.set_item("solution", best) {
        Ok(()) => raised(py, "Interrupted", sentence, &attributes),
        Err(error) => error,
    }
}

/// Makes the exception for an error. `with_answer` converts the best answer that the error carries into a Python
/// object.
pub fn exception(
    py: Python<'_>,
    error: Error,
    with_answer: impl FnOnce(signorini::Solution) -> PyResult<Py<PyAny>>,
) -> PyErr {
    let about = PyDict::new(py);
    let (sentence, code) = (error.to_string(), error.code());
    let filled = || -> PyResult<&'static str> {
        about.set_item("code", code)?;
        Ok(match error {
            Error::NotConvex { .. } => "NotConvex",
            Error::Infeasible { rows, weights, overlap, .. } => {
                about.set_item("rows", of_indices(py, rows)?)?;
                about.set_item("weights", of_reals(py, &weights)?)?;
                about.set_item("overlap", overlap)?;
                "Infeasible"
            }
            Error::Unbounded { mode, direction } => {
                about.set_item("motion", mode)?;
                about.set_item("direction", of_reals(py, &direction)?)?;
                "Unbounded"
            }
            Error::UnderHeld { mode, direction } => {
                about.set_item("motion", mode)?;
                about.set_item("direction", of_reals(py, &direction)?)?;
                "UnderHeld"
            }
            Error::OutOfTime { needed, time } => {
                about.set_item("needed", needed)?;
                about.set_item("time", time)?;
                "OutOfTime"
            }
            Error::Interrupted => "Interrupted",
            Error::NotCertified { solution, condition, value, tolerance } => {
                about.set_item("solution", with_answer(*solution)?)?;
                about.set_item("condition", condition)?;
                about.set_item("value", value)?;
                about.set_item("tolerance", tolerance)?;
                "NotCertified"
            }
            Error::Undecided { .. } => "Undecided",
            Error::TooLarge { bytes, allowed, .. } => {
                about.set_item("bytes", bytes)?;
                about.set_item("allowed", allowed)?;
                "TooLarge"
            }
            Error::NoRoom { factor, allowed, .. } => {
                about.set_item("bytes", factor)?;
                about.set_item("allowed", allowed)?;
                "TooLarge"
            }
            Error::Numerical { .. } => "NumericalError",
            Error::SceneSyntax { path, line, column, .. } => {
                about.set_item("path", path)?;
                about.set_item("line", line)?;
                about.set_item("column", column)?;
                "SceneError"
            }
            Error::Scene { path, .. } | Error::Refused { path, .. } => {
                about.set_item("path", path)?;
                "SceneError"
            }
            Error::File { .. } => "FileError",
            _ => "BadInput",
        })
    };
    match filled() {
        Ok(class) => raised(py, class, &sentence, &about),
        Err(error) => error,
    }
}

/// Makes the exception for an error of a problem without a scene.
pub fn plain_exception(py: Python<'_>, error: Error) -> PyErr {
    exception(py, error, |solution| Solution::object(py, solution))
}
