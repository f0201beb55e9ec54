//! The functions of Python that solve, prepare and verify a problem.

use std::sync::Arc;

use pyo3::prelude::*;
use signorini::{ContactProblem, ContactSet, Error, Prepared, Settings, Start, Watch};

use crate::arrays::{Indices, finite_reals};
use crate::errors::{exception, interrupted, plain_exception};
use crate::options::Options;
use crate::prepared;
use crate::problem::Problem;
use crate::solution::{Certificate, Solution};
use crate::work::{End, Place, run};

/// Reads the start of a solve: a solution, an array of closed rows (integers), or a displacement (real numbers).
pub fn start_of(start: Option<&Bound<'_, PyAny>>, problem: &ContactProblem) -> PyResult<Option<Start>> {
    let Some(start) = start else { return Ok(None) };
    let py = start.py();
    if let Ok(solution) = start.cast::<Solution>() {
        let known = &solution.get().inner;
        if known.displacement.len() != problem.dofs() || known.contact_set.rows() != problem.rows() {
            let sentence = format!(
                "start has {} dofs and {} rows; the problem has {} dofs and {} rows",
                known.displacement.len(),
                known.contact_set.rows(),
                problem.dofs(),
                problem.rows()
            );
            return Err(crate::errors::bad_input(py, sentence));
        }
        return Ok(Some(Start::from(&**known)));
    }
    let is_rows = start
        .getattr("dtype")
        .and_then(|dtype| dtype.getattr("kind"))
        .is_ok_and(|kind| kind.extract::<String>().is_ok_and(|kind| kind == "i" || kind == "u"));
    if is_rows {
        let rows = Indices::of("start", start)?.to_usize(py)?;
        if let Some(row) = rows.iter().find(|&&row| row >= problem.rows()) {
            let row = if *row == usize::MAX { "a negative number".into() } else { row.to_string() };
            let sentence = format!("start names the row {row}; rows go from 0 to {}", problem.rows().saturating_sub(1));
            return Err(crate::errors::bad_input(py, sentence));
        }
        let mut set = ContactSet::open(problem.rows());
        rows.into_iter().for_each(|row| set.insert(row));
        return Ok(Some(set.into()));
    }
    let displacement = finite_reals("start", start)?;
    if displacement.len() != problem.dofs() {
        let sentence =
            format!("start has length {}; the displacement has length {}", displacement.len(), problem.dofs());
        return Err(crate::errors::bad_input(py, sentence));
    }
    Ok(Some(Start::near(displacement)))
}

/// Solves from `start`; if that fails, solves once more without a start.
pub fn solve_from(
    problem: &ContactProblem,
    start: Option<Start>,
    settings: &Settings,
) -> Result<signorini::Solution, Error> {
    let Some(start) = start else { return signorini::solve(problem, settings) };
    let prepared = Prepared::for_gaps(problem, 1, settings);
    match prepared.and_then(|prepared| prepared.starting_from(start).solve(problem.gap())) {
        Err(_) if !settings.watch.is_over() => signorini::solve(problem, settings),
        solved => solved,
    }
}

/// Runs `find` and makes the Python object of its solution. The exception of an interrupt carries the best solution.
pub fn answered(
    py: Python<'_>,
    place: Place,
    find: impl FnOnce(&Watch) -> Result<signorini::Solution, Error> + Send + 'static,
    object: impl Fn(signorini::Solution) -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let end = run(py, place, find)?;
    match end {
        End::Done(Ok(solution)) => object(solution),
        End::Done(Err(error)) => Err(exception(py, error, object)),
        End::Signalled(signal, best) => {
            let best = best.and_then(|ended| ended.map_or_else(Error::into_best, Some)).map(object).transpose()?;
            Err(signalled(py, signal, best))
        }
    }
}

/// Returns the exception of a signal: an interrupt with the best solution, or the exception of the caller's own
/// handler.
pub fn signalled(py: Python<'_>, signal: PyErr, best: Option<Py<PyAny>>) -> PyErr {
    match signal.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) {
        true => interrupted(py, best),
        false => signal,
    }
}

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
    let find = move |watch: &Watch| solve_from(&inner, start, &settings.watched(watch));
    answered(py, place, find, |solution| Solution::object(py, solution))
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

/// Returns the certificate of any displacement u (length n) and multiplier (length m, <= 0 in compression).
#[pyfunction]
pub fn verify(
    problem: &Bound<'_, Problem>,
    u: &Bound<'_, PyAny>,
    multiplier: &Bound<'_, PyAny>,
) -> PyResult<Certificate> {
    let (py, inner): (_, Arc<ContactProblem>) = (problem.py(), problem.get().inner.clone());
    let (displacement, multiplier) = (finite_reals("u", u)?, finite_reals("multiplier", multiplier)?);
    let place = Place::for_problem(&inner);
    match run(py, place, move |_: &Watch| inner.certify(&displacement, &multiplier))? {
        End::Done(Ok(inner)) => Ok(Certificate { inner }),
        End::Done(Err(error)) => Err(plain_exception(py, error)),
        End::Signalled(signal, _) => Err(signalled(py, signal, None)),
    }
}
