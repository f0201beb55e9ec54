//! Solutions and their certificates.

use std::sync::{Arc, Mutex};

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList};
use signorini::qp::{Derivatives, Error};
use signorini::{ContactProblem, ContactSet, Prepared, Settings, Solution as Answer, Watch};

use crate::arrays::{of_indices, of_reals};

/// What a solution was computed from.
#[derive(Clone)]
pub struct Source {
    /// The problem, with its load and gaps.
    pub problem: Arc<ContactProblem>,
    pub settings: Settings,
    /// The prepared data, at any load and gaps.
    pub prepared: Option<Prepared>,
}

impl Source {
    /// The same at this load and these gaps.
    pub fn at(&self, load: Vec<f64>, gap: Vec<f64>) -> Result<Self, Error> {
        Ok(Source { problem: Arc::new(self.problem.with(load, gap)?), ..self.clone() })
    }

    /// The derivatives of an answer, by the prepared data if there are some.
    pub fn derivatives(&self, answer: &Answer, watch: &Watch) -> Result<Derivatives, Error> {
        // The limit of time is that of the solve.
        let mut settings = self.settings.clone().watched(watch);
        settings.time = None;
        let Some(prepared) = &self.prepared else { return self.problem.derivatives(answer, &settings) };
        let prepared = prepared.with_settings(&settings)?.with_load(self.problem.load().to_vec())?;
        prepared.with_gap(self.problem.inequalities_given().1.to_vec())?.derivatives(answer)
    }
}

/// The solution of a contact problem with n dofs, m contact rows and p equality rows. Its arrays are read-only.
///
/// Units are those of the problem. `signorini.solve`, `Prepared.solve` and other functions make it.
#[pyclass(frozen, module = "signorini", subclass)]
pub struct Solution {
    pub inner: Arc<Answer>,
    /// `None` for the answer that an exception of many problems carries.
    pub source: Option<Source>,
    /// The derivatives of the answer, once they have been asked for.
    pub derivatives: Mutex<Option<Derivatives>>,
    /// Arrays of `inner`, each made when it is first asked for.
    displacement: PyOnceLock<Py<PyAny>>,
    multiplier: PyOnceLock<Py<PyAny>>,
    equality_multiplier: PyOnceLock<Py<PyAny>>,
    closed: PyOnceLock<Py<PyAny>>,
}

impl Solution {
    pub fn new(answer: Answer, source: Option<Source>) -> Self {
        Solution {
            inner: Arc::new(answer),
            source,
            derivatives: Mutex::default(),
            displacement: PyOnceLock::new(),
            multiplier: PyOnceLock::new(),
            equality_multiplier: PyOnceLock::new(),
            closed: PyOnceLock::new(),
        }
    }

    /// Makes the Python object of a solution.
    pub fn object(py: Python<'_>, answer: Answer, source: Option<Source>) -> PyResult<Py<PyAny>> {
        Ok(Py::new(py, Solution::new(answer, source))?.into_any())
    }
}

/// Returns the array in a cell, which is made if the cell is empty.
fn once(
    py: Python<'_>,
    cell: &PyOnceLock<Py<PyAny>>,
    make: impl FnOnce() -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    cell.get_or_try_init(py, make).map(|array| array.clone_ref(py))
}

/// Returns the closed rows of a set as an array.
pub fn rows_of<'py>(py: Python<'py>, set: &ContactSet) -> PyResult<Bound<'py, PyAny>> {
    of_indices(py, set.iter())
}

/// Converts a serialisable value into dictionaries and lists of Python; a number that is not finite becomes `None`.
pub fn as_object<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| crate::errors::panicked(py, &error.to_string()))?;
    py.import("json")?.getattr("loads")?.call1((text,))
}

