//! Runs work without the interpreter: other threads of Python go on, interrupts are answered, and panics are caught.
//!
//! Short work runs on the calling thread and checks for signals when a step begins. Longer work, for example a
//! factorisation, which cannot be interrupted, runs on a thread of its own. If it does not end soon after an interrupt,
//! the caller no longer waits for it, and its result is dropped.
#![expect(clippy::disallowed_methods, reason = "Python gets a panic as an error")]

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use signorini::{ContactProblem, Prepared, Watch};

use crate::errors::{no_memory, panicked};

/// Time between two checks for signals.
const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

/// Time that the work has after an interrupt to end with its best result so far.
const PATIENCE: Duration = Duration::from_millis(120);

/// Matrices with fewer entries are factorised within some milliseconds.
const FEW_ENTRIES: usize = 30_000;

/// A triangular solve with a factor of fewer values takes less than [`BETWEEN_LOOKS`].
const SHORT_SWEEP: usize = 40_000_000;

/// Condensed problems with fewer dofs are solved in short steps.
const SMALL_BOUNDARY: usize = 1_500;

/// Stack size of a working thread in bytes, as large as that of the main thread of a program.
const STACK: usize = 8 << 20;

/// The thread on which the work runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The calling thread.
    Here,
    /// A thread of its own.
    Apart,
}

impl Place {
    /// Returns the place for work on this problem.
    pub fn for_problem(problem: &ContactProblem) -> Self {
        let entries = problem.stiffness().lower().entries() + problem.contact().entries();
        if entries < FEW_ENTRIES { Place::Here } else { Place::Apart }
    }

    /// Returns the place for another gap or load of a prepared problem. If it is condensed, only short steps remain.
    pub fn for_prepared(problem: &ContactProblem, prepared: &Prepared) -> Self {
        let (condensed, entries) = (prepared.condensed_dofs(), prepared.factor_entries());
        let is_short = condensed < prepared.dofs() && condensed < SMALL_BOUNDARY && (1..SHORT_SWEEP).contains(&entries);
        if is_short { Place::Here } else { Place::for_problem(problem) }
    }
}

/// The end of a piece of work.
pub enum End<T> {
    /// It ended with a result.
    Done(T),
    /// A signal raised this exception; the result is included if it was ready in time.
    Signalled(PyErr, Option<T>),
}

/// Runs `work`, which ends with its best result so far when its watch is stopped.
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

/// Returns the message of a panic.
fn message(panic: &(dyn Any + Send)) -> String {
    let literal = panic.downcast_ref::<&str>().map(ToString::to_string);
    literal.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "without a message".into())
}

fn guarded<T>(work: impl FnOnce(&Watch) -> T, watch: &Watch) -> Result<T, String> {
    // Everything that the work leaves unfinished is dropped with it, so that no broken state can be seen.
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

/// Returns the end of finished work. A signal that came at the last moment carries the result as well.
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
        // The receiver is gone if the result comes too late; that is no error.
        let _ = sender.send(guarded(work, &watched));
    });
    worker.map_err(|error| no_memory(py, format!("no thread could be started: {error}")))?;
    let whole = |done: Result<T, String>| done.map_err(|panic| panicked(py, &panic));
    // A receiver may be used by one thread at a time: by this one, attached to the interpreter or detached from it.
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
