//! Progress: on request a line for each step on standard error. Otherwise, if standard error is a terminal, one line
//! that is redrawn, with the share of the work that is done and the time that is left.

use std::io::{self, IsTerminal, Write};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::outcome::{ERASED, warn};
use crate::qp::{Activity, Part, Watch};

/// The interval between two drawings of the line.
const PERIOD: Duration = Duration::from_millis(200);

/// Work that takes less shows nothing.
const QUIET: Duration = Duration::from_secs(1);

/// Width of the bar in characters.
const BAR: usize = 20;

/// The largest share shown for work that takes longer than expected.
const ALMOST: f64 = 0.99;

/// Least number of finished parts for an estimate of the time left.
const TELLING_PARTS: usize = 5;

/// Longer lines would be broken by narrow terminals, and could not be erased.
const WIDTH: usize = 79;

/// A watch that writes each step on a line of its own as it begins.
pub(super) fn printed() -> Watch {
    Watch::observed(|watch| warn(&format!("progress: {}\n", watch.activity())))
}

/// The line, which follows the activity of a watch until it is dropped.
pub(super) struct Progress(Option<(Sender<()>, JoinHandle<bool>)>);

impl Progress {
    /// Shows the activity of `watch`, once it takes longer than a second.
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
                        "interrupted: the program ends with the results so far; interrupt it again to end at once"
                            .to_string()
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
                // If standard error is closed, the line was not visible.
                let _ = io::stderr().write_all(ERASED.as_bytes());
            }
        }
    }
}

/// The time at which the first part was seen, and its number.
#[derive(Default)]
struct Pace(Option<(Instant, Part)>);

impl Pace {
    /// The time for this part and the later ones, once enough parts are done.
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
    let passed = format!("{} passed", time(elapsed));
    if let Some(part) = &activity.part {
        let done = part.number.saturating_sub(1) as f64 / part.of.max(1) as f64;
        let time = left.map_or(passed, |left| format!("{} left", time(left)));
        return format!("{} {part}, {time}: {step}", bar(done));
    }
    match activity.timed.filter(|(_, expected)| *expected >= QUIET) {
        Some((began, expected)) => {
            let (done, left) = of_expected(began.elapsed(), expected);
            let time = left.map_or(passed, |left| format!("about {} left of this", time(left)));
            format!("{} {time}: {step}", bar(done))
        }
        None => format!("{passed}: {step}"),
    }
}

/// The finished share of the work after a part of its expected time, and the time left; `None` if it takes longer than
/// expected.
fn of_expected(passed: Duration, expected: Duration) -> (f64, Option<Duration>) {
    let share = passed.as_secs_f64() / expected.as_secs_f64();
    (share.min(ALMOST), expected.checked_sub(passed))
}

/// A bar, filled to this share.
fn bar(done: f64) -> String {
    let filled = (BAR as f64 * done) as usize;
    let bar: String = (0..BAR).map(|place| if place < filled { '#' } else { '.' }).collect();
    format!("[{bar}] {:.0} %", (100.0 * done).floor())
}

/// A time in readable units.
fn time(time: Duration) -> String {
    match time.as_secs_f64().round() as u64 {
        seconds @ 0..60 => format!("{seconds} s"),
        seconds @ 60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        seconds => format!("{} h {} min", seconds / 3600, seconds / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done_what_share_of_it_and_how_long_it_takes() {
        let seconds = Duration::from_secs;
        let alone = Activity { step: "active set", iteration: 3, ..Activity::default() };
        assert_eq!(line(&alone, seconds(12), None), "12 s passed: active set, iteration 3");
        let part = Some(Part { name: "gap", number: 16, of: 30 });
        let one_of_many = Activity { part, step: "factorisation", ..Activity::default() };
        let bar = "[##########..........] 50 % gap 16 of 30";
        assert_eq!(line(&one_of_many, seconds(12), None), format!("{bar}, 12 s passed: factorisation"));
        assert_eq!(
            line(&one_of_many, seconds(12), Some(seconds(77))),
            format!("{bar}, 1 min 17 s left: factorisation")
        );
        assert_eq!(one_of_many.to_string(), "gap 16 of 30: factorisation");
        assert_eq!(Activity { step: "", ..one_of_many }.to_string(), "gap 16 of 30");
    }

    #[test]
    fn work_of_a_known_length_shows_its_share_and_never_all_of_it() {
        let seconds = Duration::from_secs;
        assert_eq!(of_expected(seconds(3), seconds(12)), (0.25, Some(seconds(9))));
        assert_eq!(of_expected(seconds(13), seconds(12)), (ALMOST, None));
        let timed = Some((Instant::now(), seconds(3600)));
        let one = Activity { step: "factorisation", timed, ..Activity::default() };
        let shown = line(&one, seconds(2), None);
        assert!(shown.starts_with("[....................] 0 % about "), "{shown}");
        assert!(shown.ends_with(" left of this: factorisation"), "{shown}");
        let short = Activity { timed: Some((Instant::now(), QUIET / 2)), ..one };
        assert_eq!(line(&short, seconds(2), None), "2 s passed: factorisation");
        let times = [59, 60, 3599, 3600, 7325].map(|length| time(seconds(length)));
        assert_eq!(times, ["59 s", "1 min 0 s", "59 min 59 s", "1 h 0 min", "2 h 2 min"]);
    }
}
