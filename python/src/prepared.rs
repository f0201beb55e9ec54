//! A problem that is factorised once for many gaps, loads and starts, and the exact path between two gap vectors.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyList;
use signorini::qp::Error;
use signorini::{ContactProblem, Settings, Watch};

use crate::answered::{answered, start_of};
use crate::arrays::{of_reals, reals};
use crate::delassus::Delassus;
use crate::errors::bad_input;
use crate::exceptions::plain_exception;
use crate::exceptions::signalled;
use crate::solution::{Solution, Source, rows_of};
use crate::work::{End, Place, run};

/// A problem that is factorised once and then solved for many gaps, loads and starts. `signorini.prepare` makes it.
#[pyclass(frozen, module = "signorini")]
pub struct Prepared {
    problem: Arc<ContactProblem>,
    inner: signorini::Prepared,
    settings: Settings,
}

impl Prepared {
    pub fn new(problem: Arc<ContactProblem>, inner: signorini::Prepared, settings: Settings) -> Self {
        Prepared { problem, inner, settings }
    }

    fn source(&self) -> Source {
        let (problem, settings, prepared) = (self.problem.clone(), self.settings.clone(), Some(self.inner.clone()));
        Source { problem, settings, prepared }
    }

    fn gap(&self, g: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
        g.map_or_else(|| Ok(self.problem.inequalities_given().1.to_vec()), |g| reals("g", g))
    }
}

/// Returns the prepared problem with `watch` in its settings.
fn watched(prepared: &signorini::Prepared, settings: Settings, watch: &Watch) -> Result<signorini::Prepared, Error> {
    prepared.with_settings(&settings.watched(watch))
}

#[pymethods]
impl Prepared {
    /// Solves the problem for these gaps and this load.
    ///
    /// Parameters
    /// ----------
    /// g : array, shape (m,), optional
    ///     Gaps, in length; those of the problem by default. With a factor `inf` must be in the same rows as in the
    ///     problem.
    /// f : array, shape (n,), optional
    ///     Load, in force; that of the problem by default.
    /// start : Solution or array, optional
    ///     As in `signorini.solve`; mostly the solution for the gaps before. It changes the number of iterations.
    /// time : float, optional
    ///     Limit in seconds, positive, for this solve. No limit by default.
    ///
    /// Returns
    /// -------
    /// Solution
    ///     It is certified as that of `signorini.solve`.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     An array does not fit the problem, or `time` is not positive.
    /// SignoriniError, TypeError or Interrupted
    ///     As `signorini.solve`.
    #[pyo3(signature = (g = None, f = None, *, start = None, time = None))]
    fn solve(
        &self,
        py: Python<'_>,
        g: Option<&Bound<'_, PyAny>>,
        f: Option<&Bound<'_, PyAny>>,
        start: Option<&Bound<'_, PyAny>>,
        time: Option<f64>,
    ) -> PyResult<Py<PyAny>> {
        let gap = self.gap(g)?;
        let load = f.map(|f| reals("f", f)).transpose()?;
        let start = start_of(start, &self.problem)?;
        let mut settings = self.settings.clone();
        if let Some(seconds) = time {
            let span = std::time::Duration::try_from_secs_f64(seconds).ok().filter(|span| !span.is_zero());
            let sentence = || format!("time is {seconds}; it must be a number of seconds that is positive and finite");
            settings.time = Some(span.ok_or_else(|| bad_input(py, sentence()))?);
        }
        let place = Place::for_prepared(&self.problem, &self.inner);
        let prepared = self.inner.clone();
        let of_load = load.clone().unwrap_or_else(|| self.problem.load().to_vec());
        let of_gap = gap.clone();
        let find = move |watch: &Watch| {
            let mut prepared = watched(&prepared, settings, watch)?;
            if let Some(load) = load {
                prepared = prepared.with_load(load)?;
            }
            start.map_or(prepared.clone(), |start| prepared.starting_from(start)).solve(&gap)
        };
        answered(py, place, find, |solution| {
            let source = self.source().at(of_load.clone(), of_gap.clone());
            Solution::object(py, solution, Some(source.map_err(|error| plain_exception(py, error))?))
        })
    }

