//! Scenes, and their solutions with stresses, pressures and resultants.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use signorini::fem::ElementKind;
use signorini::scene::Answer;
use signorini::study::Summary;
use signorini::{Error, Goal, Model, Settings, Watch};

use crate::answered::{answered, solve_from, start_of};
use crate::arrays::{kind_of, of_indices, of_reals, of_table};
use crate::errors::bad_type;
use crate::exceptions::signalled;
use crate::exceptions::{exception, plain_exception};
use crate::options::Options;
use crate::problem::Problem;
use crate::solution::{Solution, Source, as_object};
use crate::work::{End, Place, run};

/// A contact scene: bodies, supports, loads and obstacles. `docs/scenes.md` describes its keys.
///
/// The mesh and the matrices are built when something first needs them. `solve`, `compare`, `problem`, `nodes`,
/// `elements`, `element_kinds`, `rows`, `outputs` and `warnings` then raise what building raises: `SceneError` for a
/// scene that cannot be built or that moves, `FileError` for a mesh file that cannot be read, `TooLarge` if the memory
/// does not suffice, and `Interrupted`.
///
/// Parameters
/// ----------
/// source : str, path or dict
///     The name of a JSON file, the name of a deck of CalculiX (`.inp`), or a dictionary with the same keys as the
///     JSON. Its numbers may be numbers or arrays of numpy.
/// folder : str or path, optional
///     The folder of the files that a dictionary names. The current folder by default.
/// allow_outside : bool, optional
///     True lets the scene read files outside of its folder. False by default.
/// without_friction : bool, optional
///     True leaves the friction of a deck out. False (the default) refuses such a deck.
/// linear : bool, optional
///     True gives the solution of small displacements whatever its strains and rotations are. False (the default)
///     raises `BeyondSmallDisplacements` if they are above 50 %, and refuses those above 5 % of a deck that asks for
///     large displacements (NLGEOM).
/// step : int, optional
///     The step of a deck, from 1. The last step by default.
///
/// Raises
/// ------
/// SceneError
///     A value is not allowed; the exception has its JSON path, and line and column in a file. Or an option for decks
///     is given for another source.
/// FileError
///     A file cannot be read.
/// BadType or TypeError
///     An argument has a wrong type, or the dictionary cannot be written as JSON.
/// OverflowError
///     `step` is negative.
#[pyclass(frozen, module = "signorini")]
pub struct Scene {
    pub inner: Arc<signorini::Scene>,
    /// The file of the scene, for the line and column in messages.
    file: Option<PathBuf>,
    model: Mutex<Option<Arc<Model>>>,
}

impl Scene {
    /// Returns the model, which is built at the first call.
    pub fn model(&self, py: Python<'_>) -> PyResult<Arc<Model>> {
        let kept = || self.model.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(model) = kept().clone() {
            return Ok(model);
        }
        self.check_rest(py)?;
        let (scene, file) = (self.inner.clone(), self.file.clone());
        let build = move |_: &Watch| built(&scene, file);
        let model = match run(py, Place::Apart, build)? {
            End::Done(Ok(model)) => Arc::new(model),
            End::Done(Err(error)) => return Err(plain_exception(py, error)),
            End::Signalled(signal, _) => return Err(signalled(py, signal, None)),
        };
        // If another thread was faster, all threads share its model.
        Ok(kept().get_or_insert(model).clone())
    }

    /// The same scene with another mesh.
    pub fn on(&self, model: Arc<Model>) -> Self {
        Scene { inner: self.inner.clone(), file: self.file.clone(), model: Mutex::new(Some(model)) }
    }

    /// Refuses a scene with an analysis of a motion.
    pub fn check_rest(&self, py: Python<'_>) -> PyResult<()> {
        if self.inner.analysis.is_none() {
            return Ok(());
        }
        let message =
            "the scene moves; run `signorini solve` to compute its motion, or leave out `analysis` for a static solve";
        Err(plain_exception(py, Error::Scene { path: "analysis".into(), message: message.into() }))
    }
}

fn built(scene: &signorini::Scene, file: Option<PathBuf>) -> Result<Model, Error> {
    let most = Settings::default().with_available_memory().memory;
    scene.check_size_without_factor(most.unwrap_or(f64::INFINITY))?;
    scene.build().map_err(|error| match &file {
        Some(file) => signorini::Scene::located(error, file),
        None => error,
    })
}

