//! The settings of a solve.

use std::time::Duration;

use crate::error::{Error, LinearError, Result};
use crate::linear::memory;
use crate::linear::watch::Watch;
use crate::method::interior_point::InteriorPoint;
use crate::method::penalty::{BEST_PENALTY, Penalty};
use crate::solution::Goal;

/// Factor by which soft parts may enlarge the relative penetration of the best penalty, one over that penalty.
const PENETRATION: f64 = 100.0;

/// The method that finds the contact set, with its own options; every method ends with the same certificate.
///
/// ```
/// use signorini_qp::{Method, Penalty};
///
/// assert_eq!(Method::penalty(), Method::Penalty(Penalty::default()));
/// assert_eq!(Method::qp().name(), "qp");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// The program chooses by costs: the active set with a factor, or MPRGP if the factor of a body in space would cost
    /// much more, or does not fit into [`Settings::memory`].
    #[default]
    Auto,
    /// Convex QP by Clarabel; the active-set loop settles its contact set unless [`InteriorPoint::polish`] is `false`.
    Qp(InteriorPoint),
    /// Active-set loop with Lagrange multipliers, from C = 0.
    ActiveSet,
    /// Penalty loop with a growing penalty.
    Penalty(Penalty),
    /// Projected conjugate gradients with a multigrid hierarchy: no factorisation of the body.
    Mprgp,
}

impl Method {
    /// [`Method::Qp`] with its default options: polished, to 1e-9.
    pub const fn qp() -> Self {
        Method::Qp(InteriorPoint::DEFAULT)
    }

    /// [`Method::Penalty`] with its default ladder, from 1 to 1e8.
    pub const fn penalty() -> Self {
        Method::Penalty(Penalty::DEFAULT)
    }

    /// The name in reports: `qp`, `active-set`, `penalty` or `mprgp`; `auto` for the choice among them.
    pub fn name(self) -> &'static str {
        match self {
            Method::Auto => "auto",
            Method::Qp(_) => "qp",
            Method::ActiveSet => "active-set",
            Method::Penalty(_) => "penalty",
            Method::Mprgp => "mprgp",
        }
    }

    /// Returns `true` if the best possible answer is wanted. An unpolished QP and a penalty are returned as they are.
    pub(super) fn wants_best(self) -> bool {
        match self {
            Method::Qp(InteriorPoint { polish, .. }) => polish,
            Method::Penalty(_) => false,
            Method::Auto | Method::ActiveSet | Method::Mprgp => true,
        }
    }

    /// Returns `true` if the last resort may replace an answer that misses the goal, in its worst condition, by
    /// `value`. Answers of an unpolished QP and of a lower penalty are kept, and so is the penetration of the best
    /// penalty.
    pub(super) fn allows_last_resort(self, value: f64) -> bool {
        let is_best_penalty = matches!(self, Method::Penalty(ladder) if ladder.last >= BEST_PENALTY);
        self.wants_best() || (is_best_penalty && value > PENETRATION / BEST_PENALTY)
    }

    fn check(self) -> Result<()> {
        match self {
            Method::Qp(InteriorPoint { tolerance, .. }) => positive("tolerance of the interior point", tolerance),
            Method::Penalty(Penalty { first, last, penetration_threshold, .. }) => {
                positive("first penalty", first)?;
                positive("last penalty", last)?;
                in_range("first penalty", first, first <= last, "at most the last")?;
                let (name, value) = ("penetration threshold", penetration_threshold);
                in_range(name, value, value >= 0.0, "zero or positive")
            }
            Method::Auto | Method::ActiveSet | Method::Mprgp => Ok(()),
        }
    }
}

/// The rule for condensing the problem onto the dofs of its contact rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condense {
    /// If an estimate of work and memory shows that it pays; if that loses digits, all dofs are tried next.
    #[default]
    Auto,
    /// Never: the methods work on all dofs.
    Never,
}

/// The tolerance that every finite error meets.
const ANY_FINITE: f64 = f64::MAX;