    /// Returns what a solve tries, in order, each with its condition and its reason: a text, one line each. It solves
    /// nothing.
    ///
    /// Returns
    /// -------
    /// str
    ///     The attempts, and the steps that may follow in each.
    fn plan(&self) -> String {
        self.inner.plan()
    }

    /// Computes the exact solutions for all gaps on the straight line from g0 to g1.
    ///
    /// Parameters
    /// ----------
    /// g0 : array, shape (m,)
    ///     The first gaps, in length.
    /// g1 : array, shape (m,)
    ///     The last gaps, in length. A gap that is `inf` in g0 is `inf` here too.
    ///
    /// Returns
    /// -------
    /// Path
    ///     The solutions as functions of t: t = 0 belongs to g0, t = 1 to g1.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     An array does not fit the problem; the problem was not condensed; or only contact rows hold the body.
    /// SignoriniError or Interrupted
    ///     As `signorini.solve`, for both ends.
    fn path(&self, py: Python<'_>, g0: &Bound<'_, PyAny>, g1: &Bound<'_, PyAny>) -> PyResult<Path> {
        let (from, to) = (reals("g0", g0)?, reals("g1", g1)?);
        let (prepared, settings) = (self.inner.clone(), self.settings.clone());
        let walk = move |watch: &Watch| watched(&prepared, settings, watch)?.path(&from, &to);
        match run(py, Place::for_problem(&self.problem), walk)? {
            End::Done(Ok(inner)) => Ok(Path { source: self.source(), inner: Arc::new(inner) }),
            End::Done(Err(error)) => Err(plain_exception(py, error)),
            End::Signalled(signal, _) => Err(signalled(py, signal, None)),
        }
    }

    /// Makes the linear complementarity problem of the contact forces, at the load and the gaps of the problem.
    ///
    /// Returns
    /// -------
    /// Delassus
    ///     Its matrix M is dense. Equality rows are eliminated.
    ///
    /// Raises
    /// ------
    /// BadInput
    ///     M does not fit into memory; nothing is made then.
    /// SignoriniError or Interrupted
    ///     As `signorini.solve`.
    fn delassus(&self, py: Python<'_>) -> PyResult<Delassus> {
        let (prepared, settings) = (self.inner.clone(), self.settings.clone());
        let make = move |watch: &Watch| watched(&prepared, settings, watch)?.delassus();
        match run(py, Place::for_problem(&self.problem), make)? {
            End::Done(Ok(inner)) => Ok(Delassus::new(inner)),
            End::Done(Err(error)) => Err(plain_exception(py, error)),
            End::Signalled(signal, _) => Err(signalled(py, signal, None)),
        }
    }

    /// Number of unknowns n of the problem.
    #[getter]
    fn dofs(&self) -> usize {
        self.inner.dofs()
    }

    /// Number of unknowns on which the methods work; smaller than `dofs` if the problem is condensed.
    #[getter]
    fn condensed_dofs(&self) -> usize {
        self.inner.condensed_dofs()
    }

    /// Number of values in the factor of K; 0 if K was not factorised.
    #[getter]
    fn factor_entries(&self) -> usize {
        self.inner.factor_entries()
    }

    /// Wall-clock time of the preparation, in seconds.
    #[getter]
    fn seconds(&self) -> f64 {
        self.inner.seconds().solve
    }

    fn __repr__(&self) -> String {
        let (dofs, condensed) = (self.inner.dofs(), self.inner.condensed_dofs());
        let by = if self.inner.hierarchy().is_some() { "a multigrid hierarchy" } else { "a factor" };
        format!("<signorini.Prepared: {dofs} dofs, {condensed} after condensation, {by}>")
    }
}

/// A point of a path at which a row closes or opens.
#[pyclass(frozen, module = "signorini", get_all)]
pub struct Event {
    /// Place t of the event on the path, from 0 to 1.
    at: f64,
    /// Index of the row, counted from 0.
    row: usize,
    /// True if the row closes as t grows, False if it opens.
    touches: bool,
}

#[pymethods]
impl Event {
    fn __repr__(&self) -> String {
        let (what, row, at) = (if self.touches { "touches" } else { "releases" }, self.row, self.at);
        format!("<signorini.Event: row {row} {what} at {at:.6}>")
    }
}

