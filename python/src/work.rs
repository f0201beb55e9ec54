//! Work without the interpreter: other threads of Python run meanwhile, interrupts are answered, and no panic gets through.
//!
//! What is soon done runs on the thread that asks for it, and looks for signals as its steps begin. What takes longer, as a
//! factorisation that cannot be interrupted, runs on a thread of its own; if it does not end soon after an interrupt it is left
//! alone, and its result dropped.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use signorini::{ContactProblem, Prepared, Watch};

use crate::errors::{no_memory, panicked};

/// Signals are looked for so often.
const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

/// After an interrupt the work has so long to end with what it has.
const PATIENCE: Duration = Duration::from_millis(120);

/// Matrices of fewer entries are soon factorised: in some milliseconds.
const FEW_ENTRIES: usize = 30_000;

/// A sweep through a factor of fewer values takes less than a look for signals may be away.
const SHORT_SWEEP: usize = 40_000_000;

/// Contact boundaries of fewer dofs are soon solved.
const SMALL_BOUNDARY: usize = 1_500;

/// The stack of a thread that works, in bytes: as that of a program.
const STACK: usize = 8 << 20;

/// Where the work runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// On the thread that asks for it.
    Here,
    /// On a thread of its own.
    Apart,
}

impl Place {
    /// The place for work on this problem.
    pub fn for_problem(problem: &ContactProblem) -> Self {
        let entries = problem.stiffness().lower().entries() + problem.contact().entries();
        if entries < FEW_ENTRIES { Place::Here } else { Place::Apart }
    }

    /// The place for another gap or load of a prepared problem: if it was condensed, all that is left is short steps.
    pub fn for_prepared(problem: &ContactProblem, prepared: &Prepared) -> Self {
        let (condensed, entries) = (prepared.condensed_dofs(), prepared.factor_entries());
        let is_short = condensed < prepared.dofs() && condensed < SMALL_BOUNDARY && (1..SHORT_SWEEP).contains(&entries);
        if is_short { Place::Here } else { Place::for_problem(problem) }
    }
}

/// How work ended.
pub enum End<T> {
    /// With a result.
    Done(T),
    /// A signal raised this exception; with the result, if there was one in time.
    Signalled(PyErr, Option<T>),
}

/// Runs `work`, which ends with what it has if its watch is stopped.
///
/// # Errors
/// `InternalError` for a panic.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    place: Place,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<End<T>> {
    match place {
        Place::Here => here(py, work),
        Place::Apart => apart(py, work),
    }
}

/// The message of a panic.
fn message(panic: &(dyn Any + Send)) -> String {
    let literal = panic.downcast_ref::<&str>().map(ToString::to_string);
    literal.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "without a message".into())
}

fn guarded<T>(work: impl FnOnce(&Watch) -> T, watch: &Watch) -> Result<T, String> {
    // What the work has left half done is dropped with it.
    catch_unwind(AssertUnwindSafe(|| work(watch))).map_err(|panic| message(&*panic))
}

fn here<T: Send>(py: Python<'_>, work: impl FnOnce(&Watch) -> T + Send) -> PyResult<End<T>> {
    let raised: Arc<Mutex<Option<PyErr>>> = Arc::default();
    let last_look = Mutex::new(Instant::now());
    let slot = raised.clone();
    let watch = Watch::observed(move |watch| {
        let mut last = last_look.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() < BETWEEN_LOOKS {
            return;
        }
        *last = Instant::now();
        drop(last);
        if let Err(error) = Python::attach(|py| py.check_signals()) {
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            watch.stop();
        }
    });
    let done = py.detach(|| guarded(work, &watch)).map_err(|panic| panicked(py, &panic))?;
    let raised = raised.lock().unwrap_or_else(PoisonError::into_inner).take();
    Ok(match raised {
        Some(error) => End::Signalled(error, Some(done)),
        None => ended(py, done),
    })
}

/// The end of work that is done: a signal that came in its last moment gets the result, too.
fn ended<T>(py: Python<'_>, done: T) -> End<T> {
    match py.check_signals() {
        Ok(()) => End::Done(done),
        Err(error) => End::Signalled(error, Some(done)),
    }
}

fn apart<T: Send + 'static>(py: Python<'_>, work: impl FnOnce(&Watch) -> T + Send + 'static) -> PyResult<End<T>> {
    let (watch, (sender, receiver)) = (Watch::default(), sync_channel(1));
    let watched = watch.clone();
    let worker = thread::Builder::new().name("signorini".into()).stack_size(STACK).spawn(move || {
        // Nobody receives what comes too late.
        let _ = sender.send(guarded(work, &watched));
    });
    worker.map_err(|error| no_memory(py, format!("no thread for the work: {error}")))?;
    let whole = |done: Result<T, String>| done.map_err(|panic| panicked(py, &panic));
    // A receiver is for one thread at a time: this one, with the interpreter or without.
    let receiver = Mutex::new(receiver);
    let wait =
        |time: Duration| py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(time));
    loop {
        match wait(BETWEEN_LOOKS) {
            Ok(done) => return Ok(ended(py, whole(done)?)),
            Err(RecvTimeoutError::Disconnected) => return Err(panicked(py, "the work ended without a result")),
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Err(error) = py.check_signals() {
            watch.stop();
            let best = wait(PATIENCE).ok().map(whole).transpose()?;
            return Ok(End::Signalled(error, best));
        }
    }
}
