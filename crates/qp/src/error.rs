//! The one error type: each error states what is wrong, where, which value, and what is allowed.

pub use crate::linear::Error as LinearError;
use crate::linear::FactorError;
use crate::linear::memory::in_words as memory;
use crate::solution::{Cancellation, Solution};

pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The step that fails at a dof without stiffness.
const HIERARCHY: &str = "multigrid hierarchy";

/// All errors between a file and a certified answer: faulty input, problems without an answer, and answers that were
/// not certified. Each has a [`code`](Self::code), and one sentence for a reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Faulty data, a file, or a step of a library: of the linear algebra below.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// Contact rows that no displacement satisfies together.
    #[error("infeasible: {reason}")]
    Infeasible {
        /// The rows and the length by which they overlap, in words.
        reason: String,
        /// Indices of the contact rows that contradict each other, from 0.
        rows: Vec<usize>,
        /// Farkas' weights, one for each of `rows`, dimensionless, `>= 0`, under which they cancel; empty if the rows
        /// would contradict each other only as equalities.
        weights: Vec<f64>,
        /// The length by which they overlap, in the problem's unit of length, for the largest weight 1.
        overlap: f64,
    },
    /// The load moves the body away without end.
    #[error("unbounded: the load drives a motion that neither supports nor obstacle stop: {mode}")]
    Unbounded {
        /// The rigid-body mode, or the direction in which the body escapes, in words.
        mode: String,
        /// The escape direction d, one entry per dof, without a unit and up to a positive factor: `K d = 0`,
        /// `B d <= 0`, `f'd > 0`.
        direction: Vec<f64>,
    },
    /// A mode without energy and without work of the load, which no row stops: the answer is not unique.
    #[error("a rigid-body motion is held by neither supports nor obstacle: {mode}")]
    UnderHeld {
        /// The rigid-body mode, or the direction that nothing holds, in words.
        mode: String,
        /// The free direction d, one entry per dof, without a unit and up to a factor of either sign.
        direction: Vec<f64>,
    },
    /// A step that cannot be interrupted, such as a factorisation, would take longer than the time that is left.
    #[error("the next step takes about {needed:.2} s, and {time:.2} s are left; allow more time")]
    OutOfTime {
        /// Seconds that the step takes, estimated.
        needed: f64,
        /// Seconds that are left.
        time: f64,
    },
    /// [`Watch::stop`](crate::Watch::stop) was called before anything was found.
    #[error("interrupted before there was an answer")]
    Interrupted,
    /// Whether there is an answer, and only one, could not be decided.
    #[error("it is not decided whether the problem has an answer: {reason}")]
    Undecided {
        /// The obstacle to a decision, in words, with the remedy.
        reason: String,
    },
    /// The stiffness holds so few directions that the program is nearly linear.
    #[error(
        "the stiffness holds {rank} of {unknowns} directions, and rows alone would have to hold the others: that is nearly a linear program, \
         which a solver for linear programs answers"
    )]
    NearlyLinear {
        /// The number of directions with stiffness, its rank.
        rank: usize,
        /// The number of dofs, less that of the equalities.
        unknowns: usize,
    },
    /// An answer was found, but it does not meet the tolerance.
    #[error("{}", not_certified(solution, condition, *value, *tolerance))]
    NotCertified {
        /// The best answer, with its certificate.
        solution: Box<Solution>,
        /// Name of the worst condition, as `stationarity`.
        condition: &'static str,
        /// Relative violation of this condition, dimensionless.
        value: f64,
        /// The tolerance that was requested.
        tolerance: f64,
    },
    /// A step that needs a condensed problem.
    #[error(
        "{step} needs a problem that is condensed onto its contact dofs and held by its supports; solve point by point"
    )]
    NotCondensed {
        /// The step that was requested, in words, as `the exact path`.
        step: &'static str,
    },
    /// A scene or a problem that needs more memory than it may take.
    #[error(
        "the problem needs about {} of memory, but {} are allowed: about {dofs:.0e} dofs, {stiffness_entries:.0e} \
         entries of the stiffness, {}; take larger cells, or allow more memory",
        memory(*bytes),
        memory(*allowed),
        if *factor_entries > 0.0 { format!("{factor_entries:.0e} of its factor") } else { "its factor not counted".into() }
    )]
    TooLarge {
        /// Number of unknowns of the refused problem.
        dofs: f64,
        /// Number of entries of the stiffness of the refused problem, both triangles.
        stiffness_entries: f64,
        /// Number of values of the Cholesky factor of the refused stiffness; zero if the rest alone is too large.
        factor_entries: f64,
        /// Memory for everything, estimated, in bytes.
        bytes: f64,
        /// Memory that the solve may take, in bytes.
        allowed: f64,
    },
    /// A problem that neither path solves within the memory that it may take.
    #[error("{}", no_room(*factor, *multigrid, *allowed, ended.as_deref()))]
    NoRoom {
        /// Memory of the direct path, estimated, in bytes.
        factor: f64,
        /// Memory of the iterative path, estimated, in bytes.
        multigrid: f64,
        /// Memory that either path may take, in bytes.
        allowed: f64,
        /// The way in which the iterative path ended without a certified answer, if there was room for it.
        ended: Option<String>,
    },
}