/// The exact solutions for all gaps (1 - t) g0 + t g1 with t from 0 to 1. They are piecewise linear in t.
///
/// `Prepared.path` makes it.
#[pyclass(frozen, module = "signorini")]
pub struct Path {
    /// The problem at its own gaps.
    source: Source,
    inner: Arc<signorini::Path>,
}

/// Returns t if it is a place on a path.
fn place(py: Python<'_>, t: f64) -> PyResult<f64> {
    let sentence = || format!("t is {t}; it must be from 0, the first gap, to 1, the last");
    if (0.0..=1.0).contains(&t) { Ok(t) } else { Err(bad_input(py, sentence())) }
}

#[pymethods]
impl Path {
    /// List of all points at which a row closes or opens, in the order of t.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let of_each = self.inner.events().iter();
        let events = of_each.map(|event| Py::new(py, Event { at: event.at, row: event.row, touches: event.touches }));
        PyList::new(py, events.collect::<PyResult<Vec<_>>>()?)
    }

    /// Places t between which the solution is linear, increasing: 0, every event, 1. Read-only.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.corners())
    }

    /// Returns the gaps at t.
    ///
    /// Parameters
    /// ----------
    /// t : float
    ///     Place on the path, from 0 to 1.
    ///
    /// Returns
    /// -------
    /// array, shape (m,)
    ///     In length, read-only.
    ///
    /// Raises
    /// ------
    /// BadInput or TypeError
    ///     t is outside of [0, 1], or no number.
    fn gap<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.gap(place(py, t)?))
    }

    /// Returns the contact multipliers at t.
    ///
    /// Parameters
    /// ----------
    /// t : float
    ///     Place on the path, from 0 to 1.
    ///
    /// Returns
    /// -------
    /// array, shape (m,)
    ///     In force, <= 0 in compression, read-only.
    ///
    /// Raises
    /// ------
    /// BadInput or TypeError
    ///     t is outside of [0, 1], or no number.
    fn multiplier<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.multiplier(place(py, t)?))
    }

    /// Returns the multipliers of the equality rows at t.
    ///
    /// Parameters
    /// ----------
    /// t : float
    ///     Place on the path, from 0 to 1.
    ///
    /// Returns
    /// -------
    /// array, shape (p,)
    ///     In force, of either sign, read-only.
    ///
    /// Raises
    /// ------
    /// BadInput or TypeError
    ///     t is outside of [0, 1], or no number.
    fn equality_multiplier<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyAny>> {
        of_reals(py, &self.inner.equality_multiplier(place(py, t)?))
    }

    /// Returns the closed rows at t; at an event, those just before it.
    ///
    /// Parameters
    /// ----------
    /// t : float
    ///     Place on the path, from 0 to 1.
    ///
    /// Returns
    /// -------
    /// array of int
    ///     Indices of the rows, counted from 0, increasing, read-only.
    ///
    /// Raises
    /// ------
    /// BadInput or TypeError
    ///     t is outside of [0, 1], or no number.
    fn contact_set<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyAny>> {
        rows_of(py, &self.inner.contact_set(place(py, t)?))
    }

    /// Returns the whole solution at t, with its certificate.
    ///
    /// Parameters
    /// ----------
    /// t : float
    ///     Place on the path, from 0 to 1.
    ///
    /// Returns
    /// -------
    /// Solution
    ///     It is certified as that of `Prepared.solve`.
    ///
    /// Raises
    /// ------
    /// BadInput or TypeError
    ///     t is outside of [0, 1], or no number.
    /// SignoriniError or Interrupted
    ///     As `signorini.solve`.
    fn solution(&self, py: Python<'_>, t: f64) -> PyResult<Py<PyAny>> {
        let (t, path) = (place(py, t)?, self.inner.clone());
        let find = move |_: &Watch| path.solution(t);
        let (place, load) = (Place::for_problem(&self.source.problem), self.source.problem.load());
        answered(py, place, find, |solution| {
            let source = self.source.at(load.to_vec(), self.inner.gap(t));
            Solution::object(py, solution, Some(source.map_err(|error| plain_exception(py, error))?))
        })
    }

    fn __repr__(&self) -> String {
        let (events, corners) = (self.inner.events().len(), self.inner.corners().len());
        format!("<signorini.Path: {events} events, {corners} corners>")
    }
}