/// Returns the JSON text of a scene that is given as a dictionary.
fn text_of(source: &Bound<'_, PyAny>) -> PyResult<String> {
    source.py().import("signorini._show")?.call_method1("scene_text", (source,))?.extract()
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (source, *, folder = None, allow_outside = false, without_friction = false, linear = false, step = None))]
    fn new(
        source: &Bound<'_, PyAny>,
        folder: Option<PathBuf>,
        allow_outside: bool,
        without_friction: bool,
        linear: bool,
        step: Option<usize>,
    ) -> PyResult<Self> {
        let py = source.py();
        let is_mapping = source.cast::<PyDict>().is_ok();
        let is_deck = source.extract::<PathBuf>().is_ok_and(signorini::Scene::is_deck);
        if !is_deck && (without_friction || step.is_some()) {
            let message = "`without_friction` and `step` are for decks of CalculiX, whose names end with .inp";
            return Err(plain_exception(py, Error::Scene { path: "source".into(), message: message.into() }));
        }
        let (scene, file) = match (is_mapping, source.extract::<PathBuf>()) {
            (true, _) => {
                let scene = signorini::Scene::from_json(&text_of(source)?, "scene");
                let scene = scene.map(|scene| signorini::Scene { folder: Some(folder.unwrap_or_default()), ..scene });
                (scene, None)
            }
            (false, Ok(path)) if is_deck => {
                let named = [("outside", allow_outside), ("friction", without_friction)];
                let permits: Vec<&str> =
                    named.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
                (signorini::Scene::read_deck(&path, &permits, step), Some(path))
            }
            (false, Ok(path)) => (signorini::Scene::read(&path), Some(path)),
            (false, Err(_)) => {
                let kind = kind_of(source);
                return Err(bad_type(py, format!("a scene is made of a file name or a dictionary, not of a {kind}")));
            }
        };
        let scene = scene.map_err(|error| plain_exception(py, error))?;
        let inner = Arc::new(signorini::Scene { reads_outside: allow_outside, is_linear: linear, ..scene });
        Ok(Scene { inner, file, model: Mutex::new(None) })
    }

    /// Title of the scene; empty if it has none.
    #[getter]
    fn title(&self) -> &str {
        &self.inner.title
    }

    /// Names of the numbers of the scene by which outputs have derivatives, and "nodes" for the places of all nodes.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.inner.parameters()
    }

    /// Names of the outputs that have derivatives. X,Y stands for the coordinates of a place, in length.
    #[getter]
    fn outputs(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let model = self.model(py)?;
        Ok(signorini::scene::outputs_of(&model))
    }

    /// Returns the same scene with another value of one parameter.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     One of `parameters`, for example "gap" or "young". "loads[0]" is a factor of that load.
    /// value : float
    ///     The new value, in the unit of the parameter.
    ///
    /// Returns
    /// -------
    /// Scene
    ///     A new scene; this one does not change.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     The name does not exist, or the scene does not allow the value.
    /// TypeError
    ///     An argument has a wrong type.
    fn with_parameter(&self, py: Python<'_>, name: &str, value: f64) -> PyResult<Self> {
        let inner = self.inner.with_parameter(name, value).map_err(|error| plain_exception(py, error))?;
        Ok(Scene { inner: Arc::new(inner), file: self.file.clone(), model: Mutex::new(None) })
    }

    /// Names of the units, a dictionary with "length", "force" and "pressure". They are empty if the scene names no
    /// units.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (named, units) = (PyDict::new(py), &self.inner.units);
        named.set_item("length", &units.length)?;
        named.set_item("force", &units.force)?;
        named.set_item("pressure", units.pressure())?;
        Ok(named)
    }

    /// The contact problem in the free dofs, a `Problem`. Supported dofs are left out.
    #[getter]
    fn problem(&self, py: Python<'_>) -> PyResult<Problem> {
        Ok(self.model(py)?.problem().clone().into())
    }

    /// Coordinates of the nodes, shape (nodes, dim), in length, read-only. dim is 1, 2 or 3.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let model = self.model(py)?;
        let dimension = model.mesh().dimension();
        let values: Vec<f64> = model.mesh().nodes().iter().flat_map(|node| &node[..dimension]).copied().collect();
        of_table(py, &values, dimension)
    }

    /// Node numbers of the elements, shape (elements, most nodes of an element), counted from 0, in the order of VTK.
    ///
    /// An element that has fewer nodes than others has -1 after its last node.
    #[getter]
    fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let model = self.model(py)?;
        let mesh = model.mesh();
        let most = mesh.kinds().map(ElementKind::nodes).max().unwrap_or(0);
        // In 64 bits this is -1.
        let none = || std::iter::repeat(usize::MAX);
        let padded = mesh.elements().flat_map(|nodes| nodes.iter().copied().chain(none()).take(most));
        of_indices(py, padded)?.call_method1("reshape", (mesh.element_count(), most))
    }

    /// Names of the kinds of the elements, one per element, for example "Q4".
    #[getter]
    fn element_kinds(&self, py: Python<'_>) -> PyResult<Vec<&'static str>> {
        let model = self.model(py)?;
        let mesh = model.mesh();
        Ok((0..mesh.element_count()).map(|element| mesh.kind_of(element).name()).collect())
    }

    /// What the m contact rows mean, a dictionary of arrays.
    ///
    /// "node" and "obstacle" have shape (m,) and count from 0. "normal" has shape (m, dim): a unit vector towards the
    /// obstacle. "gap" has shape (m,), in length, negative if the obstacle starts inside the body. "area" has shape
    /// (m,), the tributary area; force over area is the pressure.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let model = self.model(py)?;
        let (rows, dimension) = (model.rows(), model.mesh().dimension());
        let table = PyDict::new(py);
        table.set_item("node", of_indices(py, rows.iter().map(|row| row.node))?)?;
        table.set_item("obstacle", of_indices(py, rows.iter().map(|row| row.obstacle))?)?;
        let normals: Vec<f64> = rows.iter().flat_map(|row| row.normal[..dimension].to_vec()).collect();
        table.set_item("normal", of_table(py, &normals, dimension)?)?;
        let gaps: Vec<f64> = rows.iter().map(|row| row.gap).collect();
        table.set_item("gap", of_reals(py, &gaps)?)?;
        let areas: Vec<f64> = rows.iter().map(|row| row.tributary_area).collect();
        table.set_item("area", of_reals(py, &areas)?)?;
        Ok(table)
    }

    /// Warnings about the scene, a list with one sentence each.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.model(py)?.warnings().iter().map(ToString::to_string).collect())
    }

    /// Solves the scene. The solution is certified as that of `signorini.solve`.
    ///
    /// Parameters
    /// ----------
    /// method, accuracy, time, start, threads, tolerance, memory, precision, condense, proof : optional
    ///     As in `signorini.solve`.
    ///
    /// Returns
    /// -------
    /// SceneSolution
    ///     The displacements of all nodes, with stresses, pressures and forces.
    ///
    /// Raises
    /// ------
    /// SceneError, FileError or TooLarge
    ///     The scene cannot be built.
    /// SignoriniError, TypeError or Interrupted
    ///     As `signorini.solve`.
    #[pyo3(signature = (
        *, method = None, accuracy = None, time = None, start = None, threads = None, tolerance = None, memory = None,
        precision = None, condense = true, proof = true
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn solve<'py>(
        slf: &Bound<'py, Self>,
        method: Option<Bound<'py, PyAny>>,
        accuracy: Option<Bound<'py, PyAny>>,
        time: Option<Bound<'py, PyAny>>,
        start: Option<Bound<'py, PyAny>>,
        threads: Option<Bound<'py, PyAny>>,
        tolerance: Option<Bound<'py, PyAny>>,
        memory: Option<Bound<'py, PyAny>>,
        precision: Option<Bound<'py, PyAny>>,
        condense: bool,
        proof: bool,
    ) -> PyResult<Py<PyAny>> {
        let py = slf.py();
        let (condense, proof) = (Some(condense), Some(proof));
        let options = Options { method, accuracy, tolerance, time, threads, memory, precision, condense, proof };
        let model = slf.get().model(py)?;
        let settings = options.settings(Some(model.problem()))?;
        let start = start_of(start.as_ref(), model.problem())?;
        let (goal, place, of_work) = (settings.goal(), Place::for_problem(model.problem()), model.clone());
        let find = move |watch: &Watch| {
            let solved = solve_from(of_work.problem(), start, &settings.watched(watch));
            solved.map_err(|error| of_work.explain(error))
        };
        let scene = slf.clone().unbind();
        answered(py, place, find, |solution| {
            SceneSolution::object(py, scene.clone_ref(py), model.clone(), solution, goal)
        })
    }

    /// Solves the scene by interior point, active set and penalty, and compares the solutions:
    /// `signorini.compare(scene)`.
    ///
    /// Returns
    /// -------
    /// Comparison
    ///     The three solutions and their differences.
    ///
    /// Raises
    /// ------
    /// SceneError, FileError or TooLarge
    ///     The scene cannot be built.
    /// SignoriniError or Interrupted
    ///     As `signorini.compare`.
    fn compare<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._signorini")?.call_method1("compare", (slf,))
    }

    fn __repr__(&self) -> String {
        let built = self.model.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let dofs_of = |model: Arc<Model>| (model.mesh().dimension() * model.mesh().nodes().len()) as f64;
        let dofs = built.map_or_else(|| self.inner.size().dofs, dofs_of);
        let title = if self.inner.title.is_empty() { "without a title" } else { &self.inner.title };
        format!("<signorini.Scene: {title}, about {dofs:.0} dofs>")
    }
}