impl From<FactorError> for Error {
    fn from(error: FactorError) -> Self {
        LinearError::from(error).into()
    }
}

impl Error {
    /// The best answer that a solve found before it ended without a certified one; `None` for every other error.
    pub fn into_best(self) -> Option<Solution> {
        match self {
            Error::NotCertified { solution, .. } => Some(*solution),
            _ => None,
        }
    }

    /// The name of the kind of error, the same in every version: for programs that distinguish errors.
    pub fn code(&self) -> &'static str {
        self.class().0
    }

    /// The `status` of a report that ends with the error, such as `under_held`.
    pub fn status(&self) -> &'static str {
        self.class().1
    }

    /// The error of a method that needs a hierarchy for a `dof` without stiffness, which is no travel.
    pub(crate) fn without_hierarchy(dof: usize) -> Self {
        LinearError::Numerical { step: HIERARCHY, reason: format!("dof {dof} (indices from 0) has no stiffness") }
            .into()
    }

    /// Returns `true` if a method met a stiffness that is not definite, so that it is open whether an answer exists.
    pub(crate) fn leaves_existence_open(&self) -> bool {
        use LinearError::{NotConvex, Numerical};
        matches!(self, Error::Linear(NotConvex { .. } | Numerical { step: HIERARCHY, .. }))
    }

    /// The direction of a motion that nothing holds.
    pub(crate) fn direction(&self) -> Option<&[f64]> {
        match self {
            Error::Unbounded { direction, .. } | Error::UnderHeld { direction, .. } => Some(direction),
            _ => None,
        }
    }

    /// The statement of the error about the problem.
    pub fn failure(&self) -> Failure {
        self.class().2
    }

    /// Code, status and failure: the only place, apart from those that raise errors, that distinguishes variants.
    fn class(&self) -> (&'static str, &'static str, Failure) {
        use Failure::{BadInput, NoSolution, NotCertified};
        let bad_input = |code| (code, "bad_input", BadInput);
        match self {
            Error::Linear(error) => {
                let (code, status) = error.class();
                (code, status, BadInput)
            }
            Error::Infeasible { .. } => ("infeasible", "infeasible", NoSolution),
            Error::Unbounded { .. } => ("unbounded", "unbounded", NoSolution),
            Error::UnderHeld { .. } => ("under-held", "under_held", NoSolution),
            Error::OutOfTime { .. } => ("out-of-time", "out_of_time", NotCertified),
            Error::Interrupted => ("interrupted", "interrupted", NotCertified),
            Error::Undecided { .. } => ("undecided", "not_certified", NotCertified),
            Error::NotCertified { .. } => ("not-certified", "not_certified", NotCertified),
            Error::NearlyLinear { .. } => bad_input("nearly-linear"),
            Error::NotCondensed { .. } => bad_input("not-condensed"),
            Error::TooLarge { .. } | Error::NoRoom { .. } => bad_input("too-large"),
        }
    }
}

