//! Derivatives of a solution: what its methods `vjp` and `jvp` do, and the objects that they return.

use std::sync::{Arc, PoisonError};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use signorini::qp::{self, Adjoint, Change, Derivative, Derivatives};
use signorini::{ContactProblem, Error, SparseMatrix, Watch};

use crate::arrays::{finite_reals, of_indices, of_reals};
use crate::errors::{bad_input, raised};
use crate::exceptions::{plain_exception, signalled};
use crate::matrices;
use crate::solution::{Solution, Source};
use crate::work::{End, Place, run};

/// The derivatives of an output phi with respect to all data, with some rows taken as closed and all others as open.
///
/// Each is in the unit of phi over that of the data. `Vjp.between` has such pieces. Arrays are read-only.
#[pyclass(frozen, module = "signorini")]
#[derive(Clone)]
pub struct Gradient {
    problem: Arc<ContactProblem>,
    inner: Adjoint,
}

#[pymethods]
impl Gradient {
    /// Derivatives with respect to the load f, shape (n,).
    #[getter]
    fn load<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.inner.of_load())
    }

    /// Derivatives with respect to the gaps g, shape (m,); zero on open rows. Positive: phi grows as the obstacle moves
    /// away.
    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.of_gap())
    }

    /// Derivatives with respect to the values e of the equality rows, shape (p,).
    #[getter]
    fn equality_values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.of_equality_values())
    }

    /// Derivatives with respect to the entries of K, shape (n, n): a symmetric `csc_array` of scipy on the pattern of
    /// K.
    ///
    /// For a symmetric change dK on that pattern d phi is `(stiffness * dK).sum()`, over both triangles. An entry off
    /// the diagonal and its mirror image each have half of the derivative with respect to both of them moved together.
    /// Needs scipy.
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let both = self.inner.of_stiffness(&self.problem).and_then(|lower| Ok(shared_out(&lower)?));
        matrices::csc(py, &both.map_err(|error| plain_exception(py, error))?)
    }

    /// Derivatives with respect to the entries of B, shape (m, n): a `csc_array` of scipy on the pattern of B.
    ///
    /// For a change dB d phi is `(rows * dB).sum()`. Needs scipy.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows = self.inner.of_rows(&self.problem);
        matrices::csc(py, &rows.map_err(|error| plain_exception(py, error))?)
    }

    /// Relative error of the linear solve: with a factor its last correction, with multigrid a bound in the energy
    /// norm.
    #[getter]
    fn error(&self) -> f64 {
        self.inner.error
    }

    fn __repr__(&self) -> String {
        let (dofs, rows) = (self.problem.dofs(), self.problem.inequalities());
        format!("<signorini.Gradient: {dofs} dofs, {rows} rows>")
    }
}

/// Both triangles of derivatives that stand in the lower one for both places of an entry: each place has half of it.
fn shared_out(lower: &SparseMatrix) -> Result<SparseMatrix, qp::LinearError> {
    let places = lower.triplets().flat_map(|(i, j, value)| match i == j {
        true => [Some((i, j, value)), None],
        false => [Some((i, j, 0.5 * value)), Some((j, i, 0.5 * value))],
    });
    SparseMatrix::from_triplets(lower.rows(), lower.columns(), &places.flatten().collect::<Vec<_>>())
}

/// The derivatives of displacement and multipliers along a change of the data, per unit of its parameter.
///
/// They belong to one side of a kink, or to one piece of the solution: see `Jvp`. Arrays are read-only.
#[pyclass(frozen, module = "signorini")]
#[derive(Clone)]
pub struct Tangent {
    problem: Arc<ContactProblem>,
    inner: qp::Tangent,
}

#[pymethods]
impl Tangent {
    /// Derivatives of the displacement u, shape (n,), in length per unit of the parameter.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.displacement)
    }

    /// Derivatives of the contact multipliers, shape (m,), in force per unit of the parameter; zero on open rows.
    #[getter]
    fn multiplier<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.multiplier[..self.problem.inequalities()])
    }

    /// Derivatives of the multipliers of the equality rows, shape (p,), in force per unit of the parameter.
    #[getter]
    fn equality_multiplier<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.multiplier[self.problem.inequalities()..])
    }

    /// Relative error, as `Gradient.error`; at a kink the error bound of the small contact problem, in the energy norm.
    #[getter]
    fn error(&self) -> f64 {
        self.inner.error
    }

    fn __repr__(&self) -> String {
        let (dofs, rows) = (self.problem.dofs(), self.problem.inequalities());
        format!("<signorini.Tangent: {dofs} dofs, {rows} rows>")
    }
}

