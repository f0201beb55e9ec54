//! State shared by a solve and its caller: a request to stop, a deadline, the current step.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// A handle on running work: any thread can ask it to stop and read its current step.
///
/// Clones share the request, the activity and the observer; each clone has its own deadline. A solve checks the watch between
/// factorisations, iterations and steps, and ends with the best answer so far.
///
/// ```
/// use signorini::{ContactProblem, Error, Settings, SparseMatrix, SymmetricMatrix, Watch, solve};
///
/// // A spring of stiffness 1, pushed with force 3 against a wall at distance 1.
/// let one = || SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]);
/// let problem = ContactProblem::new(SymmetricMatrix::from_lower(one()?)?, vec![3.0], one()?, vec![1.0])?;
///
/// let settings = Settings::default();
/// let watch = settings.watch.clone();
/// std::thread::spawn(move || watch.stop()).join().unwrap();
/// assert!(matches!(solve(&problem, &settings), Err(Error::Interrupted)));
/// // Under a new watch the same settings solve it: the wall takes 3 - 1 x 1.
/// assert_eq!(solve(&problem, &settings.watched(&Watch::default()))?.multiplier, [-2.0]);
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Watch {
    deadline: Option<Instant>,
    /// Time from setting the deadline to the deadline.
    span: Duration,
    /// What the deadline cut short first; a sooner deadline has its own.
    cut: Arc<OnceLock<Cut>>,
    shared: Arc<Shared>,
}

/// Work that a deadline cut short or left out.
#[derive(Clone, Debug)]
struct Cut {
    activity: Activity,
    /// Seconds that the work needed, and seconds that were left, if it did not begin.
    refused: Option<[f64; 2]>,
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

#[derive(Debug, Default)]
struct Shared {
    stopped: AtomicBool,
    noticed: AtomicBool,
    activity: Mutex<Activity>,
    pace: Mutex<Option<f64>>,
    #[cfg(feature = "cli")]
    kept: Mutex<Option<String>>,
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

/// Finishing an answer, for example its certificate, may take this share of the time beyond the deadline.
const FINISHING: f64 = 0.1;

/// Work shorter than this is too short to measure the pace.
const TELLING_SECONDS: f64 = 1e-3;

/// The current part, step and iteration.
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

/// One of several parts of the work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the parts, such as `gap`.
    pub name: &'static str,
    /// Number of this part, from 1.
    pub number: usize,
    /// Number of parts.
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

impl Watch {
    /// A watch that calls `observer` whenever a part, a step or an iteration begins: on the thread that does the work, and
    /// before the work is done. [`Watch::activity`] is then the one that begins.
    ///
    /// ```
    /// use signorini::{Error, Settings, Watch, solve};
    /// # use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};
    /// # let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?)?;
    /// # let contact = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?;
    /// # let problem = ContactProblem::new(stiffness, vec![3.0], contact, vec![1.0])?;
    ///
    /// let mut settings = Settings::default();
    /// settings.watch = Watch::observed(|watch| {
    ///     if watch.activity().step == "ordering" {
    ///         watch.stop();
    ///     }
    /// });
    /// assert!(matches!(solve(&problem, &settings), Err(Error::Interrupted)));
    /// # Ok::<(), Error>(())
    /// ```
    pub fn observed(observer: impl Fn(&Watch) + Send + Sync + 'static) -> Watch {
        let observer = Observer(Some(Box::new(observer)));
        Watch { shared: Arc::new(Shared { observer, ..Shared::default() }), ..Watch::default() }
    }

    /// Asks the work to end with its best answer so far.
    pub fn stop(&self) {
        self.shared.stopped.store(true, Ordering::SeqCst);
    }

    /// Returns `true` if the work was asked to stop. The work itself calls this, and then ends.
    pub fn is_stopped(&self) -> bool {
        let stopped = self.shared.stopped.load(Ordering::SeqCst);
        if stopped {
            self.shared.noticed.store(true, Ordering::SeqCst);
        }
        stopped
    }

    /// Returns `true` if the work has noticed the request to stop. A factorisation, for example, does not notice it.
    pub fn is_noticed(&self) -> bool {
        self.shared.noticed.load(Ordering::SeqCst)
    }

    /// Keeps the report of the best answer so far, for a program that ends before the work notices.
    #[cfg(feature = "cli")]
    pub(crate) fn keep(&self, report: String) {
        *self.shared.kept.lock().unwrap_or_else(PoisonError::into_inner) = Some(report);
    }

