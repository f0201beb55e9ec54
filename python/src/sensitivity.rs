//! Derivatives of the outputs of a scene.

use pyo3::prelude::*;
use pyo3::types::PyList;
use signorini::qp::Derivative;
use signorini::scene::Sensitivities;
use signorini::{Error, Watch};

use crate::arrays::{kind_of, of_table};
use crate::errors::bad_type;
use crate::exceptions::{plain_exception, signalled};
use crate::options::Options;
use crate::scene::Scene;
use crate::solution::as_object;
use crate::work::{End, Place, run};

/// The parameter that is no number of the scene.
const PLACES: &str = "nodes";

/// Reads names: one, or several.
fn names(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    if let Ok(one) = given.extract::<String>() {
        return Ok(vec![one]);
    }
    let kind = kind_of(given);
    given.extract().map_err(|_| {
        bad_type(given.py(), format!("{name} is of the type {kind}; it must be a name, or a list of names"))
    })
}

/// Solves a scene, and returns the derivatives of its outputs with respect to its parameters.
///
/// Parameters
/// ----------
/// scene : Scene
///     The scene, at rest.
/// of : str or list of str
///     Outputs, for example "force", "peak-pressure", "obstacles[0].travel" or "stress@0.5,0.4:xx". `Scene.outputs` has
///     all names.
/// to : str or list of str, optional
///     Parameters, for example "gap", "young", "loads[0]" or "obstacles[0].radius"; "nodes" stands for the places of
///     all nodes. All numbers of the scene by default. `Scene.parameters` has all names.
/// method, tolerance, threads, memory : optional
///     As in `signorini.solve`.
///
/// Returns
/// -------
/// list of dict
///     One dictionary per output, with "output", "value", "unit" and "by". "by" has one dictionary per parameter, with
///     "parameter", "value", "unit", "derivative" and "relative": per cent of the output for one per cent of the
///     parameter.
///
///     A derivative is a dictionary with a "verdict". If it is "proven", "value" is the derivative, in the unit of the
///     output over that of the parameter. If it is "one-sided", "left" and "right" are those to both sides. If it is
///     "undecided", "between" has those with the "rows" open and closed. If it is "unknown", "why" says the reason. For
///     "nodes" there is also "places", shape (nodes, dim): the derivatives by the coordinates.
///
/// Raises
/// ------
/// SceneError
///     A name does not exist; the sentence has those that do. Or the scene moves, or cannot be built.
/// BadInput
///     An option has a value that is not allowed.
/// BadType or TypeError
///     An argument has a wrong type.
/// SignoriniError or Interrupted
///     As `signorini.solve`.
#[pyfunction]
#[pyo3(signature = (scene, of, to = None, *, method = None, tolerance = None, threads = None, memory = None))]
pub fn sensitivity<'py>(
    scene: &Bound<'py, Scene>,
    of: &Bound<'py, PyAny>,
    to: Option<&Bound<'py, PyAny>>,
    method: Option<Bound<'py, PyAny>>,
    tolerance: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    memory: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = scene.py();
    let settings = Options { method, tolerance, threads, memory, ..Options::default() };
    let inner = scene.get().inner.clone();
    let outputs = names("of", of)?;
    let numbers = || inner.parameters().into_iter().filter(|name| name != PLACES).collect();
    let parameters = to.map_or_else(|| Ok(numbers()), |to| names("to", to))?;
    let model = scene.get().model(py)?;
    let settings = settings.settings(Some(model.problem()))?;
    let find = move |watch: &Watch| -> Result<Sensitivities, Error> {
        let [outputs, parameters] =
            [&outputs, &parameters].map(|names| names.iter().map(String::as_str).collect::<Vec<&str>>());
        Sensitivities::of(&inner, model, &outputs, &parameters, &settings.watched(watch))
    };
    let found = match run(py, Place::Apart, find)? {
        End::Done(Ok(found)) => found,
        End::Done(Err(error)) => return Err(plain_exception(py, error)),
        End::Signalled(signal, _) => return Err(signalled(py, signal, None)),
    };
    let object = as_object(py, &found.outputs)?;
    let dimension = found.answer.model().mesh().dimension();
    for (output, shown) in found.outputs.iter().zip(object.cast::<PyList>()?.iter()) {
        for (by, row) in output.by.iter().zip(shown.get_item("by")?.cast::<PyList>()?.iter()) {
            if let Some(Derivative::Proven(places)) = &by.places {
                row.set_item("places", of_table(py, places, dimension)?)?;
            }
        }
    }
    Ok(object)
}
