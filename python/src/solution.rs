//! Answers and their certificates.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList};
use signorini::{ContactSet, Solution as Answer};

use crate::arrays::{of_indices, of_reals};

/// The answer to a contact problem.
#[pyclass(frozen, module = "signorini", subclass)]
pub struct Solution {
    pub inner: Arc<Answer>,
    displacement: PyOnceLock<Py<PyAny>>,
    multiplier: PyOnceLock<Py<PyAny>>,
    closed: PyOnceLock<Py<PyAny>>,
}

impl Solution {
    pub fn new(answer: Answer) -> Self {
        Solution {
            inner: Arc::new(answer),
            displacement: PyOnceLock::new(),
            multiplier: PyOnceLock::new(),
            closed: PyOnceLock::new(),
        }
    }

    /// The object of an answer.
    pub fn object(py: Python<'_>, answer: Answer) -> PyResult<Py<PyAny>> {
        Ok(Py::new(py, Solution::new(answer))?.into_any())
    }
}

/// The array in a cell, made if it is empty.
fn once(
    py: Python<'_>,
    cell: &PyOnceLock<Py<PyAny>>,
    make: impl FnOnce() -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    cell.get_or_try_init(py, make).map(|array| array.clone_ref(py))
}

/// The closed rows of a set as an array.
pub fn rows_of<'py>(py: Python<'py>, set: &ContactSet) -> PyResult<Bound<'py, PyAny>> {
    of_indices(py, set.iter())
}

/// What serialises, as dictionaries and lists of Python; a number that is not finite is None there.
pub fn as_object<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| crate::errors::panicked(py, &error.to_string()))?;
    py.import("json")?.getattr("loads")?.call1((text,))
}

#[pymethods]
impl Solution {
    /// Displacement, one entry per dof.
    #[getter]
    fn u(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.displacement, || Ok(of_reals(py, &self.inner.displacement)?.unbind()))
    }

    /// Contact multiplier, one entry per row, <= 0 in compression.
    #[getter]
    fn multiplier(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.multiplier, || Ok(of_reals(py, &self.inner.multiplier)?.unbind()))
    }

    /// The closed rows, from 0 and increasing.
    #[getter]
    fn contact_set(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        once(py, &self.closed, || Ok(rows_of(py, &self.inner.contact_set)?.unbind()))
    }

    /// Total contact force.
    #[getter]
    fn contact_force(&self) -> f64 {
        self.inner.contact_force()
    }

    /// The method that found it.
    #[getter]
    fn method(&self) -> &str {
        &self.inner.method
    }

    /// Iterations of the method.
    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// How far it can be trusted.
    #[getter]
    fn certificate(&self) -> Certificate {
        Certificate { inner: self.inner.certificate }
    }

    /// Bound on the relative error in energy; infinite where none is known.
    #[getter]
    fn energy_error_bound(&self) -> f64 {
        self.inner.certificate.energy_error_bound
    }

    /// The rows that are proven open or closed; None where nothing was proven.
    #[getter]
    fn proven(&self) -> Option<Proven> {
        self.inner.proven.as_ref().map(|_| Proven { of: self.inner.clone() })
    }

    /// Why it was found in this way, in words.
    #[getter]
    fn why(&self) -> String {
        let answer = &self.inner;
        let reason = answer.reason.as_ref().map(|reason| format!("{}: {reason}", answer.method));
        let attempts =
            answer.attempts.iter().map(|attempt| format!("{} was tried before: {}", attempt.method, attempt.reason));
        let said: Vec<String> = reason.into_iter().chain(attempts).collect();
        match said.is_empty() {
            true => format!("{}: as its estimate of seconds and memory, or the caller, chose", answer.method),
            false => said.join("; "),
        }
    }

    /// Wall-clock seconds, all in all.
    #[getter]
    fn seconds(&self) -> f64 {
        self.inner.seconds.solve
    }

    /// Seconds by step.
    #[getter]
    fn seconds_of<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (by_step, seconds) = (PyDict::new(py), self.inner.seconds);
        by_step.set_item("factor", seconds.factor)?;
        by_step.set_item("certificate", seconds.certificate)?;
        by_step.set_item("proof", seconds.proof)?;
        by_step.set_item("solve", seconds.solve)?;
        Ok(by_step)
    }

    /// The contact sets on the way, each with its penalty.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let of_each = self.inner.history.iter();
        let pairs = of_each.map(|iteration| Ok((rows_of(py, &iteration.contact_set)?, iteration.penalty)));
        PyList::new(py, pairs.collect::<PyResult<Vec<_>>>()?)
    }

    /// The numbers without the vectors, as the program reports them.
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

    /// Draws multipliers over rows.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("signorini._show")?.call_method1("solution_plot", (slf, ax))
    }
}

/// How far an answer is from the conditions that define the solution.
#[pyclass(frozen, module = "signorini", eq)]
#[derive(Clone, PartialEq)]
pub struct Certificate {
    pub inner: signorini::Certificate,
}

#[pymethods]
impl Certificate {
    /// Relative imbalance of forces.
    #[getter]
    fn stationarity(&self) -> f64 {
        self.inner.stationarity
    }

    /// Relative penetration.
    #[getter]
    fn penetration(&self) -> f64 {
        self.inner.penetration
    }

    /// Relative wrong-signed multiplier.
    #[getter]
    fn adhesion(&self) -> f64 {
        self.inner.adhesion
    }

    /// Relative product of force and open distance.
    #[getter]
    fn complementarity(&self) -> f64 {
        self.inner.complementarity
    }

    /// Relative difference of primal and dual energy.
    #[getter]
    fn duality_gap(&self) -> f64 {
        self.inner.duality_gap
    }

    /// Bound on the relative error in energy.
    #[getter]
    fn energy_error_bound(&self) -> f64 {
        self.inner.energy_error_bound
    }

    /// The largest such bound over the whole and each part.
    #[getter]
    fn part_error_bound(&self) -> f64 {
        self.inner.part_error_bound
    }

    /// Whether the bound rests on a measured eigenvalue.
    #[getter]
    fn bound_is_measured(&self) -> bool {
        self.inner.bound_is_measured
    }

    /// The worst condition and its value.
    #[getter]
    fn worst(&self) -> (&'static str, f64) {
        self.inner.worst()
    }

    /// Whether all conditions and the bound hold to a tolerance.
    fn meets(&self, tolerance: f64) -> bool {
        self.inner.meets(tolerance)
    }

    /// Whether all conditions hold to a tolerance, whatever the bound.
    fn conditions_hold(&self, tolerance: f64) -> bool {
        self.inner.conditions_hold(tolerance)
    }

    /// The numbers, as the program reports them.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        as_object(py, &self.inner)
    }

    fn __repr__(&self) -> String {
        let (condition, value) = self.inner.worst();
        let bound = self.inner.energy_error_bound;
        format!("<signorini.Certificate: energy error <= {bound:.1e}, worst condition {condition} {value:.1e}>")
    }
}

/// Rows that an answer proves open or closed in the exact answer.
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
    /// Rows that are open beyond doubt.
    #[getter]
    fn open<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |proven| proven.open.iter().collect())
    }

    /// Rows that are closed beyond doubt.
    #[getter]
    fn closed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, |proven| proven.closed.iter().collect())
    }

    /// Rows of which neither is proven.
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
