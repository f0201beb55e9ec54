//! What the one who waits shares with the work: a request to end, a deadline, and what is being done.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Work that may be asked to end, from any thread, and asked what it is doing.
///
/// Clones share the request, the activity and the observer; only the deadline is each one's own. A solve looks between
/// factorisations, iterations and steps, and ends with the best answer that it has.
///
/// ```
/// use signorini::{Error, Settings, solve};
/// # use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};
/// # let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?)?;
/// # let contact = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?;
/// # let problem = ContactProblem::new(stiffness, vec![3.0], contact, vec![1.0])?;
///
/// let settings = Settings::default();
/// let watch = settings.watch.clone();
/// std::thread::spawn(move || watch.stop()).join().unwrap();
/// assert!(matches!(solve(&problem, &settings), Err(Error::Interrupted)));
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Watch {
    deadline: Option<Instant>,
    /// The time that there was when the deadline was set.
    span: Duration,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    stopped: AtomicBool,
    noticed: AtomicBool,
    activity: Mutex<Activity>,
    pace: Mutex<Option<f64>>,
    observer: Observer,
}

type Call = dyn Fn(&Watch) + Send + Sync;

/// What is called whenever something begins.
#[derive(Default)]
struct Observer(Option<Box<Call>>);

impl fmt::Debug for Observer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Observer" } else { "no observer" })
    }
}

/// What makes an answer of what was found may take this share of the time beyond the deadline.
const FINISHING: f64 = 0.1;

/// Work that takes less tells nothing of the pace.
const TELLING_SECONDS: f64 = 1e-3;

/// What is being done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Activity {
    /// The part of the work, where there are several, as a gap of a sweep.
    pub part: Option<Part>,
    /// The step of it, as `factorisation`; empty before the first.
    pub step: &'static str,
    /// Which iteration of the step, from 1; 0 where it has none.
    pub iteration: usize,
}

/// One of several parts of a work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// What the parts are, as `gap`.
    pub name: &'static str,
    /// Which one, from 1.
    pub number: usize,
    /// How many there are.
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
    /// before it is done. [`Watch::activity`] is then what begins.
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

    /// Asks the work to end with what it has.
    pub fn stop(&self) {
        self.shared.stopped.store(true, Ordering::SeqCst);
    }

    /// Was the work asked to end? It is the work that asks this, and then ends.
    pub fn is_stopped(&self) -> bool {
        let stopped = self.shared.stopped.load(Ordering::SeqCst);
        if stopped {
            self.shared.noticed.store(true, Ordering::SeqCst);
        }
        stopped
    }

    /// Has the work noticed that it was asked to end? While it factorises, for one, it does not.
    pub fn is_noticed(&self) -> bool {
        self.shared.noticed.load(Ordering::SeqCst)
    }

    /// What is being done now.
    pub fn activity(&self) -> Activity {
        self.shared.activity.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The same, with a deadline so many `seconds` from now unless its own is sooner.
    pub fn within(&self, seconds: f64) -> Watch {
        let time = Duration::try_from_secs_f64(seconds).ok();
        let deadline = time.and_then(|time| Some((Instant::now().checked_add(time)?, time)));
        match deadline {
            Some((deadline, span)) if self.deadline.is_none_or(|own| deadline < own) => {
                Watch { deadline: Some(deadline), span, shared: self.shared.clone() }
            }
            _ => self.clone(),
        }
    }

    /// The same, without a deadline.
    pub fn unhurried(&self) -> Watch {
        Watch { deadline: None, span: Duration::ZERO, shared: self.shared.clone() }
    }

    /// The same for what makes an answer of what was found, as its certificate: it may take a little of the time more.
    pub(crate) fn finishing(&self) -> Watch {
        let deadline = self.deadline.and_then(|deadline| deadline.checked_add(self.span.mul_f64(FINISHING)));
        Watch { deadline, ..self.clone() }
    }

    /// Seconds until the deadline, if there is one.
    pub fn time_left(&self) -> Option<f64> {
        self.deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()).as_secs_f64())
    }

    /// Seconds that work takes here which is estimated to take so many: at the pace of what was [timed](Self::timed) last.
    pub fn needed(&self, estimate: f64) -> f64 {
        estimate * self.pace().unwrap_or(1.0)
    }

    /// Is there time left for work that is estimated to take so many seconds?
    pub fn allows(&self, estimate: f64) -> bool {
        self.time_left().is_none_or(|left| self.needed(estimate) < left)
    }

    /// The same, with the deadline sooner by what is estimated to take so many seconds: whoever asks between two steps that
    /// take as long is told that it is over while there still is time for none of them.
    pub fn keeping(&self, estimate: f64) -> Watch {
        match self.time_left() {
            Some(left) => self.within(left - self.needed(estimate).min(left)),
            None => self.clone(),
        }
    }

    /// Does work that is estimated to take so many seconds, and learns the pace of this machine from it.
    pub fn timed<T>(&self, estimate: f64, work: impl FnOnce() -> T) -> T {
        let clock = Instant::now();
        let done = work();
        if estimate >= TELLING_SECONDS {
            self.learn(clock.elapsed().as_secs_f64() / estimate);
        }
        done
    }

    /// Takes work to last so many times as long as it is estimated to.
    pub fn learn(&self, pace: f64) {
        *self.shared.pace.lock().unwrap_or_else(PoisonError::into_inner) = Some(pace);
    }

    /// Seconds that work takes for each that is estimated; none before anything was timed.
    pub(crate) fn pace(&self) -> Option<f64> {
        *self.shared.pace.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Must the work end, because it was asked to or because its deadline has passed?
    pub fn is_over(&self) -> bool {
        self.is_stopped() || self.time_left() == Some(0.0)
    }

    /// Tells which part of the work begins, from 1, `of` how many.
    pub fn part(&self, name: &'static str, number: usize, of: usize) {
        self.tell(Activity { part: Some(Part { name, number, of }), ..Activity::default() });
    }

    /// Tells which step of the work begins, and its iteration from 1, or 0 where it has none.
    pub fn step(&self, step: &'static str, iteration: usize) {
        let part = self.activity().part;
        self.tell(Activity { part, step, iteration });
    }

    fn tell(&self, activity: Activity) {
        *self.shared.activity.lock().unwrap_or_else(PoisonError::into_inner) = activity;
        // The lock is free again: the observer may ask for the activity.
        if let Observer(Some(observer)) = &self.shared.observer {
            observer(self);
        }
    }
}
