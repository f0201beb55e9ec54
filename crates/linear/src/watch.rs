//! State shared by a solve and its caller: a request to stop, a deadline, the current step, and the speed of this
//! machine against the estimates of cost.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Finishing an answer, for example its certificate, may take this share of the time beyond the deadline.
const FINISHING: f64 = 0.1;

/// Work shorter than this is too short to measure the pace.
const TELLING_SECONDS: f64 = 1e-3;

/// The work that a command does at the moment: its part, its step and its iteration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Activity {
    /// The part of the work if there are several, such as one gap of a sweep.
    pub part: Option<Part>,
    /// The step of the work, such as `factorisation`; empty before the first.
    pub step: &'static str,
    /// The iteration of the step, from 1; 0 if the step has no iterations.
    pub iteration: usize,
    /// Start and expected duration of the current work, if it is [timed](Watch::timed).
    pub timed: Option<(Instant, Duration)>,
}

/// One of several parts of a longer work, such as a point of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the parts, such as `gap`.
    pub name: &'static str,
    /// Number of this part, from 1.
    pub number: usize,
    /// The number of all parts together.
    pub of: usize,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} of {}", self.name, self.number, self.of)
    }
}

impl fmt::Display for Activity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = self.part.as_ref().map(Part::to_string);
        let step = match self.iteration {
            _ if self.step.is_empty() => None,
            0 => Some(self.step.to_string()),
            iteration => Some(format!("{}, iteration {iteration}", self.step)),
        };
        f.write_str(&part.into_iter().chain(step).collect::<Vec<_>>().join(": "))
    }
}

/// A handle on running work: any thread can ask it to stop and read its current step.
///
/// Clones share the request, the activity and the observer; each clone has its own deadline. A solve checks the watch
/// between factorisations, iterations and steps, and ends with the best answer so far.
///
/// ```
/// use signorini_linear::watch::Watch;
///
/// let watch = Watch::default();
/// let of_work = watch.clone();
/// std::thread::spawn(move || watch.stop()).join().unwrap();
/// assert!(of_work.is_over() && of_work.is_noticed());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Watch {
    deadline: Option<Deadline>,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    is_stopped: AtomicBool,
    is_noticed: AtomicBool,
    activity: Mutex<Activity>,
    /// Measured seconds per estimated second; `None` before anything was measured.
    pace: Mutex<Option<f64>>,
    observer: Observer,
}

type Call = dyn Fn(&Watch) + Send + Sync;

/// The function that is called whenever a part, a step or an iteration begins.
#[derive(Default)]
struct Observer(Option<Box<Call>>);

impl fmt::Debug for Observer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Observer" } else { "no observer" })
    }
}