    /// Calls `last` with the kept report, and forgets it. Any other caller waits until `last` returns.
    #[cfg(feature = "cli")]
    pub(crate) fn with_kept<T>(&self, last: impl FnOnce(Option<String>) -> T) -> T {
        let mut kept = self.shared.kept.lock().unwrap_or_else(PoisonError::into_inner);
        last(kept.take())
    }

    /// The part, step and iteration that run at present.
    pub fn activity(&self) -> Activity {
        self.shared.activity.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The same watch with a deadline `seconds` from now, or with its own deadline if that is sooner.
    pub fn within(&self, seconds: f64) -> Watch {
        let time = Duration::try_from_secs_f64(seconds).ok();
        let deadline = time.and_then(|time| Some((Instant::now().checked_add(time)?, time)));
        match deadline {
            Some((deadline, span)) if self.deadline.is_none_or(|own| deadline < own) => {
                Watch { deadline: Some(deadline), span, cut: Arc::default(), shared: self.shared.clone() }
            }
            _ => self.clone(),
        }
    }

    /// The same watch without a deadline.
    pub fn unhurried(&self) -> Watch {
        Watch { deadline: None, span: Duration::ZERO, cut: Arc::default(), shared: self.shared.clone() }
    }

    /// The same watch for finishing an answer, for example its certificate: its deadline is later by a share of the time.
    pub(crate) fn finishing(&self) -> Watch {
        let deadline = self.deadline.and_then(|deadline| deadline.checked_add(self.span.mul_f64(FINISHING)));
        Watch { deadline, ..self.clone() }
    }

    /// Seconds until the deadline, if there is one.
    pub fn time_left(&self) -> Option<f64> {
        self.deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()).as_secs_f64())
    }

    /// Seconds that work needs on this machine: `estimate` times the pace of the work that was [timed](Self::timed) last.
    pub fn needed(&self, estimate: f64) -> f64 {
        estimate * self.pace().unwrap_or(1.0)
    }

    /// Returns `true` if there is time left for work that is estimated to take `estimate` seconds.
    pub fn allows(&self, estimate: f64) -> bool {
        let (left, needed) = (self.time_left(), self.needed(estimate));
        let short = left.filter(|&left| needed >= left);
        if let Some(left) = short {
            self.note_cut(Some([needed, left]));
        }
        short.is_none()
    }

    /// What the deadline cut short or left out first, in words; `None` if nothing.
    pub(crate) fn cut(&self) -> Option<String> {
        self.cut.get().map(Cut::to_string)
    }

    fn note_cut(&self, refused: Option<[f64; 2]>) {
        self.cut.get_or_init(|| Cut { activity: self.activity(), refused });
    }

    /// The same watch with the deadline sooner by the time that work of `estimate` seconds needs. A loop with steps of that
    /// length then ends before a step that would not finish in time.
    pub fn keeping(&self, estimate: f64) -> Watch {
        match self.time_left() {
            Some(left) => Watch { cut: self.cut.clone(), ..self.within(left - self.needed(estimate).min(left)) },
            None => self.clone(),
        }
    }

    /// Runs `work`, which is estimated to take `estimate` seconds, and measures the pace of this machine by it.
    pub fn timed<T>(&self, estimate: f64, work: impl FnOnce() -> T) -> T {
        let clock = Instant::now();
        self.expect(Duration::try_from_secs_f64(self.needed(estimate)).ok().map(|time| (clock, time)));
        let done = work();
        self.expect(None);
        if estimate >= TELLING_SECONDS {
            self.learn(clock.elapsed().as_secs_f64() / estimate);
        }
        done
    }

    fn expect(&self, timed: Option<(Instant, Duration)>) {
        self.shared.activity.lock().unwrap_or_else(PoisonError::into_inner).timed = timed;
    }

    /// Sets the pace: from now on work is expected to take `pace` times its estimate.
    pub fn learn(&self, pace: f64) {
        *self.shared.pace.lock().unwrap_or_else(PoisonError::into_inner) = Some(pace);
    }

    /// Measured seconds per estimated second; `None` before anything was timed.
    pub(crate) fn pace(&self) -> Option<f64> {
        *self.shared.pace.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns `true` if the work must end: it was asked to stop, or its deadline has passed.
    pub fn is_over(&self) -> bool {
        let is_late = self.time_left() == Some(0.0);
        if is_late {
            self.note_cut(None);
        }
        self.is_stopped() || is_late
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
        *self.shared.activity.lock().unwrap_or_else(PoisonError::into_inner) = activity;
        // The lock is free again: the observer may ask for the activity.
        if let Observer(Some(observer)) = &self.shared.observer {
            observer(self);
        }
    }
}
