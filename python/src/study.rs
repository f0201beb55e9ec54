//! Studies with more than one solve: comparison, trade-off, sweep.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use signorini::Watch;
use signorini::study::{self, TradeoffGrid};

use crate::arrays::reals;
use crate::errors::{bad_input, bad_type};
use crate::exceptions::plain_exception;
use crate::exceptions::signalled;
use crate::options::Options;
use crate::problem::Problem;
use crate::scene::{Scene, SceneSolution, scene_exception};
use crate::solution::{Solution, Source, as_object};
use crate::work::{End, Place, run};

/// One problem solved by interior point, active set and penalty. `signorini.compare` makes it.
///
/// For a problem the solutions are `Solution`, for a scene `SceneSolution`. They may miss the tolerance.
#[pyclass(frozen, module = "signorini", get_all)]
pub struct Comparison {
    /// The solution of the interior-point method.
    qp: Py<PyAny>,
    /// The solution of the active-set method.
    active_set: Py<PyAny>,
    /// The solution of the penalty method.
    penalty: Py<PyAny>,
    /// Differences between the three solutions, a dictionary.
    ///
    /// "active_set" and "penalty" compare these with the interior point: the relative differences "displacement",
    /// "multiplier" and "energy", and "rows", the number of rows that only one of them closes. "exact_methods" is
    /// `agrees`, and "penalty_within_its_bound" says that the penalty is as near as its certificate states.
    agreement: Py<PyAny>,
    /// True if the solutions of interior point and active set are certified and agree.
    agrees: bool,
}

#[pymethods]
impl Comparison {
    fn __repr__(&self) -> String {
        let said = if self.agrees { "agree" } else { "do not agree" };
        format!("<signorini.Comparison: interior point and active set {said}>")
    }
}

fn comparison(
    py: Python<'_>,
    found: study::Comparison,
    object: impl Fn(signorini::Solution) -> PyResult<Py<PyAny>>,
) -> PyResult<Comparison> {
    let study::Comparison { answers, agreement } = found;
    let [qp, active_set, penalty] = answers.map(|answer| object(answer.solution));
    let agrees = agreement.exact_methods;
    let agreement = as_object(py, &agreement)?.unbind();
    Ok(Comparison { qp: qp?, active_set: active_set?, penalty: penalty?, agreement, agrees })
}

