//! Scenes, and their answers with stresses, pressures and resultants.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use signorini::scene::Answer;
use signorini::study::scene_summary;
use signorini::{Error, Goal, Model, Settings, Watch};

use crate::arrays::{kind_of, of_indices, of_reals, of_table};
use crate::errors::{bad_type, exception, plain_exception};
use crate::options::Options;
use crate::problem::Problem;
use crate::solution::{Solution, as_object};
use crate::solving::{answered, signalled, solve_from, start_of};
use crate::work::{End, Place, run};

/// A contact scene.
#[pyclass(frozen, module = "signorini")]
pub struct Scene {
    pub inner: Arc<signorini::Scene>,
    /// Its file, for the line and column of a value at fault.
    file: Option<PathBuf>,
    model: Mutex<Option<Arc<Model>>>,
}

impl Scene {
    /// The model, built when it is first asked for.
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
        // Another thread may have been faster: then its model is the one that all share.
        Ok(kept().get_or_insert(model).clone())
    }

    /// Refuses a scene whose motion is asked for.
    pub fn check_rest(&self, py: Python<'_>) -> PyResult<()> {
        if self.inner.analysis.is_none() {
            return Ok(());
        }
        let message = "the scene moves; run `signorini solve` for its motion, or leave the analysis out for its rest";
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

/// The text of a scene that came as a dictionary.
fn text_of(source: &Bound<'_, PyAny>) -> PyResult<String> {
    source.py().import("signorini._show")?.call_method1("scene_text", (source,))?.extract()
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (source, *, folder = None, allow_outside = false))]
    fn new(source: &Bound<'_, PyAny>, folder: Option<PathBuf>, allow_outside: bool) -> PyResult<Self> {
        let py = source.py();
        let is_mapping = source.cast::<PyDict>().is_ok();
        let (scene, file) = match (is_mapping, source.extract::<PathBuf>()) {
            (true, _) => {
                let scene = signorini::Scene::from_json(&text_of(source)?, "scene");
                let scene = scene.map(|scene| signorini::Scene { folder: Some(folder.unwrap_or_default()), ..scene });
                (scene, None)
            }
            (false, Ok(path)) => (signorini::Scene::read(&path), Some(path)),
            (false, Err(_)) => {
                let kind = kind_of(source);
                return Err(bad_type(py, format!("a scene is made of a file name or a dictionary, not of a {kind}")));
            }
        };
        let scene = scene.map_err(|error| plain_exception(py, error))?;
        let inner = Arc::new(signorini::Scene { reads_outside: allow_outside, ..scene });
        Ok(Scene { inner, file, model: Mutex::new(None) })
    }

    /// What the scene shows.
    #[getter]
    fn title(&self) -> &str {
        &self.inner.title
    }

    /// Names of the units: of length, force and pressure.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (named, units) = (PyDict::new(py), &self.inner.units);
        named.set_item("length", &units.length)?;
        named.set_item("force", &units.force)?;
        named.set_item("pressure", units.pressure())?;
        Ok(named)
    }

    /// The contact problem in the free dofs.
    #[getter]
    fn problem(&self, py: Python<'_>) -> PyResult<Problem> {
        Ok(self.model(py)?.problem().clone().into())
    }

    /// Coordinates of the nodes, one row each.
    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let model = self.model(py)?;
        let dimension = model.mesh().dimension();
        let values: Vec<f64> = model.mesh().nodes().iter().flat_map(|node| &node[..dimension]).copied().collect();
        of_table(py, &values, dimension)
    }

    /// Nodes of the elements, one row each.
    #[getter]
    fn elements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let model = self.model(py)?;
        let count = model.mesh().element_count();
        let nodes = of_indices(py, model.mesh().elements().flatten().copied())?;
        let of_each = nodes.len()?.checked_div(count).unwrap_or(0);
        nodes.call_method1("reshape", (count, of_each))
    }

    /// Name of the elements, as Q4.
    #[getter]
    fn element_kind(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(self.model(py)?.mesh().kind().name())
    }

    /// What the contact rows stand for: arrays with an entry for each row.
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

    /// What a reader of the answer should know, in sentences.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.model(py)?.warnings().iter().map(ToString::to_string).collect())
    }

    /// Solves the scene.
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

    /// Solves the scene by three methods.
    fn compare(slf: &Bound<'_, Self>) -> PyResult<crate::study::Comparison> {
        crate::study::compared_scene(slf)
    }

    fn __repr__(&self) -> String {
        let size = self.inner.size();
        let title = if self.inner.title.is_empty() { "without a title" } else { &self.inner.title };
        format!("<signorini.Scene: {title}, about {:.0} dofs>", size.dofs)
    }
}

