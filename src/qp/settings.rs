//! What a solve may be told.

use std::time::Duration;

use crate::error::Error;
use crate::qp::method::penalty::BEST_PENALTY;
use crate::solution::Goal;
use crate::watch::Watch;

/// The best penalty leaves a relative penetration of one over itself; parts of the body that are softer than the dofs of a row
/// make it so many times larger.
const PENETRATION: f64 = 100.0;

/// The method that finds the contact set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The program chooses, by rules fitted to measured times; MPRGP where the factor of a body in space would cost much more,
    /// or does not fit into [`Settings::memory`].
    #[default]
    Auto,
    /// Convex QP by Clarabel, its contact set settled by the active-set loop.
    Qp,
    /// Active-set loop with Lagrange multipliers, from C = 0.
    ActiveSet,
    /// Penalty loop with a growing penalty.
    Penalty,
    /// Projected conjugate gradients with a multigrid hierarchy: no factorisation of the body.
    Mprgp,
}

impl Method {
    /// The name in reports: `qp`, `active-set`, `penalty` or `mprgp`; what chooses among them is `auto`.
    pub fn name(self) -> &'static str {
        match self {
            Method::Auto => "auto",
            Method::Qp => "qp",
            Method::ActiveSet => "active-set",
            Method::Penalty => "penalty",
            Method::Mprgp => "mprgp",
        }
    }
}

/// Is the problem condensed onto the dofs of its contact rows?
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condense {
    /// Where an estimate of work and memory says that it pays; where that loses digits, all dofs are tried next.
    #[default]
    Auto,
    /// Never: the methods work on all dofs.
    Never,
}

/// Precision of the sparse factor; everything else is in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Precision {
    /// Double, unless [`Method::Auto`] is told an accuracy that the other reaches in less time.
    #[default]
    Auto,
    /// Double precision.
    Double,
    /// Single precision with half the memory, the answer refined in double precision; where the problem is not condensed,
    /// or too ill-conditioned, the factor is in double precision after all.
    Mixed,
}

/// Settings of a solve; start from [`Settings::default`] or [`Settings::with_method`] and change what differs.
///
/// ```
/// use signorini::{Method, Settings};
///
/// let settings = Settings::with_method(Method::ActiveSet).with_tolerance(1e-12).with_proof();
/// assert_eq!(settings.tolerance, 1e-12);
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// Is the problem condensed onto its contact dofs?
    pub condense: Condense,
    /// Threads of the sparse factorisations and of multigrid, at least 1.
    pub threads: usize,
    /// Precision of the sparse factor.
    pub precision: Precision,
    /// Tolerance of the certificate, relative: what `Ok` promises.
    pub tolerance: f64,
    /// Relative error in the energy norm that is good enough: where a bound is known, `Ok` promises that it is below, and
    /// nothing else.
    pub accuracy: Option<f64>,
    /// Are the rows named whose contact is beyond doubt?
    pub prove: bool,
    /// Wall-clock seconds after which the best answer so far is returned, as [`Error::NotCertified`] if it falls short;
    /// a factorisation that is under way is ended first, and the bound of the certificate may take a tenth of the time more:
    /// what it has not found then is a weaker bound, or none.
    pub time: Option<f64>,
    /// Bytes that a solve may take: [`Method::Auto`] takes no way whose estimate is above, and what would take more on the way
    /// that was named, by an estimate made before anything is factorised, is refused.
    pub memory: Option<f64>,
    /// Asked from any thread, the solve ends as if its time were over, or with [`Error::Interrupted`] where it has found
    /// nothing yet; it tells what is being done. Clones of the settings share it.
    pub watch: Watch,
    /// Is the contact set of the QP settled by the active-set loop?
    pub polish: bool,
    /// Tolerance of the interior-point method, on data of order one.
    pub interior_point_tolerance: f64,
    /// Most iterations of a loop; the cycles of MPRGP.
    pub max_iterations: usize,
    /// First penalty, in multiples of the local stiffness.
    pub first_penalty: f64,
    /// Last penalty, in multiples of the local stiffness; 1e8 balances penetration and rounding.
    pub last_penalty: f64,
    /// Is the penalty answer extrapolated to an infinite penalty, from two rungs of the ladder?
    pub extrapolate: bool,
    /// Penetration at which the penalty loop stops, relative to the largest displacement of a contact row.
    pub penetration_threshold: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::Auto,
            condense: Condense::Auto,
            threads: 1,
            precision: Precision::Auto,
            tolerance: 1e-9,
            accuracy: None,
            prove: false,
            time: None,
            memory: None,
            watch: Watch::default(),
            polish: true,
            interior_point_tolerance: 1e-9,
            max_iterations: 20_000,
            first_penalty: 1.0,
            last_penalty: 1e8,
            extrapolate: false,
            penetration_threshold: 1e-10,
        }
    }
}

impl Settings {
    /// The defaults with another method.
    pub fn with_method(method: Method) -> Self {
        Settings { method, ..Settings::default() }
    }