#[pymethods]
impl Solution {
    /// Displacements, shape (n,), in length, in the order of the unknowns of K.
    #[getter]
    fn u(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.displacement, || Ok(of_reals(py, &self.inner.displacement)?.unbind()))
    }

    /// Contact multipliers, shape (m,), in force: the force on the body along each row, <= 0 in compression.
    #[getter]
    fn multiplier(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.multiplier, || Ok(of_reals(py, &self.inner.multiplier)?.unbind()))
    }

    /// Multipliers of the equality rows, shape (p,), in force, of either sign; empty without such rows.
    #[getter]
    fn equality_multiplier(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.equality_multiplier, || Ok(of_reals(py, &self.inner.equality_multiplier)?.unbind()))
    }

    /// Indices of the closed rows, counted from 0, increasing.
    #[getter]
    fn contact_set(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.closed, || Ok(rows_of(py, &self.inner.contact_set)?.unbind()))
    }

    /// Total contact force `-sum(multiplier)`, >= 0, in force.
    #[getter]
    fn contact_force(&self) -> f64 {
        self.inner.contact_force()
    }

    /// Name of the method: "qp", "active-set", "penalty" or "mprgp", with a suffix for a variant.
    #[getter]
    fn method(&self) -> &str {
        &self.inner.method
    }

    /// Number of iterations of the method: linear solves, interior-point steps, or multigrid cycles.
    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// The residuals of all conditions and the error bound, recomputed from the problem: a `Certificate`.
    #[getter]
    fn certificate(&self) -> Certificate {
        Certificate { inner: self.inner.certificate }
    }

    /// Upper bound on the relative error of u in the energy norm; `inf` if none is known.
    #[getter]
    fn energy_error_bound(&self) -> f64 {
        self.inner.certificate.energy_error_bound
    }

    /// The rows that are proven open or closed: a `Proven`. None with `proof=False`, or if no error bound is known.
    #[getter]
    fn proven(&self) -> Option<Proven> {
        self.inner.proven.as_ref().map(|_| Proven { of: self.inner.clone() })
    }

    /// Why this method was chosen, and which methods were tried before it, in words.
    #[getter]
    fn why(&self) -> String {
        let answer = &self.inner;
        let reason = (!answer.reason.is_empty()).then(|| format!("{}: {}", answer.method, answer.reason));
        let attempts =
            answer.attempts.iter().map(|attempt| format!("{} was tried before: {}", attempt.method, attempt.reason));
        let said: Vec<String> = reason.into_iter().chain(attempts).collect();
        match said.is_empty() {
            true => format!("{}: chosen by the estimate of seconds and memory, or by the caller", answer.method),
            false => said.join("; "),
        }
    }

    /// Wall-clock time of the whole solve, in seconds.
    #[getter]
    fn seconds(&self) -> f64 {
        self.inner.seconds.solve
    }

    /// Seconds of the steps, a dictionary: "factor", "certificate", "proof", and "solve" for the whole, which contains
    /// them.
    #[getter]
    fn seconds_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (by_step, seconds) = (PyDict::new(py), self.inner.seconds);
        by_step.set_item("factor", seconds.factor)?;
        by_step.set_item("certificate", seconds.certificate)?;
        by_step.set_item("proof", seconds.proof)?;
        by_step.set_item("solve", seconds.solve)?;
        Ok(by_step)
    }

    /// List of pairs, one per iteration: the indices of the closed rows, and the penalty.
    ///
    /// The penalty is in multiples of the local stiffness; it is 0 for a method without a penalty.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let of_each = self.inner.history.iter();
        let pairs = of_each.map(|iteration| Ok((rows_of(py, &iteration.contact_set)?, iteration.penalty)));
        PyList::new(py, pairs.collect::<PyResult<Vec<_>>>()?)
    }

    /// Returns the derivatives of an output phi(u, multiplier, equality_multiplier) with respect to all data of the
    /// problem.
    ///
    /// The first derivative factorises K, except for a solution of `prepare`, whose factor is used. Each costs one
    /// linear solve. If phi itself depends on the data, that part is not in the result.
    ///
    /// Parameters
    /// ----------
    /// displacement : array, shape (n,), optional
    ///     d phi / d u. Zero by default.
    /// multiplier : array, shape (m,), optional
    ///     d phi / d multiplier. Zero by default.
    /// equality_multiplier : array, shape (p,), optional
    ///     d phi / d equality_multiplier. Zero by default.
    ///
    /// Returns
    /// -------
    /// Vjp
    ///     The derivatives, with the verdict whether they exist. Their unit is that of phi over that of the data. A
    ///     derivative that is not proven is no exception here; the result says so.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     An array has a wrong length, or a value that is not finite. Or the solution was carried by an exception in
    ///     `Solutions.errors`: it does not keep its problem.
    /// BadType
    ///     An argument has a wrong type.
    /// SignoriniError or Interrupted
    ///     As `signorini.prepare`.
    #[pyo3(signature = (displacement = None, multiplier = None, equality_multiplier = None))]
    fn vjp<'py>(
        slf: &Bound<'py, Self>,
        displacement: Option<Bound<'py, PyAny>>,
        multiplier: Option<Bound<'py, PyAny>>,
        equality_multiplier: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (slf, displacement, multiplier, equality_multiplier);
        slf.py().import("signorini._signorini")?.call_method1("_vjp", arguments)
    }

    /// Returns the derivatives of displacement and multipliers along a change of the data, per unit of a parameter.
    ///
    /// Costs are those of `vjp`.
    ///
    /// Parameters
    /// ----------
    /// load : array, shape (n,), optional
    ///     Change df of the load. What is not given does not change.
    /// gap : array, shape (m,), optional
    ///     Change dg of the gaps, positive if the obstacle moves away. It must be finite; the gap of a row without an
    ///     obstacle stays infinite.
    /// stiffness : matrix, shape (n, n), optional
    ///     Change dK, symmetric, with both triangles. It may have entries where K has none.
    /// rows : matrix, shape (m, n), optional
    ///     Change dB. It may have entries where B has none.
    /// equality_values : array, shape (p,), optional
    ///     Change de of the values of the equality rows.
    ///
    /// Returns
    /// -------
    /// Jvp
    ///     The derivatives, with the verdict whether they exist.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     An array has a wrong shape, or a value that is not finite; dK is not symmetric; or as in `vjp`.
    /// BadType
    ///     An argument has a wrong type.
    /// SignoriniError or Interrupted
    ///     As `signorini.prepare`.
    #[pyo3(signature = (load = None, gap = None, stiffness = None, rows = None, equality_values = None))]
    fn jvp<'py>(
        slf: &Bound<'py, Self>,
        load: Option<Bound<'py, PyAny>>,
        gap: Option<Bound<'py, PyAny>>,
        stiffness: Option<Bound<'py, PyAny>>,
        rows: Option<Bound<'py, PyAny>>,
        equality_values: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (slf, load, gap, stiffness, rows, equality_values);
        slf.py().import("signorini._signorini")?.call_method1("_jvp", arguments)
    }

    /// Returns all scalar results; the vectors are left out.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Its keys are those in the reports of the program. A number that is not finite is None.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &*self.inner)
    }

    fn __repr__(&self) -> String {
        let answer = &self.inner;
        let (closed, rows) = (answer.contact_set.count(), answer.contact_set.rows());
        let bound = answer.certificate.energy_error_bound;
        let said = if bound.is_finite() { format!("energy error <= {bound:.1e}") } else { "no error bound".into() };
        let (name, method) = ("signorini.Solution", &answer.method);
        format!(
            "<{name}: {} dofs, {closed} of {rows} rows closed, {said}, {method}, {:.2e} s>",
            answer.displacement.len(),
            answer.seconds.solve
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("solution_html", (slf,))
    }

    /// Draws the contact force of each row. Needs matplotlib: `pip install "signorini[plot]"`.
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
        slf.py().import("signorini._show")?.call_method1("solution_plot", (slf, ax))
    }
}

