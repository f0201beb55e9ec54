//! A solve from a start, and the Python object of its solution.

use pyo3::prelude::*;
use signorini::{ContactProblem, ContactSet, Error, Prepared, Settings, Start, Watch, qp};

use crate::arrays::{Indices, finite_reals};
use crate::errors::bad_input;
use crate::exceptions::{exception, signalled};
use crate::solution::Solution;
use crate::work::{End, Place, run};

/// Reads the start of a solve: a solution, an array of closed rows (integers), or a displacement (real numbers).
pub fn start_of(start: Option<&Bound<'_, PyAny>>, problem: &ContactProblem) -> PyResult<Option<Start>> {
    let Some(start) = start else { return Ok(None) };
    let py = start.py();
    if let Ok(solution) = start.cast::<Solution>() {
        let known = &solution.get().inner;
        if known.displacement.len() != problem.dofs() || known.contact_set.rows() != problem.inequalities() {
            let sentence = format!(
                "start has {} dofs and {} rows; the problem has {} dofs and {} rows",
                known.displacement.len(),
                known.contact_set.rows(),
                problem.dofs(),
                problem.inequalities()
            );
            return Err(bad_input(py, sentence));
        }
        return Ok(Some(Start::from(&**known)));
    }
    let is_rows = start
        .getattr("dtype")
        .and_then(|dtype| dtype.getattr("kind"))
        .is_ok_and(|kind| kind.extract::<String>().is_ok_and(|kind| kind == "i" || kind == "u"));
    if is_rows {
        let rows = Indices::of("start", start)?.to_usize(py)?;
        if let Some(row) = rows.iter().find(|&&row| row >= problem.inequalities()) {
            let row = if *row == usize::MAX { "a negative number".into() } else { row.to_string() };
            let sentence =
                format!("start names the row {row}; rows go from 0 to {}", problem.inequalities().saturating_sub(1));
            return Err(bad_input(py, sentence));
        }
        let mut set = ContactSet::open(problem.inequalities());
        rows.into_iter().for_each(|row| set.insert(row));
        return Ok(Some(set.into()));
    }
    let displacement = finite_reals("start", start)?;
    if displacement.len() != problem.dofs() {
        let sentence =
            format!("start has length {}; the displacement has length {}", displacement.len(), problem.dofs());
        return Err(bad_input(py, sentence));
    }
    Ok(Some(Start::near(displacement)))
}

/// Solves from `start`; if that fails, solves once more without a start.
pub fn solve_from(
    problem: &ContactProblem,
    start: Option<Start>,
    settings: &Settings,
) -> Result<signorini::Solution, qp::Error> {
    let Some(start) = start else { return signorini::solve(problem, settings) };
    let prepared = Prepared::for_gaps(problem, 1, settings);
    match prepared.and_then(|prepared| prepared.starting_from(start).solve(problem.gap())) {
        Err(_) if !settings.watch.is_over() => signorini::solve(problem, settings),
        solved => solved,
    }
}

/// Runs `find` and makes the Python object of its solution. The exception of an interrupt carries the best solution.
pub fn answered<E: Into<Error> + Send + 'static>(
    py: Python<'_>,
    place: Place,
    find: impl FnOnce(&Watch) -> Result<signorini::Solution, E> + Send + 'static,
    object: impl Fn(signorini::Solution) -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let end = run(py, place, find)?;
    match end {
        End::Done(Ok(solution)) => object(solution),
        End::Done(Err(error)) => Err(exception(py, error, object)),
        End::Signalled(signal, best) => {
            let best = best
                .and_then(|ended| ended.map_or_else(|error| error.into().into_best(), Some))
                .map(object)
                .transpose()?;
            Err(signalled(py, signal, best))
        }
    }
}