/// The answer to a scene.
#[pyclass(frozen, module = "signorini", extends = Solution)]
pub struct SceneSolution {
    scene: Py<Scene>,
    answer: Arc<Answer>,
    goal: Goal,
}

impl SceneSolution {
    /// The object of an answer.
    pub fn object(
        py: Python<'_>,
        scene: Py<Scene>,
        model: Arc<Model>,
        solution: signorini::Solution,
        goal: Goal,
    ) -> PyResult<Py<PyAny>> {
        let answer = Arc::new(Answer::of(model, &solution).map_err(|error| plain_exception(py, error))?);
        let base = PyClassInitializer::from(Solution::new(solution));
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
    /// The scene.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Displacement of the nodes, one row each.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_table(py, self.answer.displacement(), self.dimension())
    }

    /// Contact pressure of each row, >= 0.
    #[getter]
    fn pressure<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.answer.pressure())
    }

    /// What is left of the gap of each row.
    #[getter]
    fn remaining_gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.answer.remaining_gaps())
    }

    /// Stress at the nodes: xx, yy, zz, xy, yz, zx.
    #[getter]
    fn stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.stresses(py, |field| &field.nodes)
    }

    /// Stress at the middle of the elements: xx, yy, zz, xy, yz, zx.
    #[getter]
    fn element_stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.stresses(py, |field| &field.elements)
    }

    /// Von Mises stress at the nodes.
    #[getter]
    fn von_mises<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let field = self.answer.stress().map_err(|error| plain_exception(py, error))?;
        let values: Vec<f64> = field.nodes.iter().map(|stress| stress.von_mises).collect();
        of_reals(py, &values)
    }

    /// Contact forces on the nodes, one row each.
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let forces = self.answer.forces().map_err(|error| plain_exception(py, error))?;
        of_table(py, &forces.contact, self.dimension())
    }

    /// Support reactions on the nodes, one row each.
    #[getter]
    fn reactions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let forces = self.answer.forces().map_err(|error| plain_exception(py, error))?;
        of_table(py, &forces.reactions, self.dimension())
    }

    /// Forces, moments and centres of obstacles, supports and loads.
    #[getter]
    fn resultants<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let all = self.answer.resultants().map_err(|error| plain_exception(py, error))?;
        Ok(as_object(py, &all)?.cast_into()?)
    }

    /// The report of the program.
    fn report<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        let solution = (*slf.as_super().get().inner).clone();
        let summary =
            scene_summary(&own.answer, solution, own.goal, 0.0).map_err(|error| plain_exception(py, error))?;
        as_object(py, &summary)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("scene_html", (slf,))
    }

    /// Draws the moved mesh with its von Mises stress.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("scene_plot", (slf, ax))
    }

    /// The mesh with displacement and stress, for pyvista.
    fn to_pyvista<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("scene_to_pyvista", (slf,))
    }
}

/// The exception of an error to a scene, with the object of the best answer.
pub fn scene_exception(py: Python<'_>, scene: &Py<Scene>, model: &Arc<Model>, goal: Goal, error: Error) -> PyErr {
    exception(py, model.explain(error), |solution| {
        SceneSolution::object(py, scene.clone_ref(py), model.clone(), solution, goal)
    })
}
