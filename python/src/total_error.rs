//! The mesh of a scene refined until its error against the continuum is small enough.

use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use signorini::study::{self, ContinuumAnswer, LevelKind, TotalErrorGoal};
use signorini::{Goal, Watch};

use crate::arrays::{of_indices, of_table};
use crate::errors::{bad_input, panicked};
use crate::exceptions::signalled;
use crate::options::{Options, number};
use crate::scene::{Scene, SceneSolution, scene_exception};
use crate::solution::as_object;
use crate::work::{End, Place, run};

/// An answer with its error against the continuum: u is the exact displacement of the linear model, v the answer.
///
/// With a guarantee `nodes`, `elements` and `displacement` describe v. v keeps the distance of the obstacles between
/// its nodes too, so that it may differ from `solution`. Without a guarantee they are those of `solution`.
/// `signorini.total_error` makes it.
#[pyclass(frozen, module = "signorini")]
pub struct TotalError {
    /// What was found, without the answer on the last mesh.
    found: study::TotalError,
    /// The answer on the last mesh. Without a guarantee there is always one.
    solution: Option<Py<PyAny>>,
}

impl TotalError {
    fn new(py: Python<'_>, scene: &Py<Scene>, mut found: study::TotalError, goal: Goal) -> PyResult<Self> {
        let goal = match found.levels.last().map(|level| &level.kind) {
            Some(LevelKind::Estimated { .. }) => Goal { accuracy: Some(found.algebra()), ..goal },
            _ => goal,
        };
        let solution = match std::mem::replace(&mut found.last, Err(String::new())) {
            Ok(last) => {
                let (answer, solution) = *last;
                let scene = Py::new(py, scene.get().on(answer.model().clone()))?;
                Some(SceneSolution::of(py, scene, answer, solution, goal)?)
            }
            Err(why) if found.guarantee.is_none() => return Err(panicked(py, &why)),
            Err(_) => None,
        };
        Ok(TotalError { found, solution })
    }

    /// An attribute of the answer on the last mesh, of which there is one without a guarantee.
    fn of_solution<'py>(&self, py: Python<'py>, path: &[&str]) -> PyResult<Bound<'py, PyAny>> {
        let solution = self.solution.as_ref().ok_or_else(|| panicked(py, "there is no answer on the last mesh"))?;
        path.iter().try_fold(solution.bind(py).clone(), |object, name| object.getattr(*name))
    }
}

#[pymethods]
impl TotalError {
    /// |u - v| / |v| in the energy norm: an upper bound if it is guaranteed, otherwise an estimate.
    #[getter]
    fn bound(&self) -> f64 {
        self.found.total_error.bound
    }

    /// True if the bound is proven, False if it is estimated.
    #[getter]
    fn guaranteed(&self) -> bool {
        self.found.total_error.guaranteed
    }

    /// The part of the scene for which there is no guarantee, with its place; None if the bound is guaranteed.
    #[getter]
    fn reason(&self) -> Option<&str> {
        self.found.reason.as_deref()
    }

    /// Two numbers, in force, between which the exact contact force lies; None if they are not known.
    #[getter]
    fn force_interval(&self) -> Option<(f64, f64)> {
        self.found.guarantee.as_ref()?.force_interval.map(<(f64, f64)>::from)
    }

    /// One dictionary per mesh, from the first to the last; the keys are those in the reports of the program.
    ///
    /// All have "elements", "dofs", "total_error", "contact_force" (in force) and "seconds". With a guarantee there are
    /// also "stress_dofs", "mean_stress_error", "force_interval" where it is known, "displacement_seconds" and
    /// "stress_seconds". Otherwise there are "contact_rows", "method", "discretisation_error", "energy_error_bound" and
    /// "depth_between_nodes".
    #[getter]
    fn levels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.found.levels)
    }

    /// Why no finer mesh was made: "goal", "time", "memory", or "mesh" if the mesh of a file cannot be refined.
    #[getter]
    fn ended<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.found.ended)
    }

    /// "certified" if the goal is met, otherwise "not_certified".
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.found.status)
    }

    /// Size of the problem on the last mesh, a dictionary with the keys of the reports of the program, such as "dofs".
    #[getter]
    fn model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.found.model)
    }

    /// Coordinates of the nodes of the last mesh, shape (nodes, dim), in length.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.found.guarantee {
            Some(guarantee) => of_answer(py, &guarantee.answer, &guarantee.answer.nodes),
            None => self.of_solution(py, &["scene", "nodes"]),
        }
    }

    /// Node numbers of the elements of the last mesh, one row per element, counted from 0, in the order of VTK.
    ///
    /// With a guarantee in the plane they are triangles with six nodes: three corners, then the middles of the sides
    /// 0-1, 1-2 and 2-0.
    #[getter]
    fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.found.guarantee {
            Some(guarantee) => {
                let elements = &guarantee.answer.elements;
                let nodes = of_indices(py, elements.iter().flatten().copied())?;
                nodes.call_method1("reshape", (elements.len(), guarantee.answer.kind.nodes()))
            }
            None => self.of_solution(py, &["scene", "elements"]),
        }
    }

    /// The displacement v of each node of the last mesh, shape (nodes, dim), in length, along the axes.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.found.guarantee {
            Some(guarantee) => of_answer(py, &guarantee.answer, &guarantee.answer.displacement),
            None => self.of_solution(py, &["displacement"]),
        }
    }

    /// The solution of the scene on the last mesh, a `SceneSolution`; its `scene` has that mesh.
    ///
    /// None if time or memory ended before it.
    #[getter]
    fn solution(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.solution.as_ref().map(|solution| solution.clone_ref(py))
    }

    /// Returns all numbers; the arrays are left out.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Its keys are those in the reports of the program. A number that is not finite is None.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.found)
    }

    fn __repr__(&self) -> String {
        let (error, meshes) = (self.found.total_error, self.found.levels.len());
        let said = if error.guaranteed { "guaranteed at most" } else { "estimated" };
        format!("<signorini.TotalError: {said} {:.1e}, {meshes} meshes>", error.bound)
    }
}