    /// The program chooses how; `Ok` promises a relative error in the energy norm of at most `accuracy`.
    pub fn for_accuracy(accuracy: f64) -> Self {
        Settings { accuracy: Some(accuracy), ..Settings::default() }
    }

    /// The program chooses how; the best answer that so many seconds allow.
    pub fn within(seconds: f64) -> Self {
        Settings { time: Some(seconds), ..Settings::default() }
    }

    /// The same with a tolerance of the certificate, relative.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Settings { tolerance, ..self }
    }

    /// The same with an accuracy in energy that is good enough, relative.
    pub fn with_accuracy(self, accuracy: f64) -> Self {
        Settings { accuracy: Some(accuracy), ..self }
    }

    /// The same with a limit of wall-clock time.
    pub fn with_time(self, time: Duration) -> Self {
        Settings { time: Some(time.as_secs_f64()), ..self }
    }

    /// The same with a limit of memory, in bytes.
    pub fn with_memory(self, bytes: f64) -> Self {
        Settings { memory: Some(bytes), ..self }
    }

    /// The same with a number of threads.
    pub fn with_threads(self, threads: usize) -> Self {
        Settings { threads, ..self }
    }

    /// The same with a precision of the factor.
    pub fn with_precision(self, precision: Precision) -> Self {
        Settings { precision, ..self }
    }

    /// The same with a rule for condensation.
    pub fn with_condensation(self, condense: Condense) -> Self {
        Settings { condense, ..self }
    }

    /// The same with the rows named that are proven open or closed.
    pub fn with_proof(self) -> Self {
        Settings { prove: true, ..self }
    }

    /// The same under a watch that can stop it and tells what is being done.
    pub fn watched(self, watch: &Watch) -> Self {
        Settings { watch: watch.clone(), ..self }
    }

    /// The same with the seconds counted from now, as the deadline of the watch.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first setting that is not in its range.
    pub(crate) fn started(&self) -> Result<Self, Error> {
        self.check()?;
        let watch = self.time.map_or_else(|| self.watch.clone(), |time| self.watch.within(time));
        Ok(Settings { time: None, watch, ..self.clone() })
    }

    /// What an answer is held against.
    pub fn goal(&self) -> Goal {
        Goal { tolerance: self.tolerance, accuracy: self.accuracy }
    }

    /// Is the answer that is wanted as good as can be? An unpolished QP and a penalty are asked for as they are.
    pub(super) fn wants_best(&self) -> bool {
        match self.method {
            Method::Qp => self.polish,
            Method::Penalty => false,
            Method::Auto | Method::ActiveSet | Method::Mprgp => true,
        }
    }

    /// May the last resort replace an answer that misses the goal, in its worst condition, by `value`? Not that of an
    /// unpolished QP or of a penalty that ends below its best value, which are asked for as they are, nor the penetration
    /// that the best penalty leaves.
    pub(super) fn allows_last_resort(&self, value: f64) -> bool {
        let is_best_penalty = self.method == Method::Penalty && self.last_penalty >= BEST_PENALTY;
        self.wants_best() || (is_best_penalty && value > PENETRATION / BEST_PENALTY)
    }

    /// Are all settings in their ranges?
    ///
    /// # Errors
    /// [`Error::Setting`] for the first that is not.
    fn check(&self) -> Result<(), Error> {
        let positive = |name, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(()),
            false => Err(Error::Setting { name, value, allowed: "positive and finite" }),
        };
        positive("tolerance", self.tolerance)?;
        if let Some(accuracy) = self.accuracy {
            positive("accuracy", accuracy)?;
        }
        if let Some(time) = self.time.filter(|time| time.is_nan() || *time < 0.0) {
            return Err(Error::Setting { name: "time", value: time, allowed: "zero or positive" });
        }
        if let Some(memory) = self.memory.filter(|memory| memory.is_nan() || *memory <= 0.0) {
            return Err(Error::Setting { name: "memory", value: memory, allowed: "positive" });
        }
        positive("interior_point_tolerance", self.interior_point_tolerance)?;
        positive("first_penalty", self.first_penalty)?;
        positive("last_penalty", self.last_penalty)?;
        if self.first_penalty > self.last_penalty {
            let value = self.first_penalty;
            return Err(Error::Setting { name: "first_penalty", value, allowed: "at most last_penalty" });
        }
        if self.penetration_threshold.is_nan() || self.penetration_threshold < 0.0 {
            let value = self.penetration_threshold;
            return Err(Error::Setting { name: "penetration_threshold", value, allowed: "zero or positive" });
        }
        if self.threads == 0 {
            return Err(Error::Setting { name: "threads", value: 0.0, allowed: "at least 1" });
        }
        if self.max_iterations == 0 {
            return Err(Error::Setting { name: "max_iterations", value: 0.0, allowed: "at least 1" });
        }
        Ok(())
    }
}
