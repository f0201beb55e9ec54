//! A contact problem as a linear complementarity problem in its forces.

use pyo3::prelude::*;

use crate::arrays::{of_indices, of_reals, of_table, reals};
use crate::exceptions::plain_exception;
use crate::matrices::csc;

/// A contact problem as a linear complementarity problem: find x between `lower` and `upper` with w = M x + q, w >= 0
/// where x is at its lower bound, and w = 0 elsewhere. `Prepared.delassus` makes it.
///
/// x has the forces z = -lambda of the rows, and then the coordinates a of the motions without energy.
#[pyclass(frozen, module = "signorini")]
pub struct Delassus(signorini::qp::Delassus);

impl Delassus {
    pub fn new(inner: signorini::qp::Delassus) -> Self {
        Delassus(inner)
    }
}

#[pymethods]
impl Delassus {
    /// Matrix M, a scipy.sparse.csc_array of shape (m + r, m + r), for m rows and r motions without energy. For r = 0
    /// it is symmetric to the last bit.
    #[getter]
    #[pyo3(name = "M")]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        csc(py, &self.0.matrix)
    }

    /// Offset q, shape (m + r,), in length for rows. Read-only.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.0.offset)
    }

    /// Lower bounds, shape (m + r,): 0 for forces, -inf for motions. Read-only.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.0.lower)
    }

    /// Upper bounds, shape (m + r,): inf. Read-only.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.0.upper)
    }

    /// Index of the contact row of each z, shape (m,), counted from 0, increasing. Read-only.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_indices(py, self.0.rows.iter().copied())
    }

    /// Motions without energy, shape (r, n), one per row. Read-only.
    #[getter]
    fn motions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_table(py, &self.0.motions.concat(), self.0.motions.first().map_or(0, Vec::len))
    }

    /// Returns the displacement of an x: K+ (f - B'z) + R a.
    ///
    /// Parameters
    /// ----------
    /// x : array, shape (m + r,)
    ///     Forces z of the rows, then coordinates a of the motions.
    ///
    /// Returns
    /// -------
    /// array, shape (n,)
    ///     In length, read-only.
    ///
    /// Raises
    /// ------
    /// BadInput or TypeError
    ///     x does not fit the problem.
    fn displacement<'py>(&self, py: Python<'py>, x: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let found = self.0.displacement(&reals("x", x)?);
        of_reals(py, &found.map_err(|error| plain_exception(py, error))?)
    }

    fn __repr__(&self) -> String {
        format!("<signorini.Delassus: {} rows, {} motions>", self.0.rows.len(), self.0.motions.len())
    }
}
