//! The one error type: each error states what is wrong, where, which value, and what is allowed.

use std::path::PathBuf;

use crate::memory::in_words as memory;
use crate::solution::{Cancellation, Solution};

/// The step that fails at a dof without stiffness.
const HIERARCHY: &str = "multigrid hierarchy";

/// All errors between a file and a certified answer: faulty input, problems without an answer, and answers that were
/// not certified. Each has a [`code`](Self::code), and one sentence for a reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A vector with a length that does not fit the rest of the problem.
    #[error("{name} has length {found}, but there are {expected} {of}")]
    Length {
        /// The vector in words, as `load vector`.
        name: &'static str,
        /// Number of its entries.
        found: usize,
        /// Number of entries that it must have.
        expected: usize,
        /// The unit of the fitting length, such as `dofs`.
        of: &'static str,
    },
    /// A matrix with a shape that does not fit the rest of the problem.
    #[error("{name} is {} x {}, but it must be {} x {}", found.0, found.1, expected.0, expected.1)]
    Shape {
        /// The matrix in words, as `contact matrix`.
        name: &'static str,
        /// Rows and columns that it has.
        found: (usize, usize),
        /// Rows and columns that fit.
        expected: (usize, usize),
    },
    /// An entry outside its matrix.
    #[error("entry ({row}, {column}) lies outside a matrix of {rows} rows and {columns} columns (indices from 0)")]
    IndexOutOfRange {
        /// Row of the entry, counted from 0.
        row: usize,
        /// Column of the entry, counted from 0.
        column: usize,
        /// Number of rows that the matrix has.
        rows: usize,
        /// Number of columns that the matrix has.
        columns: usize,
    },
    /// Compressed columns that form no matrix.
    #[error("compressed columns: {message}")]
    Pattern {
        /// A sentence on what is wrong, and where.
        message: String,
    },
    /// A number that is not finite, at a place that needs a finite one.
    #[error("{name} has the value {value} at {at} (indices from 0); it must be {allowed}")]
    NotFinite {
        /// The vector or matrix in words.
        name: &'static str,
        /// Index of the entry, or row and column in parentheses, from 0.
        at: String,
        /// The number found: NaN or an infinity, or one that overflows.
        value: f64,
        /// The values allowed there.
        allowed: &'static str,
    },
    /// A stiffness given with both triangles, which differ.
    #[error(
        "the stiffness is not symmetric: entry ({row}, {column}) is {value:e}, entry ({column}, {row}) is \
         {mirrored:e} (indices from 0); give both triangles with equal entries, or only the lower one"
    )]
    NotSymmetric {
        /// Row of the entry below the diagonal, from 0.
        row: usize,
        /// Column of the entry below the diagonal, from 0.
        column: usize,
        /// Value of entry (row, column), in the unit of the matrix.
        value: f64,
        /// Value of entry (column, row), in the unit of the matrix.
        mirrored: f64,
    },
    /// A stiffness with a negative eigenvalue: the problem has no unique minimum.
    #[error("the stiffness is not positive semidefinite ({evidence}): the problem is not convex")]
    NotConvex {
        /// The evidence for it in words, such as a pivot or a direction.
        evidence: String,
    },
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
    /// A setting outside its range.
    #[error("{name} is {value}; it must be {allowed}")]
    Setting {
        /// The setting in words, as `threads`.
        name: &'static str,
        /// The number that was given for it.
        value: f64,
        /// The range in words, as `positive and finite`.
        allowed: &'static str,
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
    /// A library step that failed for its own reason.
    #[error("{step} failed: {reason}")]
    Numerical {
        /// The step in words, as `sparse Cholesky factorisation`.
        step: &'static str,
        /// The cause, as the library states it.
        reason: String,
    },
    /// A matrix or mesh file that does not have the right form.
    #[error("{}:{line}: {message}", file.display())]
    FileSyntax {
        /// Path of the faulty text or mesh file, as it was given.
        file: PathBuf,
        /// Line, from 1; in a binary mesh the line at which the section begins.
        line: usize,
        /// A sentence on what is wrong, and what is allowed; in a binary mesh after the byte of the file, from 0.
        message: String,
    },
    /// A binary file, such as an STL file, that does not have the right form.
    #[error("{}, byte {byte}: {message}", file.display())]
    FileBytes {
        /// Path of the faulty binary file, as it was given.
        file: PathBuf,
        /// Offset of the fault, from 0.
        byte: usize,
        /// A sentence on what is wrong at this byte, and what is allowed.
        message: String,
    },
    /// A file or folder that cannot be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// `read`, `write` or `make the folder`.
        action: &'static str,
        /// Path of the file or folder at which the system refused.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

impl Error {
    /// The best answer that a solve found before it ended without a certified one; `None` for every other error.
    pub fn into_best(self) -> Option<Solution> {
        match self {
            Error::NotCertified { solution, .. } => Some(*solution),
            _ => None,
        }
    }

    /// Refuses a vector, named in words, that has not as many entries as there are `of`.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn check_length(name: &'static str, found: usize, expected: usize, of: &'static str) -> Result<(), Error> {
        if found == expected { Ok(()) } else { Err(Error::Length { name, found, expected, of }) }
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
        Error::Numerical { step: HIERARCHY, reason: format!("dof {dof} (indices from 0) has no stiffness") }
    }

    /// Returns `true` if a method met a stiffness that is not definite, so that it is open whether an answer exists.
    pub(crate) fn leaves_existence_open(&self) -> bool {
        matches!(self, Error::NotConvex { .. } | Error::Numerical { step: HIERARCHY, .. })
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
            Error::Length { .. } => bad_input("length"),
            Error::Pattern { .. } => bad_input("pattern"),
            Error::Shape { .. } => bad_input("shape"),
            Error::IndexOutOfRange { .. } => bad_input("index-out-of-range"),
            Error::NotFinite { .. } => bad_input("not-finite"),
            Error::NotSymmetric { .. } => bad_input("not-symmetric"),
            Error::NotConvex { .. } => ("not-convex", "not_convex", BadInput),
            Error::Infeasible { .. } => ("infeasible", "infeasible", NoSolution),
            Error::Unbounded { .. } => ("unbounded", "unbounded", NoSolution),
            Error::UnderHeld { .. } => ("under-held", "under_held", NoSolution),
            Error::OutOfTime { .. } => ("out-of-time", "out_of_time", NotCertified),
            Error::Interrupted => ("interrupted", "interrupted", NotCertified),
            Error::Undecided { .. } => ("undecided", "not_certified", NotCertified),
            Error::NotCertified { .. } => ("not-certified", "not_certified", NotCertified),
            Error::Setting { .. } => bad_input("setting"),
            Error::NearlyLinear { .. } => bad_input("nearly-linear"),
            Error::NotCondensed { .. } => bad_input("not-condensed"),
            Error::TooLarge { .. } | Error::NoRoom { .. } => bad_input("too-large"),
            Error::Numerical { .. } => ("numerical", "failed", BadInput),
            Error::FileSyntax { .. } | Error::FileBytes { .. } => bad_input("file-syntax"),
            Error::File { .. } => bad_input("file"),
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

/// The sentence for an answer that is not certified: the limit that cut the search short, or the condition that
/// decides.
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

/// The tolerance that the answer does meet, and the forces that cancel each other if these are why it meets no smaller
/// one.
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
