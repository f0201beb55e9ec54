//! State shared by a solve and its caller: a request to stop, a deadline, the current step.

mod activity;
mod cancellation;
mod deadline;
mod pace;

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

pub use activity::{Activity, Part};
use cancellation::Cancellation;
use deadline::{Deadline, Refused};
use pace::Pace;

/// A handle on running work: any thread can ask it to stop and read its current step.
///
/// Clones share the request, the activity and the observer; each clone has its own deadline. A solve checks the watch
/// between factorisations, iterations and steps, and ends with the best answer so far.
///
/// ```
/// use signorini_qp::{ContactProblem, Error, Settings, SparseMatrix, SymmetricMatrix, Watch, solve};
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
    deadline: Option<Deadline>,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    cancellation: Cancellation,
    activity: Mutex<Activity>,
    pace: Mutex<Pace>,
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
pub(crate) fn locked<T>(data: &Mutex<T>) -> MutexGuard<'_, T> {
    data.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Watch {
    /// A watch that calls `observer` whenever a part, a step or an iteration begins: on the thread that does the work,
    /// and before the work is done. [`Watch::activity`] is then the one that begins.
    ///
    /// ```
    /// use signorini_qp::{Error, Settings, Watch, solve};
    /// # use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix};
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
        self.shared.cancellation.request();
    }

    /// Returns `true` if the work was asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.shared.cancellation.is_requested()
    }

    /// Returns `true` if the work was asked to stop, and takes down that the work has [noticed](Self::is_noticed) it:
    /// work asks this where it can end, and then ends.
    pub fn acknowledge(&self) -> bool {
        let stopped = self.is_stopped();
        if stopped {
            self.shared.cancellation.acknowledge();
        }
        stopped
    }

    /// Returns `true` if the work has noticed the request to stop. A factorisation, for example, does not notice it.
    pub fn is_noticed(&self) -> bool {
        self.shared.cancellation.is_acknowledged()
    }

    /// Returns `true` if the work must end: it was asked to stop, or its deadline has passed. Work asks this where it
    /// can end, and then ends: the watch takes down that the work has [noticed](Self::is_noticed) the request, or what
    /// the deadline cut short.
    pub fn is_over(&self) -> bool {
        let passed = self.deadline.as_ref().filter(|deadline| deadline.left() == 0.0);
        if let Some(deadline) = passed {
            deadline.note(self.activity(), None);
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
        Watch { deadline: self.deadline.as_ref().and_then(Deadline::finishing), ..self.clone() }
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
            deadline.note(self.activity(), Some(Refused { needed, left }));
        }
        needed < left
    }

    /// The first work that the deadline cut short or left out, in words; `None` if nothing.
    pub fn cut(&self) -> Option<String> {
        self.deadline.as_ref().and_then(Deadline::cut)
    }

    /// Seconds that work needs on this machine: `estimate` times the pace of the work that was [timed](Self::timed)
    /// last.
    pub fn needed(&self, estimate: f64) -> f64 {
        locked(&self.shared.pace).seconds(estimate)
    }

    /// Sets the pace: from now on work is expected to take `pace` times its estimate.
    pub fn learn(&self, pace: f64) {
        *locked(&self.shared.pace) = Pace(Some(pace));
    }

    /// Measured seconds per estimated second; `None` before anything was timed.
    pub fn pace(&self) -> Option<f64> {
        locked(&self.shared.pace).0
    }

    /// Runs `work`, which is estimated to take `estimate` seconds, and measures the pace of this machine by it.
    pub fn timed<T>(&self, estimate: f64, work: impl FnOnce() -> T) -> T {
        let clock = Instant::now();
        let expected = Duration::try_from_secs_f64(self.needed(estimate)).ok();
        locked(&self.shared.activity).timed = expected.map(|time| (clock, time));
        let done = work();
        locked(&self.shared.activity).timed = None;
        let mut pace = locked(&self.shared.pace);
        *pace = pace.after(estimate, clock.elapsed().as_secs_f64());
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