/// Residuals of the conditions that define the solution, and a bound on the error. All are relative, except
/// `energy_error`.
///
/// A *part* is a group of dofs that K and B couple with each other, and with no other dof. The energy norm of u is the
/// root of u'K u. `docs/certificate.md` has the formulas.
#[pyclass(frozen, module = "signorini", eq)]
#[derive(Clone, PartialEq)]
pub struct Certificate {
    pub inner: signorini::Certificate,
}

#[pymethods]
impl Certificate {
    /// Residual of the equilibrium K u - f - B' multiplier - E' equality_multiplier = 0, relative to its terms at each
    /// dof.
    ///
    /// It explains an error and does not decide.
    #[getter]
    fn stationarity(&self) -> f64 {
        self.inner.stationarity
    }

    /// Depth in the obstacle, a violation of B u - g <= 0, relative to the lengths of the row. It decides.
    #[getter]
    fn penetration(&self) -> f64 {
        self.inner.penetration
    }

    /// Largest multiplier of the wrong sign, relative to the forces at its dofs: an obstacle would pull. It must be
    /// zero.
    #[getter]
    fn adhesion(&self) -> f64 {
        self.inner.adhesion
    }

    /// Products of contact force and open distance, relative to twice the strain energy. It does not decide.
    #[getter]
    fn complementarity(&self) -> f64 {
        self.inner.complementarity
    }

    /// Difference of the primal and the dual energy, relative to twice the strain energy. It does not decide.
    #[getter]
    fn duality_gap(&self) -> f64 {
        self.inner.duality_gap
    }

    /// Residual of the equilibrium above rounding, relative to the largest force on the part. It decides.
    #[getter]
    fn imbalance(&self) -> f64 {
        self.inner.imbalance
    }

    /// Relative force of a row or its relative open distance, the smaller of the two: a row that presses without
    /// touching.
    ///
    /// It decides.
    #[getter]
    fn open_force(&self) -> f64 {
        self.inner.open_force
    }

    /// Upper bound on the error of u in the energy norm, in the root of force times length; `inf` if none is known.
    #[getter]
    fn energy_error(&self) -> f64 {
        self.inner.energy_error
    }