/// Solves a problem or a scene by interior point, active set and penalty, and compares the solutions.
///
/// Parameters
/// ----------
/// problem : Problem or Scene
///     What is solved.
///
/// Returns
/// -------
/// Comparison
///     The three solutions, certified or not, and their differences.
///
/// Raises
/// ------
/// BadType
///     The argument is neither a `Problem` nor a `Scene`.
/// SignoriniError or Interrupted
///     As `signorini.solve`, except `NotCertified`; for a scene also as `Scene.solve`. `Interrupted` carries no
///     solution.
#[pyfunction]
pub fn compare(problem: &Bound<'_, PyAny>) -> PyResult<Comparison> {
    let py = problem.py();
    if let Ok(scene) = problem.cast::<Scene>() {
        return compared_scene(scene);
    }
    let inner = problem_of(problem)?.get().inner.clone();
    let settings = Options { proof: Some(false), ..Options::default() }.settings(Some(&inner))?;
    let place = Place::for_problem(&inner);
    let source = Source { problem: inner.clone(), settings: settings.clone(), prepared: None };
    match run(py, place, move |watch: &Watch| study::compare(&inner, &settings.watched(watch)))? {
        End::Done(Ok(found)) => comparison(py, found, |solution| Solution::object(py, solution, Some(source.clone()))),
        End::Done(Err(error)) => Err(plain_exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}

fn problem_of<'a, 'py>(problem: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, Problem>> {
    let kind = crate::arrays::kind_of(problem);
    problem.cast::<Problem>().map_err(|_| {
        bad_type(problem.py(), format!("the argument is of the type {kind}; it must be a Problem or a Scene"))
    })
}

/// Solves a scene by interior point, active set and penalty, and compares the solutions.
fn compared_scene(scene: &Bound<'_, Scene>) -> PyResult<Comparison> {
    let py = scene.py();
    let model = scene.get().model(py)?;
    let settings = Options { proof: Some(false), ..Options::default() }.settings(Some(model.problem()))?;
    let (goal, own, of_work) = (settings.goal(), scene.clone().unbind(), model.clone());
    let place = Place::for_problem(model.problem());
    match run(py, place, move |watch: &Watch| study::compare(of_work.problem(), &settings.watched(watch)))? {
        End::Done(Ok(found)) => comparison(py, found, |solution| {
            SceneSolution::object(py, own.clone_ref(py), model.clone(), solution, goal)
        }),
        End::Done(Err(error)) => Err(scene_exception(py, &own, &model, goal, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}

/// Solves a problem or a scene by every method at every accuracy, and returns the results as a dictionary.
#[pyfunction]
#[pyo3(name = "_measured", signature = (problem, refinements, runs, most_full_dofs, time))]
pub fn measured<'py>(
    problem: &Bound<'py, PyAny>,
    refinements: usize,
    runs: usize,
    most_full_dofs: usize,
    time: Option<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = problem.py();
    let seconds = time.unwrap_or(f64::INFINITY);
    if seconds.is_nan() || seconds <= 0.0 {
        return Err(bad_input(py, format!("time is {seconds}; it must be a positive number of seconds")));
    }
    let grid = TradeoffGrid { refinements, runs, most_full_dofs, seconds };
    let end = match problem.cast::<Scene>() {
        Ok(scene) => {
            scene.get().check_rest(py)?;
            let scene = scene.get().inner.clone();
            run(py, Place::Apart, move |watch: &Watch| study::Tradeoff::of_scene(&scene, &grid, watch))?
        }
        Err(_) => {
            let problem = problem_of(problem)?.get().inner.clone();
            run(py, Place::Apart, move |watch: &Watch| study::Tradeoff::of_problem(&problem, &grid, watch))?
        }
    };
    match end {
        End::Done(Ok(found)) => as_object(py, &found),
        End::Done(Err(error)) => Err(plain_exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}

/// Solves a scene for several `gaps` or `forces`, and returns its solutions and the events between them as a
/// dictionary.
#[pyfunction]
#[pyo3(name = "_swept", signature = (scene, over, values, method, threads))]
pub fn swept<'py>(
    scene: &Bound<'py, Scene>,
    over: &str,
    values: &Bound<'py, PyAny>,
    method: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let py = scene.py();
    let values = reals(over, values)?;
    if values.is_empty() {
        return Err(bad_input(py, format!("{over} is empty; a sweep takes one value at least")));
    }
    let sweep = if over == "forces" { study::Sweep::over_forces } else { study::Sweep::over_gaps };
    let model = scene.get().model(py)?;
    let options = Options { method, threads, proof: Some(false), ..Options::default() };
    let settings = options.settings(Some(model.problem()))?;
    let (goal, own, of_work) = (settings.goal(), scene.clone().unbind(), model.clone());
    let found = match run(py, Place::Apart, move |watch: &Watch| sweep(&of_work, &values, &settings.watched(watch)))? {
        End::Done(Ok(found)) => found,
        End::Done(Err(error)) => return Err(scene_exception(py, &own, &model, goal, error)),
        End::Signalled(signal, _) => return Err(signalled(py, signal, None)),
    };
    let whole = PyDict::new(py);
    whole.set_item("events", as_object(py, &found.events)?)?;
    whole.set_item("corners", as_object(py, &found.corners)?)?;
    let (answers, gaps, forces) = (PyList::empty(py), PyList::empty(py), PyList::empty(py));
    for point in found.points {
        gaps.append(point.gap)?;
        point.force.map_or(Ok(()), |force| forces.append(force))?;
        let model = point.answer.model().clone();
        answers.append(SceneSolution::object(py, own.clone_ref(py), model, point.summary.solution, goal)?)?;
    }
    whole.set_item("gaps", gaps)?;
    whole.set_item("forces", forces)?;
    whole.set_item("solutions", answers)?;
    Ok(whole)
}