/// The solution of a scene: a `Solution` with stresses, pressures and forces. `Scene.solve` makes it.
///
/// Arrays of nodes have one row per node, supported nodes included, with dim columns (1, 2 or 3). Arrays are read-only.
/// Units are those of the scene.
#[pyclass(frozen, module = "signorini", extends = Solution)]
pub struct SceneSolution {
    scene: Py<Scene>,
    answer: Arc<Answer>,
    goal: Goal,
}

impl SceneSolution {
    /// Makes the Python object of a solution.
    pub fn object(
        py: Python<'_>,
        scene: Py<Scene>,
        model: Arc<Model>,
        solution: signorini::Solution,
        goal: Goal,
    ) -> PyResult<Py<PyAny>> {
        let answer = Answer::of(model.clone(), &solution).map_err(|error| {
            exception(py, error, |solution| {
                let answer = Answer::of_any_size(model, &solution).map_err(|error| plain_exception(py, error))?;
                Self::of(py, scene.clone_ref(py), answer, solution, goal)
            })
        })?;
        if answer.model().warnings().iter().any(|warning| warning.code == "nonlinear") {
            // The report refuses large strains and rotations of a deck that asks for large displacements.
            Summary::of_answer(&answer, solution.clone(), goal, 0.0).map_err(|error| plain_exception(py, error))?;
        }
        Self::of(py, scene, answer, solution, goal)
    }

