//! The class `Problem` of Python.

use std::sync::Arc;

use pyo3::prelude::*;
use signorini::qp::NearNullSpace;
use signorini::{ContactProblem, SparseMatrix};

use crate::arrays::{columns, of_reals, of_table, reals};
use crate::errors::bad_input;
use crate::exceptions::plain_exception;
use crate::matrices;

/// Frictionless contact of elastic bodies as a convex quadratic program.
///
///     minimise 1/2 u'K u - f'u  subject to  B u - g <= 0,  E u = e
///
/// n is the number of unknowns (dofs), m that of contact rows, p that of equality rows. Any consistent system of units
/// can be used; "length" and "force" below are its units. The arrays are checked once, here. A problem can be pickled,
/// with scipy.
///
/// Parameters
/// ----------
/// K : matrix, shape (n, n)
///     Stiffness after supports, in force per length. It is symmetric to rounding (1e-10 of its diagonal) and positive
///     semidefinite. Both triangles must be given; the values are taken from the lower one. A matrix is a sparse matrix
///     of scipy, an array of numpy, or an object with `to_scipy()`, such as a matrix of dolfinx.
/// f : array, shape (n,)
///     External load, in force, positive along the axes.
/// B : matrix, shape (m, n), optional
///     Contact rows, positive towards the obstacle. Without B and g the problem has no contact rows.
/// g : array, shape (m,), optional
///     Gaps before the deformation, in length. A negative gap means that the obstacle starts inside the body. The
///     values `inf`, 1e20 and 1e30 mean that the row has no obstacle.
/// near_null : array, shape (n, k), optional
///     Displacements of almost zero energy, one per column, such as the rigid-body modes. The columns are independent.
///     Multigrid needs them for bodies in space.
/// E : matrix, shape (p, n), optional
///     Equality rows. They may follow from each other.
/// e : array, shape (p,), optional
///     Values of the equality rows, in length.
/// coordinates : array, shape (nodes, 1 or 2 or 3), optional
///     Coordinates of the nodes, in length, instead of `near_null`: the rigid-body modes are computed from them. All
///     dofs must be free, and the dofs of each node must follow each other.
///
/// Raises
/// ------
/// BadInput
///     An array has a wrong shape, or a value that is not allowed. K is not symmetric. B is given without g, or E
///     without e.
/// BadType
///     An array has a wrong type, for example complex numbers.
/// NotConvex
///     K has a negative diagonal entry.
///
/// Warns
/// -----
/// UserWarning
///     A row without entries has a gap or a value that is rounding beside the largest one (16 eps). It counts as 0.
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
        for (_, sentence) in problem.warnings() {
            py.import("warnings")?.call_method1("warn", (sentence,))?;
        }
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
        let problem = near_null.map_err(Into::into).and_then(|near_null| problem.with_near_null(near_null));
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

    /// Stiffness, shape (n, n), in force per length, with both triangles: a new `csc_array` of scipy. Needs scipy.
    #[getter(K)]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let lower = matrices::csc(py, self.inner.stiffness().lower())?;
        let sparse = py.import("scipy.sparse")?;
        let below = sparse.getattr("tril")?.call1((&lower, -1))?;
        let both = lower.call_method1("__add__", (below.getattr("T")?,))?;
        sparse.getattr("csc_array")?.call1((both,))
    }

    /// External load, shape (n,), in force, read-only.
    #[getter]
    fn f<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.inner.load())
    }

    /// Contact rows, shape (m, n), positive towards the obstacle: a new `csc_array` of scipy. Needs scipy.
    #[getter(B)]
    fn contact<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrices::csc(py, &self.inner.inequalities_given().0)
    }

    /// Equality rows, shape (p, n): a new `csc_array` of scipy. None if there are no such rows. Needs scipy.
    #[getter(E)]
    fn equality_matrix<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let has_rows = self.inner.equality_rows() > 0;
        has_rows.then(|| matrices::csc(py, &self.inner.equalities_given().0)).transpose()
    }

    /// Values of the equality rows, shape (p,), in length, read-only. None if there are no such rows.
    #[getter]
    fn e<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let has_rows = self.inner.equality_rows() > 0;
        has_rows.then(|| of_reals(py, &self.inner.equalities_given().1)).transpose()
    }

    /// Gaps before the deformation, shape (m,), in length, read-only. `inf` for a row without an obstacle.
    #[getter]
    fn g<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, self.inner.inequalities_given().1)
    }

    /// Displacements of almost zero energy, shape (n, k), one per column. None if none were given.
    #[getter]
    fn near_null<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(space) = self.inner.near_null() else { return Ok(None) };
        let values: Vec<f64> = space.vectors().iter().flatten().copied().collect();
        of_table(py, &values, space.dofs())?.getattr("T").map(Some)
    }

    /// Returns the same problem with another load, other gaps, or both.
    ///
    /// Parameters
    /// ----------
    /// f : array, shape (n,), optional
    ///     The new load, in force. Without it the load does not change.
    /// g : array, shape (m,), optional
    ///     The new gaps, in length. Without it the gaps do not change.
    ///
    /// Returns
    /// -------
    /// Problem
    ///     It shares K, B, E and e with this problem; nothing is copied except f and g.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     An array has a wrong length, or a value that is not allowed.
    /// BadType
    ///     An array has a wrong type.
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