/// A derivative with its verdict, as the classes `Vjp` and `Jvp` have it.
struct Judged<T> {
    derivative: Derivative<T>,
    /// The rows that are at a kink, or undecided.
    rows: Vec<usize>,
}

impl<T: Clone> Judged<T> {
    /// What is known, in one sentence; empty if the derivative is proven.
    fn why(&self) -> String {
        let rows: Vec<String> = self.rows.iter().take(10).map(ToString::to_string).collect();
        let more = if self.rows.len() > rows.len() {
            format!(" and {} more", self.rows.len() - rows.len())
        } else {
            String::new()
        };
        let rows = format!("{} {}{more}", if self.rows.len() == 1 { "row" } else { "rows" }, rows.join(", "));
        match &self.derivative {
            Derivative::Proven(_) => String::new(),
            Derivative::OneSided { .. } => {
                format!(
                    "the answer has a kink: gap and force of {rows} (from 0) are zero, and each side has a derivative of its own"
                )
            }
            Derivative::Undecided { .. } => {
                format!("no derivative is proven: {rows} (from 0) may be open or closed, as at a kink or close to it")
            }
            Derivative::Unknown { why } => format!("no derivative is known: {why}"),
        }
    }

    /// The exception of a derivative that is not proven.
    fn refused(&self, py: Python<'_>) -> PyErr {
        let about = PyDict::new(py);
        let filled = about
            .set_item("verdict", self.derivative.verdict())
            .and_then(|()| about.set_item("rows", of_indices(py, self.rows.iter().copied())?));
        match filled {
            Ok(()) => raised(py, "NoDerivative", &self.why(), &about),
            Err(error) => error,
        }
    }

    fn proven(&self, py: Python<'_>) -> PyResult<T> {
        self.derivative.proven().cloned().ok_or_else(|| self.refused(py))
    }

    fn between<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>>
    where
        T: IntoPyObject<'py>,
    {
        match &self.derivative {
            Derivative::Undecided { between, .. } => PyList::new(py, between.iter().cloned()),
            _ => Ok(PyList::empty(py)),
        }
    }
}

/// The derivatives of an output phi with respect to all data, with the verdict whether they exist. `Solution.vjp` makes
/// it.
///
/// If the verdict is not "proven", `load`, `gap`, `equality_values`, `stiffness`, `rows` and `error` raise
/// `NoDerivative`, which names the rows. `between` then has the derivatives of the pieces around.
#[pyclass(frozen, module = "signorini")]
pub struct Vjp {
    of: Judged<Gradient>,
}

#[pymethods]
impl Vjp {
    /// "proven", "undecided" or "unknown".
    ///
    /// "proven": every row is proven to be closed and to press, or to be open, so that there is one derivative.
    /// "undecided": the rows in `rows_at_kink` are at a kink, or the proof does not decide them. "unknown": no bound on
    /// the error of the solution is known.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.of.derivative.verdict()
    }

    /// Derivatives with respect to the load f, shape (n,). Raises `NoDerivative` if they are not proven.
    #[getter]
    fn load<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.load(py)
    }

    /// Derivatives with respect to the gaps g, shape (m,); zero on open rows. Raises `NoDerivative` if they are not
    /// proven.
    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.gap(py)
    }

    /// Derivatives with respect to the values e, shape (p,). Raises `NoDerivative` if they are not proven.
    #[getter]
    fn equality_values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.equality_values(py)
    }

    /// Derivatives with respect to the entries of K, shape (n, n), as `Gradient.stiffness`: d phi is `(stiffness *
    /// dK).sum()` over both triangles.
    ///
    /// Raises `NoDerivative` if they are not proven.
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.stiffness(py)
    }

    /// Derivatives with respect to the entries of B, shape (m, n), as `Gradient.rows`.
    ///
    /// Raises `NoDerivative` if they are not proven.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.rows(py)
    }

    /// Relative error of the linear solve, as `Gradient.error`. Raises `NoDerivative` if nothing is proven.
    #[getter]
    fn error(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.of.proven(py)?.error())
    }

    /// List of `Gradient`: with all rows of `rows_at_kink` open, then with all of them closed, as far as these exist.
    ///
    /// It is empty if the verdict is not "undecided". Of several rows some may be open and others closed; these pieces
    /// are not in the list.
    #[getter]
    fn between<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.of.between(py)
    }

    /// Indices of the rows that may be open or closed, counted from 0; empty if there are no such rows, or nothing is
    /// known.
    #[getter]
    fn rows_at_kink<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_indices(py, self.of.rows.iter().copied())
    }

    /// Why no derivative is proven, in one sentence; empty if it is.
    #[getter]
    fn why(&self) -> String {
        self.of.why()
    }

    fn __repr__(&self) -> String {
        format!("<signorini.Vjp: {}>", self.of.derivative.verdict())
    }
}