    /// Makes the Python object of a solution whose answer is known.
    pub fn of(
        py: Python<'_>,
        scene: Py<Scene>,
        answer: Answer,
        solution: signorini::Solution,
        goal: Goal,
    ) -> PyResult<Py<PyAny>> {
        let answer = Arc::new(answer);
        let problem = answer.model().problem();
        let settings = Options::default().settings(Some(problem))?;
        let source = Source { problem: Arc::new(problem.clone()), settings, prepared: None };
        let base = PyClassInitializer::from(Solution::new(solution, Some(source)));
        Ok(Py::new(py, base.add_subclass(SceneSolution { scene, answer, goal }))?.into_any())
    }

    fn dimension(&self) -> usize {
        self.answer.model().mesh().dimension()
    }

    fn stresses<'py>(
        &self,
        py: Python<'py>,
        of: impl FnOnce(&signorini::fem::StressField) -> &Vec<signorini::fem::Stress>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let field = self.answer.stress().map_err(|error| plain_exception(py, error))?;
        let components = |stress: &signorini::fem::Stress| {
            [stress.sigma_xx, stress.sigma_yy, stress.sigma_zz, stress.sigma_xy, stress.sigma_yz, stress.sigma_zx]
        };
        let values: Vec<f64> = of(field).iter().flat_map(components).collect();
        of_table(py, &values, 6)
    }
}

