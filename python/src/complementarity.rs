//! Linear complementarity problems.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use signorini::Watch;
use signorini::lcp::{Error, Lcp, solve_lcp};

use crate::arrays::{of_indices, of_reals, reals};
use crate::errors::raised;
use crate::exceptions::{plain_exception, signalled};
use crate::matrices;
use crate::options::Options;
use crate::work::{End, Place, run};

/// The solution of a linear complementarity problem, with numbers that are recomputed from M, q and the bounds. n is
/// the number of unknowns.
#[pyclass(frozen, module = "signorini")]
pub struct LcpSolution {
    inner: signorini::lcp::LcpSolution,
}

#[pymethods]
impl LcpSolution {
    /// Unknowns, shape (n,), read-only.
    #[getter]
    fn z<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.z)
    }

    /// M z + q, shape (n,), in units of q, read-only. It is summed with twice the working precision.
    #[getter]
    fn w<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.w)
    }

    /// The method that found it: "quadratic-program", "gap-program", "principal-pivoting" or "lemke".
    #[getter]
    fn method(&self) -> &'static str {
        self.inner.method
    }

    /// Number of iterations of this method.
    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// The class of M: "symmetric" (and positive semidefinite), "symmetrizable" (so with its rows in other units),
    /// "h-matrix" (with positive diagonal), "monotone" (M + M' is positive semidefinite), "p-matrix" or "general".
    #[getter]
    fn kind(&self) -> &'static str {
        self.inner.class
    }

    /// "one" if there is no other solution, "several" if all have the same w and there may be several z, "unknown" if
    /// nothing is proven.
    #[getter]
    fn unique(&self) -> &'static str {
        match self.inner.is_unique {
            Some(true) => "one",
            Some(false) => "several",
            None => "unknown",
        }
    }

    /// Residual z - mid(lower, z - w, upper) of each unknown, shape (n,), relative to the terms of its row, read-only.
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.residual)
    }

    /// Upper bounds on the error of each unknown of the only solution, shape (n,), rounding included, read-only. None
    /// if none is known.
    #[getter]
    fn error_bound<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.inner.error.as_ref().ok().map(|error| of_reals(py, error)).transpose()
    }

    /// Upper bounds on the error of each entry of w, shape (n,), in units of q, read-only. None if none is known.
    #[getter]
    fn w_error_bound<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.inner.image_error.as_ref().ok().map(|error| of_reals(py, error)).transpose()
    }

    /// The reason why `error_bound` is None, otherwise None.
    #[getter]
    fn no_error_bound(&self) -> Option<&str> {
        self.inner.error.as_ref().err().map(String::as_str)
    }

    /// The proven place of each unknown, a list of n: "lower", "between" or "upper"; None if nothing is proven.
    #[getter]
    fn proven(&self) -> Vec<Option<&'static str>> {
        let name = |i: usize| {
            let names = ["lower", "between", "upper"].into_iter().zip(&self.inner.proven);
            names.into_iter().find_map(|(name, proven)| proven.contains(i).then_some(name))
        };
        (0..self.inner.z.len()).map(name).collect()
    }

    /// Time of all methods and of the certificate, in seconds.
    #[getter]
    fn seconds(&self) -> f64 {
        self.inner.seconds
    }

    fn __repr__(&self) -> String {
        let (unknowns, worst) = (self.inner.z.len(), self.inner.worst().1);
        format!("<signorini.LcpSolution: {unknowns} unknowns, {}, residual {worst:.1e}>", self.method())
    }
}