    /// Upper bound on the relative error of u in the energy norm; `inf` if none is known, or for a body at rest.
    #[getter]
    fn energy_error_bound(&self) -> f64 {
        self.inner.energy_error_bound
    }

    /// The smallest tolerance that the solution meets without the excuse of rounding or, if there is none, with it.
    ///
    /// `inf` if it meets none.
    #[getter]
    fn met_tolerance(&self) -> f64 {
        self.inner.met_tolerance
    }

    /// How the goal is met: "tolerance", or "rounding" if the error is no more than rounding of u to doubles.
    ///
    /// None if the goal is not met, or if nothing was asked for, as in `verify`.
    #[getter]
    fn met(&self) -> Option<&'static str> {
        self.inner.met()
    }

    /// True if no part moves. Then there is no relative error, and `rest_error` bounds the error.
    #[getter]
    fn at_rest(&self) -> bool {
        self.inner.at_rest
    }

    /// Largest error bound of a part at rest, relative to what the forces on it could do to a single dof.
    #[getter]
    fn rest_error(&self) -> f64 {
        self.inner.rest_error
    }

    /// Index of the dof, from 0, at which loads and contact forces cancel most digits of the elastic force.
    #[getter]
    fn worst_dof(&self) -> usize {
        self.inner.worst_dof()
    }

    /// Digits of the elastic force that doubles can hold at `worst_dof`, from 0 to 16.
    #[getter]
    fn digits_left(&self) -> f64 {
        self.inner.digits_left()
    }

    /// Largest relative error bound of the whole problem and of each part that moves.
    #[getter]
    fn part_error_bound(&self) -> f64 {
        self.inner.part_error_bound
    }

    /// True if the bound uses a measured eigenvalue, because K was not factorised.
    #[getter]
    fn bound_is_measured(&self) -> bool {
        self.inner.bound_is_measured
    }

    /// Name and value of the largest of the numbers that decide, a pair.
    #[getter]
    fn worst(&self) -> (&'static str, f64) {
        self.inner.worst()
    }

    /// Returns whether the solution is certified to a tolerance.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float
    ///     Relative, for example 1e-9.
    ///
    /// Returns
    /// -------
    /// bool
    ///     True if no row pulls, all conditions hold to `tolerance`, and the error bound of every part is at most
    ///     `tolerance` or explained by rounding of u to doubles.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     `tolerance` is no number.
    fn meets(&self, tolerance: f64) -> bool {
        self.inner.meets(tolerance)
    }

    /// Returns whether all conditions hold to a tolerance. The error bound is not compared.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float
    ///     Relative, for example 1e-9.
    ///
    /// Returns
    /// -------
    /// bool
    ///     True if no row pulls and all other conditions hold to `tolerance`.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     `tolerance` is no number.
    fn conditions_hold(&self, tolerance: f64) -> bool {
        self.inner.conditions_hold(tolerance)
    }

    /// Returns all numbers of the certificate.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Its keys are those in the reports of the program. A number that is not finite is None.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.inner)
    }

    fn __repr__(&self) -> String {
        let (condition, value) = self.inner.worst();
        let bound = self.inner.energy_error_bound;
        format!("<signorini.Certificate: energy error <= {bound:.1e}, worst condition {condition} {value:.1e}>")
    }
}

/// The rows that the error bound proves to be open or closed in the exact solution. Arrays of int, read-only.
#[pyclass(frozen, module = "signorini")]
pub struct Proven {
    of: Arc<Answer>,
}

impl Proven {
    fn rows<'py>(
        &self,
        py: Python<'py>,
        pick: impl FnOnce(&signorini::ProvenSet) -> Vec<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        of_indices(py, self.of.proven.as_ref().map_or_else(Vec::new, pick))
    }
}

#[pymethods]
impl Proven {
    /// Indices of the rows that are proven open, counted from 0, increasing.
    #[getter]
    fn open<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |proven| proven.open.iter().collect())
    }

    /// Indices of the rows that are proven closed, counted from 0, increasing.
    #[getter]
    fn closed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |proven| proven.closed.iter().collect())
    }

    /// Indices of the rows that are proven neither open nor closed, counted from 0, increasing.
    #[getter]
    fn undecided<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |proven| proven.undecided().collect())
    }

    fn __repr__(&self) -> String {
        let count = |pick: fn(&signorini::ProvenSet) -> usize| self.of.proven.as_ref().map_or(0, pick);
        let (open, closed) = (count(|proven| proven.open.count()), count(|proven| proven.closed.count()));
        let undecided = count(|proven| proven.undecided().count());
        format!("<signorini.Proven: {closed} closed, {open} open, {undecided} undecided>")
    }
}