/// The data of a mutex, even after a panic of another thread: every value here is written whole.
pub fn locked<T>(data: &Mutex<T>) -> MutexGuard<'_, T> {
    data.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Watch {
    /// A watch that calls `observer` whenever a part, a step or an iteration begins: on the thread that does the work,
    /// and before the work is done. [`Watch::activity`] is then the one that begins.
    ///
    /// ```
    /// use signorini_linear::watch::Watch;
    ///
    /// let watch = Watch::observed(|watch| {
    ///     if watch.activity().step == "ordering" {
    ///         watch.stop();
    ///     }
    /// });
    /// watch.step("ordering", 0);
    /// assert!(watch.is_stopped());
    /// ```
    pub fn observed(observer: impl Fn(&Watch) + Send + Sync + 'static) -> Watch {
        let observer = Observer(Some(Box::new(observer)));
        Watch { shared: Arc::new(Shared { observer, ..Shared::default() }), ..Watch::default() }
    }

    /// Asks the work to end with its best answer so far.
    pub fn stop(&self) {
        self.shared.is_stopped.store(true, SeqCst);
    }

    /// Returns `true` if the work was asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.shared.is_stopped.load(SeqCst)
    }

    /// Returns `true` if the work was asked to stop, and takes down that the work has [noticed](Self::is_noticed) it:
    /// work asks this where it can end, and then ends.
    pub fn acknowledge(&self) -> bool {
        let stopped = self.is_stopped();
        self.shared.is_noticed.fetch_or(stopped, SeqCst);
        stopped
    }

    /// Returns `true` if the work has noticed the request to stop. A factorisation, for example, does not notice it.
    pub fn is_noticed(&self) -> bool {
        self.shared.is_noticed.load(SeqCst)
    }

    /// Returns `true` if the work must end: it was asked to stop, or its deadline has passed. Work asks this where it
    /// can end, and then ends: the watch takes down that the work has [noticed](Self::is_noticed) the request, or what
    /// the deadline cut short.
    pub fn is_over(&self) -> bool {
        let passed = self.deadline.as_ref().filter(|deadline| deadline.left() == 0.0);
        if let Some(deadline) = passed {
            deadline.cut.get_or_init(|| Cut { activity: self.activity(), refused: None });
        }
        self.acknowledge() || passed.is_some()
    }

    /// The part, step and iteration that run at present.
    pub fn activity(&self) -> Activity {
        locked(&self.shared.activity).clone()
    }

    /// The same watch with a deadline `seconds` from now, or with its own deadline if that is sooner.
    pub fn within(&self, seconds: f64) -> Watch {
        let deadline = match (&self.deadline, Deadline::within(seconds)) {
            (Some(own), Some(other)) => Some(own.or_sooner(other)),
            (own, other) => other.or_else(|| own.clone()),
        };
        Watch { deadline, ..self.clone() }
    }

    /// The same watch without a deadline.
    pub fn unhurried(&self) -> Watch {
        Watch { deadline: None, ..self.clone() }
    }

    /// The same watch with the deadline sooner by the time that work of `estimate` seconds needs. A loop with steps of
    /// that length then ends before a step that would not finish in time.
    pub fn keeping(&self, estimate: f64) -> Watch {
        let deadline = self.deadline.as_ref().map(|deadline| deadline.sooner(self.needed(estimate)));
        Watch { deadline, ..self.clone() }
    }

    /// The same watch for finishing an answer, for example its certificate: its deadline is later by a share of the
    /// time.
    pub fn finishing(&self) -> Watch {
        let later =
            |own: &Deadline| Some(Deadline { at: own.at.checked_add(own.span.mul_f64(FINISHING))?, ..own.clone() });
        Watch { deadline: self.deadline.as_ref().and_then(later), ..self.clone() }
    }

    /// Seconds until the deadline, if there is one.
    pub fn time_left(&self) -> Option<f64> {
        self.deadline.as_ref().map(Deadline::left)
    }

    /// Returns `true` if there is time left for work that is estimated to take `estimate` seconds. If not, the watch
    /// takes down that the deadline left out this work.
    pub fn allows(&self, estimate: f64) -> bool {
        let Some(deadline) = &self.deadline else { return true };
        let (left, needed) = (deadline.left(), self.needed(estimate));
        if needed >= left {
            deadline.cut.get_or_init(|| Cut { activity: self.activity(), refused: Some([needed, left]) });
        }
        needed < left
    }

    /// The first work that the deadline cut short or left out, in words; `None` if nothing.
    pub fn cut(&self) -> Option<String> {
        self.deadline.as_ref()?.cut.get().map(Cut::to_string)
    }

    /// Seconds that work needs on this machine: `estimate` times the pace of the work that was [timed](Self::timed)
    /// last.
    pub fn needed(&self, estimate: f64) -> f64 {
        estimate * self.pace().unwrap_or(1.0)
    }

    /// Sets the pace: from now on work is expected to take `pace` times its estimate.
    pub fn learn(&self, pace: f64) {
        *locked(&self.shared.pace) = Some(pace);
    }

    /// Measured seconds per estimated second; `None` before anything was timed.
    pub fn pace(&self) -> Option<f64> {
        *locked(&self.shared.pace)
    }

    /// Runs `work`, which is estimated to take `estimate` seconds, and measures the pace of this machine by it.
    pub fn timed<T>(&self, estimate: f64, work: impl FnOnce() -> T) -> T {
        let clock = Instant::now();
        let expected = Duration::try_from_secs_f64(self.needed(estimate)).ok();
        locked(&self.shared.activity).timed = expected.map(|time| (clock, time));
        let done = work();
        locked(&self.shared.activity).timed = None;
        if estimate >= TELLING_SECONDS {
            self.learn(clock.elapsed().as_secs_f64() / estimate);
        }
        done
    }

    /// Reports that part `number`, from 1, of `of` parts begins.
    pub fn part(&self, name: &'static str, number: usize, of: usize) {
        self.tell(Activity { part: Some(Part { name, number, of }), ..Activity::default() });
    }

    /// Reports that a step of the work begins, with its iteration from 1, or 0 if it has none.
    pub fn step(&self, step: &'static str, iteration: usize) {
        let part = self.activity().part;
        self.tell(Activity { part, step, iteration, timed: None });
    }

    fn tell(&self, activity: Activity) {
        *locked(&self.shared.activity) = activity;
        // The lock is free again: the observer may ask for the activity.
        if let Observer(Some(observer)) = &self.shared.observer {
            observer(self);
        }
    }
}

#[derive(Clone, Debug)]
struct Deadline {
    at: Instant,
    /// Time from setting the deadline to the deadline.
    span: Duration,
    /// The first work that it cut short or left out.
    cut: Arc<OnceLock<Cut>>,
}

#[derive(Clone, Debug)]
struct Cut {
    activity: Activity,
    /// Seconds that work needed which did not begin, and seconds that were left.
    refused: Option<[f64; 2]>,
}

impl Deadline {
    /// The deadline `seconds` from now; `None` if no clock can represent it.
    fn within(seconds: f64) -> Option<Self> {
        let span = Duration::try_from_secs_f64(seconds).ok()?;
        Some(Deadline { at: Instant::now().checked_add(span)?, span, cut: Arc::default() })
    }

    fn or_sooner(&self, other: Deadline) -> Self {
        if other.at < self.at { other } else { self.clone() }
    }

    /// This deadline, sooner by `seconds`; what it cuts short, this deadline cut short.
    fn sooner(&self, seconds: f64) -> Self {
        let left = self.left();
        let sooner = Self::within(left - seconds.min(left)).map(|sooner| self.or_sooner(sooner));
        Deadline { cut: self.cut.clone(), ..sooner.unwrap_or_else(|| self.clone()) }
    }

    fn left(&self) -> f64 {
        self.at.saturating_duration_since(Instant::now()).as_secs_f64()
    }
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let activity = self.activity.to_string();
        let step = if activity.is_empty() { String::new() } else { format!(" the step `{activity}`") };
        match self.refused {
            Some([needed, left]) => {
                let after = if step.is_empty() { "" } else { " after" };
                let words = "the next step takes about";
                write!(f, "the time does not suffice{after}{step}: {words} {needed:.1e} s, and {left:.1e} s are left")
            }
            None if step.is_empty() => write!(f, "the time ended before the first step"),
            None => write!(f, "the time ended in{step}"),
        }
    }
}
