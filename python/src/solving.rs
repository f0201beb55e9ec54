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

/// Solves a contact problem. The solution is certified: its conditions and its error are recomputed from the problem.
///
/// Parameters
/// ----------
/// problem : Problem
///     The problem.
/// method : str, optional
///     "auto" (the default) chooses by estimates of time and memory. "active-set" exchanges closed rows, by one factor
///     of K, and ends with an exact linear solve. "qp" is an interior-point method; the active set makes its contact
///     set exact. "penalty" puts stiff springs on the closed rows, with an error of about 1e-8. "mprgp" takes multigrid
///     instead of a factor, for large bodies.
/// accuracy : float or "exact", optional
///     A relative error of u in the energy norm that is good enough, for example 1e-3. It is positive and replaces
///     `tolerance`. "exact" makes "auto" take the active set. Without it `tolerance` decides.
/// time : float, optional
///     Limit in seconds, positive. After it the best solution so far is taken; it must still be certified. A
///     factorisation that has begun is finished first. No limit by default.
/// start : Solution or array, optional
///     Where the method starts. A solution of a problem of the same size; or the indices of closed rows, from 0, as an
///     array of numpy with an integer dtype; or a displacement, shape (n,), as an array of real numbers. It changes the
///     number of iterations. If the solve fails, it is repeated without the start.
/// threads : int, optional
///     Number of threads, from 1 to 64, or to four times the processors if that is more. By default a factorisation has
///     one, and multigrid on 50,000 dofs or more has those of the machine, at most 8. Threads change no bit of the
///     solution.
/// tolerance : float, optional
///     Largest relative residual, and largest relative error of u in the energy norm, of a certified solution. It is
///     positive; the default is 1e-9.
/// memory : float, optional
///     Limit in bytes, positive. "auto" avoids methods whose estimate is larger; another method is refused. The default
///     is the memory that the machine has available.
/// precision : str, optional
///     Precision of the factor: "auto" (the default) and "double" are the same. "mixed" is refused; for less memory
///     take the method "mprgp".
/// condense : bool, optional
///     True (the default) reduces the problem to the dofs of its contact rows if an estimate shows that it pays. False
///     never does.
/// proof : bool, optional
///     True (the default) proves which rows are open and which are closed (`Solution.proven`). False saves that time.
///
/// Returns
/// -------
/// Solution
///     Its certificate meets `tolerance`, or `accuracy`.
///
/// Raises
/// ------
/// BadInput
///     An option has a value that is not allowed, or `start` does not fit the problem.
/// BadType or TypeError
///     An argument has a wrong type.
/// Infeasible
///     Rows contradict each other. The exception names them, with a proof.
/// Unbounded
///     The load moves the body away without end.
/// UnderHeld
///     Supports and contact do not hold the body, so that the solution is not unique.
/// NotConvex
///     K has a negative eigenvalue.
/// NotCertified
///     The tolerance is not reached. The exception carries the best solution.
/// Undecided
///     It could not be decided whether the problem has one solution.
/// OutOfTime or TooLarge
///     The time or the memory does not suffice.
/// NumericalError
///     A computation fails, for example by overflow.
/// Interrupted
///     Ctrl-C was pressed. The exception carries the best solution so far, if there is one.
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

/// Solves a contact problem by the interior-point method; the active-set method makes its contact set exact.
///
/// It does the same as `solve(problem, method="qp")`.
///
/// Parameters
/// ----------
/// problem : Problem
///     The problem.
///
/// Returns
/// -------
/// Solution
///     It is certified to 1e-9.
///
/// Raises
/// ------
/// SignoriniError or Interrupted
///     As `solve`.
#[pyfunction]
pub fn solve_qp(problem: &Bound<'_, Problem>) -> PyResult<Py<PyAny>> {
    let method = pyo3::types::PyString::new(problem.py(), "qp").into_any();
    solve(problem, Some(method), None, None, None, None, None, None, None, true, true)
}

/// Factorises a problem once, to solve it for several gaps, loads or starts.
///
/// Parameters
/// ----------
/// problem : Problem
///     The problem.
/// gaps : int, optional
///     Number of solves that you expect, 10 by default. "auto" chooses the method by it. More or fewer solves are
///     allowed.
/// method, accuracy, threads, tolerance, memory, precision, condense, proof : optional
///     As in `solve`. They hold for each solve.
///
/// Returns
/// -------
/// Prepared
///     The factor of K, or a multigrid hierarchy, with the methods that use it.
///
/// Raises
/// ------
/// BadInput
///     An option has a value that is not allowed.
/// BadType or TypeError
///     An argument has a wrong type.
/// OverflowError
///     `gaps` is negative.
/// Infeasible
///     Rows contradict each other at the gaps of the problem.
/// TooLarge
///     The memory does not suffice.
/// NumericalError
///     A computation fails.
/// Interrupted
///     Ctrl-C was pressed.
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

/// Returns the certificate of a solution that comes from elsewhere.
///
/// Parameters
/// ----------
/// problem : Problem
///     The problem.
/// u : array, shape (n,)
///     Displacement, in length.
/// multiplier : array, shape (m,)
///     Contact multipliers, in force, <= 0 in compression.
/// equality_multiplier : array, shape (p,), optional
///     Multipliers of the equality rows, in force, of either sign. Needed if the problem has such rows.
///
/// Returns
/// -------
/// Certificate
///     The residuals and the bound on the error of u, whether they are small or not.
///
/// Raises
/// ------
/// BadInput
///     An array has a wrong length, or a value that is not finite.
/// BadType or TypeError
///     An argument has a wrong type.
/// NumericalError
///     The factorisation of K fails.
/// Interrupted
///     Ctrl-C was pressed.
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
