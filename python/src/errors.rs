//! Exceptions by class, message and attributes. Their classes are defined in `package/signorini/_errors.py`.

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Makes an exception of the class of this name, with a message and attributes.
pub fn raised(py: Python<'_>, class: &str, sentence: &str, attributes: &Bound<'_, PyDict>) -> PyErr {
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