/// The statement of an error about the problem; the program has an exit code for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The input, a file, or a number on the way is faulty.
    BadInput,
    /// The problem is shown to have no solution, or more than one: it is infeasible, unbounded, or not held.
    NoSolution,
    /// There may be a solution; none was certified.
    NotCertified,
}

fn no_room(factor: f64, multigrid: f64, allowed: f64, ended: Option<&str>) -> String {
    let is_taken = multigrid.is_finite();
    let [factor, multigrid, allowed] = [factor, multigrid, allowed].map(memory);
    match ended {
        None if !is_taken => format!(
            "the problem does not fit into {allowed} of memory: a factor of the stiffness takes about {factor}, and multigrid cannot \
             take it, because contact alone holds some of its dofs; take larger cells, or allow more memory"
        ),
        None => format!(
            "the problem does not fit into {allowed} of memory: a factor of the stiffness takes about {factor}, \
             multigrid about {multigrid}; take larger cells, or allow more memory"
        ),
        Some(ended) => format!(
            "no method gives a certified answer within {allowed} of memory: multigrid, which takes about \
             {multigrid}, ended because {ended}, and a factor of the stiffness takes about {factor}; allow more \
             memory"
        ),
    }
}

/// The sentence for an answer that is not certified: the limit that cut it short, or the condition that decides.
fn not_certified(solution: &Solution, condition: &str, value: f64, tolerance: f64) -> String {
    let (method, iterations) = (&solution.method, solution.iterations);
    let falls_short = match value.is_finite() {
        true => format!("{condition} is {value:.3e}, above the tolerance {tolerance:.1e}"),
        false => format!("no {condition} is known, which must be at most {tolerance:.1e}"),
    };
    match &solution.cut_short {
        Some(cut) if method == "none" => {
            format!("not certified: {cut}; no answer was found, and that of the body at rest is given")
        }
        Some(cut) => {
            format!(
                "not certified: {cut}; the best answer, of {method} after {iterations} iterations, is given: {falls_short}"
            )
        }
        None => {
            let (cancelled, lost) = (cancelled(solution, tolerance), lost_digits(solution));
            format!("not certified: {falls_short} ({method} after {iterations} iterations){cancelled}{lost}")
        }
    }
}

/// The tolerance that the answer does meet, and the forces that cancel if these are why it meets no smaller one.
fn cancelled(solution: &Solution, tolerance: f64) -> String {
    let certificate = &solution.certificate;
    let reached = certificate.reached();
    let mut words = if reached < 1.0 { format!("; certified to {reached:.1e}") } else { String::new() };
    let Cancellation { dof, forces, left } = certificate.cancellation;
    let digits = certificate.cancellation.digits_left();
    let is_balanced = certificate.conditions_hold(BALANCED) && certificate.has_bound();
    if is_balanced && digits < -tolerance.log10() {
        words += &format!(
            ": forces of {forces:.1e} cancel down to {left:.1e} at dof {dof} (from 0); doubles hold 16 digits of the one and \
             {digits:.0} of the other; take the load off the closed row, or give the dof its gap as a support"
        );
    }
    words
}

/// An answer whose conditions hold to this is as exact as its method could make it.
const BALANCED: f64 = 1e-12;

/// The cause of lost digits and the remedy, if the stiffness has a pivot near rounding.
fn lost_digits(solution: &Solution) -> String {
    // A pivot that is not positive belongs to a motion that contact alone holds.
    let Some(pivot) = solution.lost_pivot.filter(|&pivot| pivot > 0.0) else { return String::new() };
    format!(
        "; the stiffness has lost digits to rounding (smallest pivot {pivot:.0e} of its diagonal), as in slender \
         bodies in bending: take fewer elements along the thickness, quadratic elements, or a beam; or hold the \
         body by more supports"
    )
}
