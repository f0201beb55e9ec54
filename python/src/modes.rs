//! Natural vibrations of a scene.

use pyo3::prelude::*;
use pyo3::types::PyList;
use signorini::scene::ModalAnalysis;
use signorini::{Error, Watch};

use crate::arrays::of_table;
use crate::exceptions::{plain_exception, signalled};
use crate::options::Options;
use crate::scene::Scene;
use crate::solution::as_object;
use crate::work::{End, Place, run};

/// The `count` lowest natural vibrations of a scene about its equilibrium.
#[pyfunction]
#[pyo3(signature = (scene, count, *, method = None, tolerance = None, threads = None, memory = None))]
pub fn modes<'py>(
    scene: &Bound<'py, Scene>,
    count: usize,
    method: Option<Bound<'py, PyAny>>,
    tolerance: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    memory: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = scene.py();
    let options = Options { method, tolerance, threads, memory, ..Options::default() };
    let (inner, settings) = (scene.get().inner.clone(), options.settings(None)?);
    let find =
        move |watch: &Watch| -> Result<ModalAnalysis, Error> { inner.modal_analysis(count, &settings.watched(watch)) };
    let found = match run(py, Place::Apart, find)? {
        End::Done(Ok(found)) => found,
        End::Done(Err(error)) => return Err(plain_exception(py, error)),
        End::Signalled(signal, _) => return Err(signalled(py, signal, None)),
    };
    let object = as_object(py, &found)?;
    let dimension = found.answer.model().mesh().dimension();
    for (mode, shown) in found.modes.iter().zip(object.get_item("modes")?.cast::<PyList>()?.iter()) {
        shown.set_item("displacement", of_table(py, &mode.displacement, dimension)?)?;
    }
    Ok(object)
}
