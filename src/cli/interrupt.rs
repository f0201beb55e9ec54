//! An interrupt: the first asks the work to end with what it has, the second ends the program.

use std::time::Duration;

use super::warn;
use crate::watch::Watch;

/// The exit code of a command that was interrupted.
pub(super) const INTERRUPTED: u8 = 130;

/// The work has so long to notice that it should end, so that the program ends within a second.
const PATIENCE: Duration = Duration::from_millis(800);

/// Lets interrupts stop what `watch` watches. A factorisation cannot be stopped: what does not notice in time is ended
/// where it is, which leaves whole files, because every file is written whole or not at all.
pub(super) fn listen(watch: &Watch) {
    let watch = watch.clone();
    let mut is_second = false;
    let handler = move || {
        if std::mem::replace(&mut is_second, true) {
            end();
        }
        watch.stop();
        let watch = watch.clone();
        let patience = std::thread::Builder::new().spawn(move || {
            std::thread::sleep(PATIENCE);
            if !watch.is_noticed() {
                end();
            }
        });
        if patience.is_err() {
            end();
        }
    };
    // Where the system has no interrupts there are none to listen to.
    let _ = ctrlc::set_handler(handler);
}

fn end() -> ! {
    warn("interrupted\n");
    std::process::exit(INTERRUPTED.into())
}

/// What standard error says of an outcome that was reached by an interrupt.
pub(super) fn sentence(watch: &Watch) -> String {
    let place = watch.activity().part.map_or_else(String::new, |part| format!(" in {part}"));
    format!("interrupted{place}: the report is of what was found until then\n")
}