/// Settings of a solve; start from [`Settings::default`] or [`Settings::with_method`] and change what differs.
///
/// ```
/// use signorini_qp::{ContactProblem, Method, Settings, SparseMatrix, SymmetricMatrix, solve};
///
/// // A spring of stiffness 2, pushed with force 3 against a wall at distance 1, which takes 3 - 2 x 1.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let problem = ContactProblem::new(SymmetricMatrix::of_diagonal(vec![2.0]), vec![3.0], one(1.0)?, vec![1.0])?;
///
/// // Two threads for the factorisation; the answer is the same, bit by bit, as with one.
/// let settings = Settings::with_method(Method::ActiveSet).with_tolerance(1e-12).with_threads(2).with_proof();
/// let solution = solve(&problem, &settings)?;
/// assert_eq!(solution.multiplier, [-1.0]);
/// assert_eq!(solve(&problem, &settings.with_threads(1))?.multiplier, solution.multiplier);
/// // The one row is proven closed, because its force of 1 exceeds its error bound.
/// assert!(solution.proven.is_some_and(|proven| proven.closed.contains(0)));
/// # Ok::<(), signorini_qp::Error>(())
/// ```
///
/// A setting changes what `Ok` promises, or how the answer is found:
///
/// ```
/// use signorini_qp::{ContactProblem, Error, Method, Penalty, Settings, SparseMatrix, SymmetricMatrix, solve};
///
/// // A spring of stiffness 1, pushed with force 2 against a wall at distance 0.5.
/// let one = || SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]);
/// let problem = ContactProblem::new(SymmetricMatrix::from_lower(one()?)?, vec![2.0], one()?, vec![0.5])?;
/// // A penalty as stiff as the spring lets it go to (2 + 0.5) / 2, which is no answer to 1e-9.
/// let soft = Method::Penalty(Penalty { last: 1.0, ..Penalty::default() });
/// let Err(Error::NotCertified { solution, .. }) = solve(&problem, &Settings::with_method(soft)) else { panic!() };
/// assert!((solution.displacement[0] - 1.25).abs() < 1e-15);
/// // The exact displacement is 0.5. Certified to 1, which asks for nearly nothing, the soft answer passes.
/// let loose = Settings::with_method(soft).with_tolerance(1.0);
/// assert!((solve(&problem, &loose)?.displacement[0] - 1.25).abs() < 1e-15);
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Settings {
    /// The method that finds the contact set; the program chooses it by default.
    pub method: Method,
    /// The rule for condensing the problem onto its contact dofs.
    pub condense: Condense,
    /// Threads of the sparse factorisations and of multigrid, at least 1. With `None` a factorisation has one, and
    /// multigrid on 50,000 dofs or more those of the machine, 8 at most, which many problems share as well. They change
    /// no bit of an answer.
    pub threads: Option<usize>,
    /// Tolerance of the certificate, relative: what `Ok` promises. With `None` every finite error will do.
    pub tolerance: Option<f64>,
    /// Relative error in the energy norm that is good enough: if a bound is known, `Ok` promises that it is below, and
    /// nothing else.
    pub accuracy: Option<f64>,
    /// `true` to prove which rows are open and which are closed.
    pub prove: bool,
    /// Wall-clock time after which the best answer so far is returned, as [`Error::NotCertified`] if it falls short. A
    /// factorisation in progress is finished first, and the bound of the certificate may take a tenth of the time more;
    /// if it is cut short then, it is weaker or missing.
    pub time: Option<Duration>,
    /// Bytes that a solve may take. [`Method::Auto`] takes no way with an estimate above this. A named method is
    /// refused if it would take more, by an estimate made before anything is factorised.
    pub memory: Option<f64>,
    /// Any thread can stop the solve through it. The solve then ends as if its time were over, or with
    /// [`Error::Interrupted`] if it has found nothing yet; the watch also states the current activity. Clones of the
    /// settings share it.
    pub watch: Watch,
    /// Largest number of iterations of a loop, or of cycles of MPRGP.
    pub max_iterations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::Auto,
            condense: Condense::Auto,
            threads: None,
            tolerance: Some(1e-9),
            accuracy: None,
            prove: false,
            time: None,
            memory: None,
            watch: Watch::default(),
            max_iterations: 20_000,
        }
    }
}

impl Settings {
    /// The answer to those who ask for a factor in single precision, which was slower than one in double precision
    /// wherever it was measured.
    pub const NO_SINGLE_PRECISION: &str = "factors in single precision are gone: they were slower than in double precision; for less \
                                           memory take the method mprgp";

    /// The defaults with another method.
    pub fn with_method(method: Method) -> Self {
        Settings { method, ..Settings::default() }
    }

    /// The program chooses the method; `Ok` promises a relative error in the energy norm of at most `accuracy`.
    pub fn for_accuracy(accuracy: f64) -> Self {
        Settings { accuracy: Some(accuracy), ..Settings::default() }
    }

