//! What is being done: a line for each step on standard error if asked for, or one line that is redrawn, with the time that
//! it takes, if that is a terminal.

use std::io::{self, IsTerminal, Write};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::outcome::{ERASED, warn};
use crate::watch::{Activity, Part, Watch};

/// How often the line is drawn.
const PERIOD: Duration = Duration::from_millis(200);

/// Work that takes less shows nothing.
const QUIET: Duration = Duration::from_secs(1);

/// Places of the bar.
const BAR: usize = 20;

/// Fewer parts say little of those to come.
const TELLING_PARTS: usize = 5;

/// Longer lines would be broken by narrow terminals, and could not be erased.
const WIDTH: usize = 79;

/// A watch that writes each step on a line of its own as it begins.
pub(super) fn told() -> Watch {
    Watch::observed(|watch| warn(&format!("progress: {}\n", watch.activity())))
}

/// The line, which follows the activity of a watch until it is dropped.
pub(super) struct Progress(Option<(Sender<()>, JoinHandle<bool>)>);

impl Progress {
    /// Shows what `watch` watches, once it takes longer than a second.
    pub fn of(watch: &Watch) -> Self {
        if !io::stderr().is_terminal() {
            return Progress(None);
        }
        let (end, ended) = mpsc::channel();
        let watch = watch.clone();
        let drawing = thread::Builder::new().spawn(move || {
            let start = Instant::now();
            let mut pace = Pace::default();
            let mut is_shown = false;
            while ended.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                let activity = watch.activity();
                let left = activity.part.as_ref().and_then(|part| pace.left(part));
                // Until an interrupt is noticed, its own line may be the last one.
                let is_pending = watch.is_stopped() && !watch.is_noticed();
                if start.elapsed() >= QUIET && !is_pending {
                    is_shown = true;
                    let line = if watch.is_noticed() {
                        "interrupted: it ends with what there is, at once if interrupted again".to_string()
                    } else {
                        line(&activity, start.elapsed(), left)
                    };
                    warn(&line.chars().take(WIDTH).collect::<String>());
                }
            }
            is_shown
        });
        Progress(drawing.ok().map(|drawing| (end, drawing)))
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some((end, drawing)) = self.0.take() {
            drop(end);
            if drawing.join().unwrap_or(true) {
                // Where it is closed nobody has seen the line.
                let _ = io::stderr().write_all(ERASED.as_bytes());
            }
        }
    }
}

/// When the first part was seen, and which it was.
#[derive(Default)]
struct Pace(Option<(Instant, Part)>);

impl Pace {
    /// The time that this part and those after it will take, once enough have been done.
    fn left(&mut self, part: &Part) -> Option<Duration> {
        let is_new = |(_, first): &(Instant, Part)| (first.name, first.of) != (part.name, part.of);
        if self.0.as_ref().is_none_or(is_new) {
            self.0 = Some((Instant::now(), part.clone()));
        }
        let (start, first) = self.0.as_ref()?;
        let done = part.number.checked_sub(first.number).filter(|&done| done >= TELLING_PARTS)?;
        Some(start.elapsed().mul_f64((part.of + 1).saturating_sub(part.number) as f64 / done as f64))
    }
}

fn line(activity: &Activity, elapsed: Duration, left: Option<Duration>) -> String {
    let step = Activity { part: None, ..activity.clone() };
    let Some(part) = &activity.part else { return format!("{} s: {step}", elapsed.as_secs()) };
    let filled = (BAR as u128 * part.number.saturating_sub(1) as u128 / part.of.max(1) as u128) as usize;
    let bar: String = (0..BAR).map(|place| if place < filled { '#' } else { '.' }).collect();
    let time = match left {
        Some(left) => format!("{:.0} s left", left.as_secs_f64()),
        None => format!("{} s", elapsed.as_secs()),
    };
    format!("[{bar}] {part}, {time}: {step}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done_and_how_long_it_takes() {
        let seconds = Duration::from_secs;
        let alone = Activity { part: None, step: "active set", iteration: 3 };
        assert_eq!(line(&alone, seconds(12), None), "12 s: active set, iteration 3");
        let part = Some(Part { name: "gap", number: 16, of: 30 });
        let one_of_many = Activity { part, step: "factorisation", iteration: 0 };
        let bar = "[##########..........] gap 16 of 30";
        assert_eq!(line(&one_of_many, seconds(12), None), format!("{bar}, 12 s: factorisation"));
        assert_eq!(line(&one_of_many, seconds(12), Some(seconds(7))), format!("{bar}, 7 s left: factorisation"));
        assert_eq!(one_of_many.to_string(), "gap 16 of 30: factorisation");
        assert_eq!(Activity { step: "", ..one_of_many }.to_string(), "gap 16 of 30");
    }
}