#[pymethods]
impl SceneSolution {
    /// The scene that was solved, a `Scene`.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Displacements of all nodes, shape (nodes, dim), in length, along the axes.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_table(py, self.answer.displacement(), self.dimension())
    }

    /// Contact pressure of each row, shape (m,), >= 0, in pressure.
    #[getter]
    fn pressure<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.answer.pressure())
    }

    /// Gap of each row after the deformation, shape (m,), in length; 0 except for rounding where the row is closed.
    #[getter]
    fn remaining_gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.answer.remaining_gaps())
    }

    /// Stress at the nodes, shape (nodes, 6): xx, yy, zz, xy, yz, zx, in pressure; tension is positive.
    #[getter]
    fn stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.stresses(py, |field| &field.nodes)
    }

    /// Stress at the centres of the elements, shape (elements, 6): xx, yy, zz, xy, yz, zx, in pressure; tension is
    /// positive.
    #[getter]
    fn element_stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.stresses(py, |field| &field.elements)
    }

    /// Von Mises stress at the nodes, shape (nodes,), >= 0, in pressure.
    #[getter]
    fn von_mises<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let field = self.answer.stress().map_err(|error| plain_exception(py, error))?;
        let values: Vec<f64> = field.nodes.iter().map(|stress| stress.von_mises).collect();
        of_reals(py, &values)
    }

    /// Contact forces on the body at the nodes, shape (nodes, dim), in force, along the axes.
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let forces = self.answer.forces().map_err(|error| plain_exception(py, error))?;
        of_table(py, &forces.contact, self.dimension())
    }

    /// Forces of the supports on the body at the nodes, shape (nodes, dim), in force, along the axes.
    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let forces = self.answer.forces().map_err(|error| plain_exception(py, error))?;
        of_table(py, &forces.reactions, self.dimension())
    }

    /// Sums of the forces on the body, one dictionary for each obstacle, each support, and the loads.
    ///
    /// "of" names the source, for example "obstacles[0]". "force" has dim components, in force. "moment" is about the
    /// origin, in force times length. "centre" is a point on the line of action, in length, or None if the forces
    /// cancel. "nodes" is the number of nodes on which they act. "travel" of an obstacle that a force presses, "motion"
    /// of a rigid face and "shortening" of a bolt are in length.
    #[getter]
    fn resultants<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let all = self.answer.resultants().map_err(|error| plain_exception(py, error))?;
        Ok(as_object(py, &all)?.cast_into()?)
    }

    /// Returns the report that `signorini solve --format json` prints, without the seconds of the assembly.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Its keys are those of the program. A number that is not finite is None.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     Strains or rotations are above 5 %, and the deck asks for large displacements.
    fn report<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        let solution = (*slf.as_super().get().inner).clone();
        let summary =
            Summary::of_answer(&own.answer, solution, own.goal, 0.0).map_err(|error| plain_exception(py, error))?;
        as_object(py, &summary)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("scene_html", (slf,))
    }

    /// Draws the deformed mesh with its von Mises stress; for a body in space or a bar the contact force of each row.
    ///
    /// Needs matplotlib: `pip install "signorini[plot]"`.
    ///
    /// Parameters
    /// ----------
    /// ax : Axes of matplotlib, optional
    ///     Where to draw. A new figure by default.
    ///
    /// Returns
    /// -------
    /// Axes of matplotlib
    ///     `ax`, or the new axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     matplotlib is not installed.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("scene_plot", (slf, ax))
    }

    /// Returns the undeformed mesh with its results. Needs pyvista: `pip install "signorini[pyvista]"`.
    ///
    /// Returns
    /// -------
    /// UnstructuredGrid of pyvista
    ///     `point_data` has "displacement", shape (nodes, 3), "stress", shape (nodes, 6), and "von_mises", shape
    ///     (nodes,).
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     pyvista is not installed.
    fn to_pyvista<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("scene_to_pyvista", (slf,))
    }
}

/// Makes the exception for an error of a scene, with the Python object of the best solution.
pub fn scene_exception(
    py: Python<'_>,
    scene: &Py<Scene>,
    model: &Arc<Model>,
    goal: Goal,
    error: impl Into<Error>,
) -> PyErr {
    exception(py, model.explain(error), |solution| {
        SceneSolution::object(py, scene.clone_ref(py), model.clone(), solution, goal)
    })
}