    /// The program chooses the method; the best answer that this time allows.
    pub fn within(time: Duration) -> Self {
        Settings { time: Some(time), ..Settings::default() }
    }

    /// The same with another method.
    pub fn by(self, method: Method) -> Self {
        Settings { method, ..self }
    }

    /// The same without a tolerance: `Ok` promises a finite answer, and nothing else.
    pub fn without_tolerance(self) -> Self {
        Settings { tolerance: None, ..self }
    }

    /// The same for a regular problem that a question about another one raises: by sets, without a proof.
    pub(crate) fn of_question(&self) -> Self {
        Settings { method: Method::ActiveSet, accuracy: None, prove: false, ..self.clone() }
    }

    /// The same with the method and the condensation that the program chooses.
    pub(crate) fn by_rules(self) -> Self {
        Settings { method: Method::Auto, condense: Condense::Auto, ..self }
    }

    /// The same with a tolerance of the certificate, relative.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Settings { tolerance: Some(tolerance), ..self }
    }

    /// The same with an accuracy in energy that is good enough, relative.
    pub fn with_accuracy(self, accuracy: f64) -> Self {
        Settings { accuracy: Some(accuracy), ..self }
    }

    /// The same with a limit of wall-clock time.
    pub fn with_time(self, time: Duration) -> Self {
        Settings { time: Some(time), ..self }
    }

    /// The same with a limit of memory, in bytes.
    pub fn with_memory(self, bytes: f64) -> Self {
        Settings { memory: Some(bytes), ..self }
    }

    /// The same with the available memory of the machine as the limit; no limit if the system does not state it.
    pub fn with_available_memory(self) -> Self {
        // What the process holds already belongs to its caller.
        let most = memory::available().min(memory::address_space_left() - memory::held());
        if most.is_finite() { self.with_memory(most.max(1.0)) } else { self }
    }

    /// The same with a limit of iterations of a loop, or of cycles of MPRGP.
    pub fn with_max_iterations(self, max_iterations: usize) -> Self {
        Settings { max_iterations, ..self }
    }

    /// The same with a number of threads.
    pub fn with_threads(self, threads: usize) -> Self {
        Settings { threads: Some(threads), ..self }
    }

    /// The same with a rule for condensation.
    pub fn with_condensation(self, condense: Condense) -> Self {
        Settings { condense, ..self }
    }

    /// The same with a proof of the rows that are open or closed.
    pub fn with_proof(self) -> Self {
        Settings { prove: true, ..self }
    }

    /// The same under a watch that can stop the solve and states its current activity.
    pub fn watched(self, watch: &Watch) -> Self {
        Settings { watch: watch.clone(), ..self }
    }

    /// The same with the active set if the method is left to the program: answers are those of a settled linear solve,
    /// and each step of a motion starts from the previous set.
    pub fn exactly(self) -> Self {
        let method = if self.method == Method::Auto { Method::ActiveSet } else { self.method };
        Settings { method, ..self }
    }

    /// The same with the time counted from now, as the deadline of the watch.
    ///
    /// # Errors
    /// [`LinearError::Setting`] for the first setting that is not in its range.
    pub fn started(&self) -> Result<Self, Error> {
        self.check()?;
        let watch = self.time.map_or_else(|| self.watch.clone(), |time| self.watch.within(time.as_secs_f64()));
        Ok(Settings { time: None, watch, ..self.clone() })
    }

    /// The goal that an answer must meet.
    pub fn goal(&self) -> Goal {
        Goal { tolerance: self.tolerance.unwrap_or(ANY_FINITE), accuracy: self.accuracy }
    }

    fn check(&self) -> Result<()> {
        for (name, value) in [("tolerance", self.tolerance), ("accuracy", self.accuracy)] {
            value.map_or(Ok(()), |value| positive(name, value))?;
        }
        let memory = self.memory.unwrap_or(f64::INFINITY);
        in_range("memory", memory, memory > 0.0, "positive")?;
        self.method.check()?;
        in_range("threads", 0.0, self.threads != Some(0), "at least 1")?;
        in_range("max_iterations", 0.0, self.max_iterations > 0, "at least 1")
    }
}

fn positive(name: &'static str, value: f64) -> Result<()> {
    in_range(name, value, value.is_finite() && value > 0.0, "positive and finite")
}

fn in_range(name: &'static str, value: f64, is_allowed: bool, allowed: &'static str) -> Result<()> {
    if is_allowed { Ok(()) } else { Err(LinearError::Setting { name, value, allowed }.into()) }
}