/// Vectors at the nodes of an answer, one row per node.
fn of_answer<'py>(py: Python<'py>, answer: &ContinuumAnswer, vectors: &[[f64; 3]]) -> PyResult<Bound<'py, PyAny>> {
    of_table(py, &answer.components(vectors), answer.dimension())
}

/// Refines the mesh of a scene until its error against the continuum is small enough.
///
/// The error is guaranteed where `docs/accuracy.md` says so, and estimated otherwise.
///
/// Parameters
/// ----------
/// scene : Scene
///     The scene, at rest.
/// goal : float
///     Largest error |u - v| / |v| in the energy norm, above 0 and below 1: 0.01 is 1 %.
/// force_error : float, optional
///     Largest error of the contact force, above 0 and below 1: half the width of its interval over the force. Only
///     with a guarantee.
/// time : float, optional
///     Limit in seconds, positive. After it the finest mesh so far is taken. No limit by default.
/// threads, memory : optional
///     As in `signorini.solve`.
///
/// Returns
/// -------
/// TotalError
///     The error that was reached, with the answer. It is returned even if it misses the goal: see its `status`.
///
/// Raises
/// ------
/// BadInput
///     An error, or another option, is out of its range.
/// BadType or TypeError
///     An argument has a wrong type.
/// SceneError
///     The scene cannot be built, has no answer in the continuum, or has no guarantee although `force_error` is given.
/// Interrupted
///     Ctrl-C was pressed. The exception carries the `TotalError` so far in `solution`, if there is one.
/// SignoriniError
///     As `signorini.solve`, for the first mesh.
#[pyfunction]
#[pyo3(signature = (scene, goal, *, force_error = None, time = None, threads = None, memory = None))]
pub fn total_error<'py>(
    scene: &Bound<'py, Scene>,
    goal: &Bound<'py, PyAny>,
    force_error: Option<Bound<'py, PyAny>>,
    time: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    memory: Option<Bound<'py, PyAny>>,
) -> PyResult<TotalError> {
    let py = scene.py();
    let force_error = force_error.map(|error| wanted("force_error", &error)).transpose()?;
    let goal = TotalErrorGoal { total_error: wanted("goal", goal)?, force_error };
    // A finer mesh may need any memory, so that the available memory is always determined.
    let settings = Options { time, threads, memory, ..Options::default() }.settings(None)?;
    let model = scene.get().model(py)?;
    let (of_answer, own) = (settings.goal(), scene.clone().unbind());
    let kept: Arc<Mutex<Option<study::TotalError>>> = Arc::default();
    let (inner, of_work, keeper) = (scene.get().inner.clone(), model.clone(), kept.clone());
    let search = move |watch: &Watch| {
        let keep = |found: &study::TotalError| {
            *keeper.lock().unwrap_or_else(PoisonError::into_inner) = Some(found.clone());
        };
        let settings = settings.watched(watch).started()?;
        study::TotalError::search(&inner, &of_work, goal, &settings, &keep)
    };
    match run(py, Place::Apart, search)? {
        End::Done(Ok(found)) => TotalError::new(py, &own, found, of_answer),
        End::Done(Err(error)) => Err(scene_exception(py, &own, &model, of_answer, error)),
        End::Signalled(signal, ended) => {
            let found =
                ended.and_then(Result::ok).or_else(|| kept.lock().unwrap_or_else(PoisonError::into_inner).take());
            let object = |found| Py::new(py, TotalError::new(py, &own, found, of_answer)?);
            let best = found.map(object).transpose()?.map(Py::into_any);
            Err(signalled(py, signal, best))
        }
    }
}

/// Reads an error that is asked for.
fn wanted(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let error = number(name, value)?;
    let sentence = || format!("{name} is {error}; it must be {}", TotalErrorGoal::ALLOWED);
    TotalErrorGoal::is_allowed(error).then_some(error).ok_or_else(|| bad_input(value.py(), sentence()))
}
