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

/// Returns the lowest natural vibrations of a scene about its equilibrium. Closed rows stay closed, open rows stay
/// open.
///
/// Parameters
/// ----------
/// scene : Scene
///     The scene, with a density of every material.
/// count : int
///     Number of modes, from 1 to 1000.
/// method, tolerance, threads, memory : optional
///     As in `signorini.solve`; they are for the equilibrium.
///
/// Returns
/// -------
/// dict
///     "modes" has one dictionary per mode, by increasing frequency. "closed" has the indices of the rows that stay
///     closed, from 0, "undecided" those of them that may be open. "unproven" is the reason if no row is proven,
///     otherwise None. "is_complete" says that no frequency below the last is missed. "rigid_motions" names the motions
///     without energy. "mass" is that of the whole bodies. "seconds" is the time of the modes alone.
///
///     A mode has "frequency", in one over time; "frequency_open", the same with undecided rows open, if there are
///     some; "residual", dimensionless; "participation", in the root of mass, and "effective_mass", in mass, for each
///     axis; and "displacement", shape (nodes, dim), in one over the root of mass, scaled to mass 1. "opens" and
///     "closes" say when the first closed row opens and the first open row closes: a dictionary with the "amplitude" of
///     the mode, in length, and with "row", "node" and "obstacle", from 0; None if no row does.
///
/// Raises
/// ------
/// SceneError
///     The count is out of its range, a material has no density, or the scene cannot be built.
/// BadInput
///     An option has a value that is not allowed.
/// BadType, TypeError or OverflowError
///     An argument has a wrong type, or `count` is negative.
/// SignoriniError or Interrupted
///     As `signorini.solve`.
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