/// The derivatives of displacement and multipliers along a change of the data, with the verdict whether they exist.
///
/// `Solution.jvp` makes it. If the verdict is not "proven", `displacement`, `multiplier`, `equality_multiplier` and
/// `error` raise `NoDerivative`, which names the rows.
#[pyclass(frozen, module = "signorini")]
pub struct Jvp {
    of: Judged<Tangent>,
}

impl Jvp {
    /// The derivative for a falling and for a growing parameter.
    fn sides(&self, py: Python<'_>) -> PyResult<[Tangent; 2]> {
        match &self.of.derivative {
            Derivative::OneSided { left, right } => Ok([left.clone(), right.clone()]),
            _ => self.of.proven(py).map(|both| [both.clone(), both]),
        }
    }
}

#[pymethods]
impl Jvp {
    /// "proven", "one-sided", "undecided" or "unknown".
    ///
    /// "one-sided": gap and force of the rows in `rows_at_kink` are exactly zero, and `left` and `right` are the
    /// derivatives. The others are those of `Vjp.verdict`.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.of.derivative.verdict()
    }

    /// Derivatives of the displacement u, shape (n,), in length per unit of the parameter.
    ///
    /// Raises `NoDerivative` if they are not proven.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.displacement(py)
    }

    /// Derivatives of the contact multipliers, shape (m,), in force per unit of the parameter; zero on open rows.
    ///
    /// Raises `NoDerivative` if they are not proven.
    #[getter]
    fn multiplier<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.multiplier(py)
    }

    /// Derivatives of the multipliers of the equality rows, shape (p,), in force per unit of the parameter.
    ///
    /// Raises `NoDerivative` if they are not proven.
    #[getter]
    fn equality_multiplier<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.of.proven(py)?.equality_multiplier(py)
    }

    /// Relative error of the linear solve, as `Tangent.error`. Raises `NoDerivative` if nothing is proven.
    #[getter]
    fn error(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.of.proven(py)?.error())
    }

    /// The `Tangent` for a falling parameter; the derivative itself if it is proven.
    ///
    /// Raises `NoDerivative` if it is undecided or unknown.
    #[getter]
    fn left(&self, py: Python<'_>) -> PyResult<Tangent> {
        let [left, _] = self.sides(py)?;
        Ok(left)
    }

    /// The `Tangent` for a growing parameter; the derivative itself if it is proven.
    ///
    /// Raises `NoDerivative` if it is undecided or unknown.
    #[getter]
    fn right(&self, py: Python<'_>) -> PyResult<Tangent> {
        let [_, right] = self.sides(py)?;
        Ok(right)
    }

    /// List of `Tangent`: with all rows of `rows_at_kink` open, then with all of them closed, as far as these exist.
    ///
    /// It is empty if the verdict is not "undecided".
    #[getter]
    fn between<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.of.between(py)
    }

    /// Indices of the rows that may be open or closed, counted from 0; empty if there are no such rows, or nothing is
    /// known.
    #[getter]
    fn rows_at_kink<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_indices(py, self.of.rows.iter().copied())
    }

    /// Why no derivative is proven, in one sentence; empty if it is.
    #[getter]
    fn why(&self) -> String {
        self.of.why()
    }

    fn __repr__(&self) -> String {
        format!("<signorini.Jvp: {}>", self.of.derivative.verdict())
    }
}

