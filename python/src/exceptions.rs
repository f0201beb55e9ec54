//! Errors of the library, and signals, as exceptions.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use signorini::{Error, qp};

use crate::arrays::{of_indices, of_reals};
use crate::errors::{interrupted, raised};
use crate::solution::Solution;

/// Makes the exception for an error. `with_answer` converts the best answer that the error carries into a Python
/// object.
pub fn exception(
    py: Python<'_>,
    error: impl Into<Error>,
    with_answer: impl FnOnce(signorini::Solution) -> PyResult<Py<PyAny>>,
) -> PyErr {
    let (about, error) = (PyDict::new(py), error.into());
    let (sentence, code) = (error.to_string(), error.code());
    let filled = || -> PyResult<&'static str> {
        about.set_item("code", code)?;
        Ok(match error {
            Error::Linear(qp::LinearError::NotConvex { .. }) => "NotConvex",
            Error::Qp(qp::Error::Infeasible { rows, weights, overlap, .. }) => {
                about.set_item("rows", of_indices(py, rows)?)?;
                about.set_item("weights", of_reals(py, &weights)?)?;
                about.set_item("overlap", overlap)?;
                "Infeasible"
            }
            Error::Qp(qp::Error::Unbounded { mode, direction }) => {
                about.set_item("motion", mode)?;
                about.set_item("direction", of_reals(py, &direction)?)?;
                "Unbounded"
            }
            Error::Qp(qp::Error::UnderHeld { mode, direction }) => {
                about.set_item("motion", mode)?;
                about.set_item("direction", of_reals(py, &direction)?)?;
                "UnderHeld"
            }
            Error::Qp(qp::Error::OutOfTime { needed, time }) => {
                about.set_item("needed", needed)?;
                about.set_item("time", time)?;
                "OutOfTime"
            }
            Error::Qp(qp::Error::Interrupted) => "Interrupted",
            Error::Qp(qp::Error::NotCertified { solution, condition, value, tolerance }) => {
                about.set_item("solution", with_answer(*solution)?)?;
                about.set_item("condition", condition)?;
                about.set_item("value", value)?;
                about.set_item("tolerance", tolerance)?;
                "NotCertified"
            }
            Error::BeyondSmallDisplacements { solution, .. } => {
                about.set_item("solution", with_answer(*solution)?)?;
                "BeyondSmallDisplacements"
            }
            Error::Qp(qp::Error::Undecided { .. }) => "Undecided",
            Error::Qp(qp::Error::TooLarge { bytes, allowed, .. }) => {
                about.set_item("bytes", bytes)?;
                about.set_item("allowed", allowed)?;
                "TooLarge"
            }
            Error::Qp(qp::Error::NoRoom { factor, allowed, .. }) => {
                about.set_item("bytes", factor)?;
                about.set_item("allowed", allowed)?;
                "TooLarge"
            }
            Error::Linear(qp::LinearError::Numerical { .. }) => "NumericalError",
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
            Error::Linear(qp::LinearError::File { .. }) => "FileError",
            _ => "BadInput",
        })
    };
    match filled() {
        Ok(class) => raised(py, class, &sentence, &about),
        Err(error) => error,
    }
}

/// Makes the exception for an error of a problem without a scene.
pub fn plain_exception(py: Python<'_>, error: impl Into<Error>) -> PyErr {
    exception(py, error, |solution| Solution::object(py, solution, None))
}

/// Returns the exception of a signal: an interrupt with the best solution, or the exception of the caller's own
/// handler.
pub fn signalled(py: Python<'_>, signal: PyErr, best: Option<Py<PyAny>>) -> PyErr {
    match signal.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) {
        true => interrupted(py, best),
        false => signal,
    }
}
