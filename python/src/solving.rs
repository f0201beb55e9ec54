//! The functions of Python that solve, prepare and verify a problem.

use std::sync::Arc;

use pyo3::prelude::*;
use signorini::{ContactProblem, Prepared, Watch};

use crate::answered::{answered, solve_from, start_of};
use crate::arrays::finite_reals;
use crate::exceptions::{plain_exception, signalled};
use crate::options::Options;
use crate::prepared;
use crate::problem::Problem;
use crate::solution::{Certificate, Solution, Source};
use crate::work::{End, Place, run};

/// Solves a contact problem. The returned solution is certified to `tolerance`.
#[pyfunction]
#[pyo3(signature = (
    problem, *, method = None, accuracy = None, time = None, start = None, threads = None, tolerance = None, memory = None,
    precision = None, condense = true, proof = true
))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn solve<'py>(
    problem: &Bound<'py, Problem>,
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
    let (py, inner) = (problem.py(), problem.get().inner.clone());
    let (condense, proof) = (Some(condense), Some(proof));
    let options = Options { method, accuracy, tolerance, time, threads, memory, precision, condense, proof };
    let settings = options.settings(Some(&inner))?;
    let start = start_of(start.as_ref(), &inner)?;
    let place = Place::for_problem(&inner);
    let source = Source { problem: inner.clone(), settings: settings.clone(), prepared: None };
    let find = move |watch: &Watch| solve_from(&inner, start, &settings.watched(watch));
    answered(py, place, find, |solution| Solution::object(py, solution, Some(source.clone())))
}

/// Solves a contact problem by an interior-point method, certified to 1e-9; the active-set method makes the contact set
/// exact.
#[pyfunction]
pub fn solve_qp(problem: &Bound<'_, Problem>) -> PyResult<Py<PyAny>> {
    let method = pyo3::types::PyString::new(problem.py(), "qp").into_any();
    solve(problem, Some(method), None, None, None, None, None, None, None, true, true)
}

/// Factorises a problem once, to solve it for several gaps, loads or starts.
#[pyfunction]
#[pyo3(signature = (
    problem, *, gaps = 10, method = None, accuracy = None, threads = None, tolerance = None, memory = None,
    precision = None, condense = true, proof = true
))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn prepare<'py>(
    problem: &Bound<'py, Problem>,
    gaps: usize,
    method: Option<Bound<'py, PyAny>>,
    accuracy: Option<Bound<'py, PyAny>>,
    threads: Option<Bound<'py, PyAny>>,
    tolerance: Option<Bound<'py, PyAny>>,
    memory: Option<Bound<'py, PyAny>>,
    precision: Option<Bound<'py, PyAny>>,
    condense: bool,
    proof: bool,
) -> PyResult<prepared::Prepared> {
    let (py, inner) = (problem.py(), problem.get().inner.clone());
    let (condense, proof) = (Some(condense), Some(proof));
    let options = Options { method, accuracy, tolerance, time: None, threads, memory, precision, condense, proof };
    let settings = options.settings(Some(&inner))?;
    let (place, of_problem, own) = (Place::for_problem(&inner), inner.clone(), settings.clone());
    let prepare = move |watch: &Watch| Prepared::for_gaps(&of_problem, gaps.max(1), &own.watched(watch));
    match run(py, place, prepare)? {
        End::Done(Ok(prepared)) => Ok(prepared::Prepared::new(inner, prepared, settings)),
        End::Done(Err(error)) => Err(plain_exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}

/// Returns the certificate of any displacement u (length n), multiplier (length m, <= 0 in compression) and multiplier of the equality
/// rows (length p, of either sign).
#[pyfunction]
#[pyo3(signature = (problem, u, multiplier, equality_multiplier = None))]
pub fn verify(
    problem: &Bound<'_, Problem>,
    u: &Bound<'_, PyAny>,
    multiplier: &Bound<'_, PyAny>,
    equality_multiplier: Option<&Bound<'_, PyAny>>,
) -> PyResult<Certificate> {
    let (py, inner): (_, Arc<ContactProblem>) = (problem.py(), problem.get().inner.clone());
    let (displacement, mut multiplier) = (finite_reals("u", u)?, finite_reals("multiplier", multiplier)?);
    if let Some(of_equalities) = equality_multiplier {
        multiplier.extend(finite_reals("equality_multiplier", of_equalities)?);
    }
    let place = Place::for_problem(&inner);
    match run(py, place, move |_: &Watch| inner.certify(&displacement, &multiplier))? {
        End::Done(Ok(inner)) => Ok(Certificate { inner }),
        End::Done(Err(error)) => Err(plain_exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}