/// Makes the exception for an error of a complementarity problem.
fn exception(py: Python<'_>, error: Error) -> PyErr {
    let (about, sentence, code) = (PyDict::new(py), error.to_string(), error.code());
    let error = match error {
        Error::Qp(error) => return plain_exception(py, error),
        error => error,
    };
    let filled = || -> PyResult<&'static str> {
        about.set_item("code", code)?;
        Ok(match error {
            Error::Infeasible { ray, needed } => {
                let rows: Vec<usize> = (0..ray.len()).filter(|&row| ray[row] != 0.0).collect();
                let weights: Vec<f64> = rows.iter().map(|&row| ray[row]).collect();
                about.set_item("rows", of_indices(py, rows)?)?;
                about.set_item("weights", of_reals(py, &weights)?)?;
                about.set_item("ray", of_reals(py, &ray)?)?;
                about.set_item("overlap", needed)?;
                "Infeasible"
            }
            Error::NotFound { .. } => "NotFound",
            Error::NotCertified { solution, residual, tolerance, .. } => {
                about.set_item("solution", LcpSolution { inner: *solution }.into_pyobject(py)?)?;
                about.set_item("condition", "residual")?;
                about.set_item("value", residual)?;
                about.set_item("tolerance", tolerance)?;
                "NotCertified"
            }
            Error::TooLarge { bytes, allowed, .. } => {
                about.set_item("bytes", bytes)?;
                about.set_item("allowed", allowed)?;
                "TooLarge"
            }
            _ => "BadInput",
        })
    };
    match filled() {
        Ok(class) => raised(py, class, &sentence, &about),
        Err(error) => error,
    }
}

/// Solves a linear complementarity problem: z between its bounds, so that w = M z + q is >= 0 where z is at its lower
/// bound, <= 0 where z is at its upper bound, and 0 between. Without bounds: z >= 0, w >= 0, z'w = 0.
///
/// Parameters
/// ----------
/// M : matrix, shape (n, n)
///     Any real matrix; both triangles must be given. A sparse matrix of scipy, an array of numpy, or an object with
///     `to_scipy()`.
/// q : array, shape (n,)
///     Offset of w.
/// lower, upper : array, shape (n,), optional
///     Bounds of z; 0 and infinity by default. `inf`, `-inf` and magnitudes of 1e20 or more mean no bound.
/// tolerance : float, optional
///     Largest residual of a solution, relative to the terms of each row, positive; the default is 1e-9.
/// time : float, optional
///     Limit in seconds, positive. No limit by default.
/// threads, memory : optional
///     As in `signorini.solve`.
///
/// Returns
/// -------
/// LcpSolution
///     Its residuals meet `tolerance`.
///
/// Raises
/// ------
/// BadInput
///     An array has a wrong shape, or a value or an option is not allowed.
/// BadType or TypeError
///     An argument has a wrong type.
/// Infeasible
///     No z meets the inequalities. The exception carries the proof in `ray`.
/// NotFound
///     No solution was found, and none is shown to be impossible; M is not monotone.
/// NotCertified
///     The tolerance is not reached. The exception carries the best solution.
/// OutOfTime or TooLarge
///     The time or the memory does not suffice.
/// NumericalError
///     A computation fails.
/// Interrupted
///     Ctrl-C was pressed.
#[pyfunction]
#[pyo3(signature = (M, q, lower = None, upper = None, *, tolerance = None, time = None, threads = None, memory = None))]
#[expect(non_snake_case, reason = "the name of the equation")]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn lcp<'py>(
    M: &Bound<'py, PyAny>,
    q: &Bound<'py, PyAny>,
    lower: Option<&Bound<'py, PyAny>>,
    upper: Option<&Bound<'py, PyAny>>,
    tolerance: Option<Bound<'py, PyAny>>,
    time: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    memory: Option<Bound<'py, PyAny>>,
) -> PyResult<LcpSolution> {
    let py = M.py();
    let (matrix, offset) = (matrices::square("M", M)?, reals("q", q)?);
    let bound = |name: &str, given: Option<&Bound<'py, PyAny>>, without: f64| {
        given.map_or_else(|| Ok(vec![without; offset.len()]), |given| reals(name, given))
    };
    let (lower, upper) = (bound("lower", lower, 0.0)?, bound("upper", upper, f64::INFINITY)?);
    let options = Options { tolerance, time, threads, memory, ..Options::default() };
    let settings = options.settings_for(Some(matrix.entries()))?;
    let problem = Lcp::new(matrix, offset, lower, upper).map_err(|error| exception(py, error))?;
    let find = move |watch: &Watch| solve_lcp(&problem, &settings.watched(watch));
    match run(py, Place::Apart, find)? {
        End::Done(Ok(inner)) => Ok(LcpSolution { inner }),
        End::Done(Err(error)) => Err(exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}
