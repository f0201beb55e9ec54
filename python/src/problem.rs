//! The class `Problem` of Python.

use std::sync::Arc;

use pyo3::prelude::*;
use signorini::qp::NearNullSpace;
use signorini::{ContactProblem, SparseMatrix};

use crate::arrays::{columns, of_reals, of_table, reals};
use crate::errors::bad_input;
use crate::exceptions::plain_exception;
use crate::matrices;

/// The contact problem: minimise 1/2 u'K u - f'u  subject to  B u - g <= 0. The arrays are checked once, here.
#[pyclass(frozen, module = "signorini")]
pub struct Problem {
    pub inner: Arc<ContactProblem>,
}

impl From<ContactProblem> for Problem {
    fn from(problem: ContactProblem) -> Self {
        Problem { inner: Arc::new(problem) }
    }
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (K, f, B = None, g = None, near_null = None, E = None, e = None, *, coordinates = None))]
    #[expect(non_snake_case, reason = "the names of the equation")]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        K: &Bound<'_, PyAny>,
        f: &Bound<'_, PyAny>,
        B: Option<&Bound<'_, PyAny>>,
        g: Option<&Bound<'_, PyAny>>,
        near_null: Option<&Bound<'_, PyAny>>,
        E: Option<&Bound<'_, PyAny>>,
        e: Option<&Bound<'_, PyAny>>,
        coordinates: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = K.py();
        let stiffness = matrices::stiffness("K", K)?;
        let load = reals("f", f)?;
        let (contact, gap) = match (B, g) {
            (Some(rows), Some(gap)) => (matrices::rows("B", rows, stiffness.dim())?, reals("g", gap)?),
            (None, None) => {
                let none = SparseMatrix::from_triplets(0, stiffness.dim(), &[]);
                (none.map_err(|error| plain_exception(py, error))?, Vec::new())
            }
            (Some(_), None) => return Err(bad_input(py, "B is given without g; every row of B needs a gap")),
            (None, Some(_)) => return Err(bad_input(py, "g is given without B; every gap needs a row of B")),
        };
        let mut problem =
            ContactProblem::new(stiffness, load, contact, gap).map_err(|error| plain_exception(py, error))?;
        match (E, e) {
            (Some(rows), Some(values)) => {
                let (rows, values) = (matrices::rows("E", rows, problem.dofs())?, reals("e", values)?);
                problem = problem.with_equalities(&rows, values).map_err(|error| plain_exception(py, error))?;
            }
            (None, None) => {}
            (Some(_), None) => return Err(bad_input(py, "E is given without e; every row of E needs a value")),
            (None, Some(_)) => return Err(bad_input(py, "e is given without E; every value needs a row of E")),
        }
        let warn = py.import("warnings")?.getattr("warn")?;
        problem.warnings().into_iter().try_for_each(|sentence| warn.call1((sentence,)).map(|_| ()))?;
        let near_null = match (near_null, coordinates) {
            (None, None) => return Ok(problem.into()),
            (Some(_), Some(_)) => {
                return Err(bad_input(py, "near_null and coordinates are both given; one of them is enough"));
            }
            (Some(vectors), None) => NearNullSpace::new(columns("near_null", vectors)?, problem.dofs()),
            (None, Some(coordinates)) => {
                let axes = columns("coordinates", coordinates)?;
                let (nodes, dimension) = (axes.first().map_or(0, Vec::len), axes.len());
                if nodes * dimension != problem.dofs() {
                    let dofs = problem.dofs();
                    let sentence = format!(
                        "coordinates is {nodes} x {dimension}, which makes {} dofs, but there are {dofs}; if supports have \
                         removed dofs, give near_null instead",
                        nodes * dimension
                    );
                    return Err(bad_input(py, sentence));
                }
                NearNullSpace::of_nodes(&axes)
            }
        };
        let problem = near_null.and_then(|near_null| problem.with_near_null(near_null));
        problem.map(Problem::from).map_err(|error| plain_exception(py, error))
    }

    /// Number of unknowns n.
    #[getter]
    fn dofs(&self) -> usize {
        self.inner.dofs()
    }

    /// Number of contact rows m.
    #[getter]
    fn row_count(&self) -> usize {
        self.inner.inequalities()
    }

    /// Number of equality rows p.
    #[getter]
    fn equality_count(&self) -> usize {
        self.inner.equality_rows()
    }

    /// Stiffness, n x n, with both triangles, as a csc_array of scipy.
    #[getter(K)]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let lower = matrices::csc(py, self.inner.stiffness().lower())?;
        let sparse = py.import("scipy.sparse")?;
        let below = sparse.getattr("tril")?.call1((&lower, -1))?;
        let both = lower.call_method1("__add__", (below.getattr("T")?,))?;
        sparse.getattr("csc_array")?.call1((both,))
    }

    /// External load, length n, read-only.
    #[getter]
    fn f<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.inner.load())
    }

    /// Contact rows, m x n, as a csc_array of scipy.
    #[getter(B)]
    fn contact<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrices::csc(py, &self.inner.inequalities_given().0)
    }

    /// Equality rows, p x n, as a csc_array of scipy; None without such rows.
    #[getter(E)]
    fn equality_matrix<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let has_rows = self.inner.equality_rows() > 0;
        has_rows.then(|| matrices::csc(py, &self.inner.equalities_given().0)).transpose()
    }

    /// Values of the equality rows, length p, read-only; None without such rows.
    #[getter]
    fn e<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let has_rows = self.inner.equality_rows() > 0;
        has_rows.then(|| of_reals(py, self.inner.equalities_given().1)).transpose()
    }

    /// Initial gaps, length m, read-only.
    #[getter]
    fn g<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.inner.inequalities_given().1)
    }

    /// Displacements of almost zero energy, n x k, one per column; None if none were given.
    #[getter]
    fn near_null<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(space) = self.inner.near_null() else { return Ok(None) };
        let values: Vec<f64> = space.vectors().iter().flatten().copied().collect();
        of_table(py, &values, space.dofs())?.getattr("T").map(Some)
    }

    /// Returns a problem with the load f (length n), the gaps g (length m), or both replaced; the matrices are shared, and so are the
    /// equality rows.
    #[pyo3(signature = (*, f = None, g = None))]
    fn replace(&self, py: Python<'_>, f: Option<&Bound<'_, PyAny>>, g: Option<&Bound<'_, PyAny>>) -> PyResult<Problem> {
        let load = f.map_or_else(|| Ok(self.inner.load().to_vec()), |f| reals("f", f))?;
        let gap = g.map_or_else(|| Ok(self.inner.inequalities_given().1.to_vec()), |g| reals("g", g))?;
        self.inner.with(load, gap).map(Problem::from).map_err(|error| plain_exception(py, error))
    }

    fn __repr__(&self) -> String {
        let (dofs, rows) = (self.inner.dofs(), self.inner.inequalities());
        let equalities = match self.inner.equality_rows() {
            0 => String::new(),
            count => format!(", {count} equality rows"),
        };
        format!("<signorini.Problem: {dofs} dofs, {rows} contact rows{equalities}>")
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = slf.py();
        let names = ["K", "f", "B", "g", "near_null", "E", "e"];
        let arguments = names.iter().map(|name| slf.getattr(*name)).collect::<PyResult<Vec<_>>>()?;
        Ok((py.get_type::<Problem>().into_any(), pyo3::types::PyTuple::new(py, arguments)?.into_any()))
    }
}
