//! An interrupt, or a request to terminate: the first asks the work to end with what it has, the second ends the
//! program.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::outcome::warn;
use crate::qp::Watch;

/// The exit code of a command that was interrupted.
pub(super) const INTERRUPTED: u8 = 130;

/// The time in which the work must notice the request, so that the program ends within a second.
const PATIENCE: Duration = Duration::from_millis(800);

/// The message if there is a report.
const UNTIL_THEN: &str = "interrupted: the report has the results up to there\n";

/// Bytes of the stack of a thread that waits for a signal or a moment: the default of 2 MB would count against a limit
/// of the address space.
const STACK: usize = 64 << 10;

/// The report of the best answer so far, for a program that ends before its work notices an interrupt.
#[derive(Clone, Default)]
pub(super) struct Kept(Arc<Mutex<Option<String>>>);

impl Kept {
    /// The report, even after a panic of another thread: it is written whole.
    fn locked(&self) -> MutexGuard<'_, Option<String>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps a report instead of the one before.
    pub fn keep(&self, report: String) {
        *self.locked() = Some(report);
    }

    /// Calls `last` with the kept report, and forgets it. Any other caller waits until `last` returns.
    pub fn take_to<T>(&self, last: impl FnOnce(Option<String>) -> T) -> T {
        let mut kept = self.locked();
        last(kept.take())
    }
}

/// Lets interrupts stop the work that `watch` observes. A factorisation cannot be stopped: work that does not notice in
/// time is ended at once, with the report of the best answer if one is `kept`. Files remain complete, because every
/// file is written as a whole or not at all.
pub(super) fn listen(watch: &Watch, kept: &Kept) {
    let (watch, kept) = (watch.clone(), kept.clone());
    let mut is_second = false;
    let handler = move || {
        if std::mem::replace(&mut is_second, true) {
            end();
        }
        watch.stop();
        let (watch, kept) = (watch.clone(), kept.clone());
        let patience = std::thread::Builder::new().stack_size(STACK).spawn(move || {
            std::thread::sleep(PATIENCE);
            if !watch.is_noticed() {
                end_with(&kept);
            }
        });
        if patience.is_err() {
            end();
        }
    };
    on_request(handler);
}

/// Calls `handler` at every interrupt (SIGINT) and every request to terminate (SIGTERM). If the system refuses, these
/// signals end the program as they do by default.
#[cfg(unix)]
fn on_request(mut handler: impl FnMut() + Send + 'static) {
    use signal_hook::consts::{SIGINT, SIGTERM};

    let listening = std::thread::Builder::new().stack_size(STACK).spawn(move || {
        if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
            signals.forever().for_each(|_| handler());
        }
    });
    drop(listening);
}

/// Calls `handler` at every interrupt of the terminal.
#[cfg(not(unix))]
fn on_request(handler: impl FnMut() + Send + 'static) {
    // A system without interrupts needs no handler.
    let _ = ctrlc::set_handler(handler);
}

/// Ends with the report of the best answer so far, if one is kept. The work that ends meanwhile waits, and prints
/// nothing.
fn end_with(kept: &Kept) -> ! {
    kept.take_to(|report| {
        let Some(report) = report else { end() };
        warn(UNTIL_THEN);
        // With a closed pipe there is no reader.
        let _ = io::stdout().write_all(report.as_bytes()).and_then(|()| io::stdout().flush());
        std::process::exit(INTERRUPTED.into())
    })
}

fn end() -> ! {
    warn("interrupted\n");
    std::process::exit(INTERRUPTED.into())
}

/// The message on standard error about an outcome after an interrupt.
pub(super) fn sentence(watch: &Watch) -> String {
    match watch.activity().part {
        Some(part) => UNTIL_THEN.replacen("interrupted", &format!("interrupted in {part}"), 1),
        None => UNTIL_THEN.into(),
    }
}