/// What `work` returns without the interpreter.
fn done<T: Send + 'static>(
    py: Python<'_>,
    place: Place,
    work: impl FnOnce(&Watch) -> Result<T, qp::Error> + Send + 'static,
) -> PyResult<T> {
    match run(py, place, work)? {
        End::Done(done) => done.map_err(|error| plain_exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}

/// What a solution was computed from, and its derivatives, which it keeps.
fn derivatives_of(solution: &Bound<'_, Solution>) -> PyResult<(Source, Derivatives)> {
    let (py, own) = (solution.py(), solution.get());
    let Some(source) = own.source.clone() else {
        let sentence =
            "this solution, of an exception of many problems, does not keep its problem; solve that problem alone";
        return Err(bad_input(py, sentence));
    };
    let kept = || own.derivatives.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = kept().clone() {
        return Ok((source, known));
    }
    let (of_work, answer) = (source.clone(), own.inner.clone());
    let place = Place::for_problem(&source.problem);
    let found = done(py, place, move |watch| of_work.derivatives(&answer, watch))?;
    Ok((source, kept().get_or_insert(found).clone()))
}

/// The values of the argument `name`, of this length; zeros if it is not given.
fn given(
    py: Python<'_>,
    name: &str,
    values: Option<&Bound<'_, PyAny>>,
    (length, what): (usize, &str),
) -> PyResult<Vec<f64>> {
    let Some(values) = values else { return Ok(vec![0.0; length]) };
    let values = finite_reals(name, values)?;
    let found = values.len();
    let sentence = || format!("{name} has length {found}, but the number of {what} is {length}");
    if found == length { Ok(values) } else { Err(bad_input(py, sentence())) }
}

/// The derivatives of an output with these derivatives by displacement and multipliers.
#[pyfunction]
#[pyo3(name = "_vjp")]
pub fn vjp(
    solution: &Bound<'_, Solution>,
    displacement: Option<&Bound<'_, PyAny>>,
    multiplier: Option<&Bound<'_, PyAny>>,
    equality_multiplier: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vjp> {
    let (py, answer) = (solution.py(), &solution.get().inner);
    let [dofs, rows, equalities] = sizes(answer);
    let by_displacement = given(py, "displacement", displacement, dofs)?;
    let mut by_multiplier = given(py, "multiplier", multiplier, rows)?;
    by_multiplier.extend(given(py, "equality_multiplier", equality_multiplier, equalities)?);
    let (source, derivatives) = derivatives_of(solution)?;
    let (rows, place) = (derivatives.at_kink().to_vec(), Place::for_problem(&source.problem));
    let found = done(py, place, move |watch| derivatives.watched(watch).adjoint(&by_displacement, &by_multiplier))?;
    let derivative = found.map(|inner| Gradient { problem: source.problem.clone(), inner: inner.clone() });
    Ok(Vjp { of: Judged { derivative, rows } })
}

/// The derivatives of displacement and multipliers along a change of the data.
#[pyfunction]
#[pyo3(name = "_jvp")]
pub fn jvp(
    solution: &Bound<'_, Solution>,
    load: Option<&Bound<'_, PyAny>>,
    gap: Option<&Bound<'_, PyAny>>,
    stiffness: Option<&Bound<'_, PyAny>>,
    rows: Option<&Bound<'_, PyAny>>,
    equality_values: Option<&Bound<'_, PyAny>>,
) -> PyResult<Jvp> {
    let (py, answer) = (solution.py(), solution.get().inner.clone());
    let [dofs, of_rows, equalities] = sizes(&answer);
    let load = given(py, "load", load, dofs)?;
    let mut distance = given(py, "gap", gap, of_rows)?;
    distance.extend(given(py, "equality_values", equality_values, equalities)?);
    let stiffness = stiffness.map(|stiffness| matrices::stiffness("stiffness", stiffness)).transpose()?;
    let rows = rows.map(|rows| matrices::rows("rows", rows, dofs.0)).transpose()?;
    let shape = (of_rows.0, dofs.0);
    if let Some(rows) = rows.as_ref().filter(|rows| (rows.rows(), rows.columns()) != shape) {
        let found = (rows.rows(), rows.columns());
        let sentence = format!("rows is {} x {}; it must be {} x {}, as B is", found.0, found.1, shape.0, shape.1);
        return Err(bad_input(py, sentence));
    }
    let changed = || -> Result<Change, Error> {
        let mut change = Change { load, distance };
        if let Some(stiffness) = stiffness {
            change = change.with_stiffness(&stiffness, &answer.displacement)?;
        }
        if let Some(rows) = rows {
            // Equality rows do not change.
            let entries: Vec<_> = rows.triplets().collect();
            let rows = SparseMatrix::from_triplets(of_rows.0 + equalities.0, dofs.0, &entries)?;
            let multiplier = [answer.multiplier.as_slice(), &answer.equality_multiplier].concat();
            change = change.with_rows(&rows, &answer.displacement, &multiplier)?;
        }
        Ok(change)
    };
    let change = changed().map_err(|error| plain_exception(py, error))?;
    let (source, derivatives) = derivatives_of(solution)?;
    let (rows, place) = (derivatives.at_kink().to_vec(), Place::for_problem(&source.problem));
    let found = done(py, place, move |watch| derivatives.watched(watch).tangent(&change))?;
    let derivative = found.map(|inner| Tangent { problem: source.problem.clone(), inner: inner.clone() });
    Ok(Jvp { of: Judged { derivative, rows } })
}

/// The numbers of dofs, contact rows and equality rows of an answer, each with its name.
fn sizes(answer: &signorini::Solution) -> [(usize, &'static str); 3] {
    [
        (answer.displacement.len(), "dofs"),
        (answer.multiplier.len(), "contact rows"),
        (answer.equality_multiplier.len(), "equality rows"),
    ]
}
