//! The certified quadratic program: minimise 1/2 u'K u - f'u subject to B u - g <= 0, with bounds on the error of its
//! answer.
//!
//! ```
//! use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix, solve_qp};
//! // K, f, B and g: u_0 and u_1 with u_1 <= 1.
//! let k = SparseMatrix::from_triplets(2, 2, &[(0, 0, 3.0), (1, 0, -1.0), (1, 1, 1.0)])?;
//! let b = SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)])?;
//! let problem = ContactProblem::new(SymmetricMatrix::from_lower(k)?, vec![0.0, 3.0], b, vec![1.0])?;
//! let solution = solve_qp(&problem)?;
//! assert!((solution.displacement[0] - 1.0 / 3.0).abs() < 1e-15 && solution.certificate.meets(1e-9));
//! # Ok::<(), signorini_qp::Error>(())
//! ```
//!
//! K is symmetric and positive semidefinite; the multiplier is `lambda = -z <= 0`, with `K u - f - B' lambda = 0`. `Ok`
//! means that the [`Certificate`], recomputed from K, f, B and g, meets the tolerance. This crate knows no mechanics:
//! meshes, scenes and the program are in `signorini`, which re-exports all of it as `signorini::qp`.
//!
//! From a problem to its answer:
//!
//! ```text
//! problem -> plan -> run: rows selected -> scaled -> condensed -> method -> expanded -> unscaled -> certificate -> plan again
//! ```
//!
//! `plan` alone decides what is tried, by the seconds and bytes of `cost`; `run` carries it out with the data that an
//! engine prepares once for many loads and gaps; `existence` alone says that a problem has no answer, or more than one.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]

mod certificate;
mod cost;
mod derivative;
mod engine;
mod error;
mod existence;
mod matrix_market;
mod method;
mod modes;
mod petsc;
mod plan;
mod prepared;
mod problem;
mod run;
mod settings;
mod solution;
mod transform;

#[doc(hidden)]
pub use linear::{file, memory};
use signorini_linear as linear;

pub use cost::Estimate;
pub use derivative::{Adjoint, Change, Derivative, Derivatives, Tangent};
pub use error::{Error, Failure, LinearError};
pub use linear::matrix_market::{format_vector, read_vector};
pub use linear::multigrid::{Multigrid, NearNullSpace};
pub use linear::watch::{Activity, Part, Watch};
pub use linear::{Cholesky, Forest, SparseMatrix, SymmetricMatrix, Width, dot, largest};
pub use method::interior_point::InteriorPoint;
pub use method::penalty::Penalty;
pub use method::{Ending, Outcome, Start};
pub use petsc::PetscLayout;
pub use prepared::{Delassus, Path, Prepared};
pub use problem::ContactProblem;
pub use settings::{Condense, Method, Settings};
pub use solution::{Certificate, ContactSet, Goal, Iteration, Met, ProvenSet, Seconds, Solution, Why};

use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};

use certificate::{Bounding, Examination};
use cost::{Kept, check_memory};
use linear::{Analysis, in_order, threads_of_machine};
use modes::Modes;
use prepared::between;

/// The reason against a folder without a stiffness.
const NO_PROBLEM: &str = "the folder has neither K.mtx nor K.petsc; a problem directory needs K.mtx (stiffness), f.mtx (load), \
                          B.mtx (contact rows) and g.mtx (gaps), or the same four as .petsc; a complementarity problem needs M.mtx and q.mtx; a \
                          scene is a .json file: give its name";

/// Solves a contact problem; `Ok` means that the answer is certified to `settings.tolerance`.
///
/// ```
/// use signorini_qp::{ContactProblem, Method, Settings, SparseMatrix, SymmetricMatrix, solve};
///
/// // A spring of stiffness 2 at rest, a wall that starts 0.5 inside: g = -0.5.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let problem = ContactProblem::new(SymmetricMatrix::of_diagonal(vec![2.0]), vec![0.0], one(1.0)?, vec![-0.5])?;
///
/// let solution = solve(&problem, &Settings::with_method(Method::ActiveSet))?;
/// assert_eq!(solution.displacement, [-0.5]);
/// assert_eq!(solution.multiplier, [2.0 * -0.5]);
/// # Ok::<(), signorini_qp::Error>(())
/// ```
///
/// # Errors
/// * [`LinearError::Setting`] for a setting outside its range,
/// * [`Error::Infeasible`] for contact rows that contradict each other,
/// * [`Error::Unbounded`] for a load along a rigid-body mode that nothing stops,
/// * [`Error::UnderHeld`] for a rigid-body mode that nothing resists: the answer would not be unique,
/// * [`LinearError::NotConvex`] for a stiffness with a negative eigenvalue,
/// * [`Error::NearlyLinear`] for more than 256 dofs of which the stiffness holds less than a quarter,
/// * [`Error::NotCertified`] with the best answer, if it does not meet the tolerance,
/// * [`Error::NoRoom`] if no way within `settings.memory` leads to a certified answer, [`Error::TooLarge`] if the named
///   method does not fit,
/// * [`Error::Interrupted`] if the watch was asked to stop before there was an answer,
/// * [`LinearError::Numerical`] if memory does not suffice.
pub fn solve(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    run::solved(problem, &Start::default(), settings)
}

/// Solves many contact problems, each by itself: the answer of each, or its error, in their order. The threads of
/// `settings` are shared out among the problems, and change no bit; a limit of time holds for each problem.
///
/// ```
/// use signorini_qp::{ContactProblem, Settings, SparseMatrix, SymmetricMatrix, solve_many};
///
/// // Springs of stiffness 2, each before a wall at 1, pushed with forces of 1 and 3.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let stiffness = SymmetricMatrix::of_diagonal(vec![2.0]);
/// let pushed = |force| ContactProblem::new(stiffness.clone(), vec![force], one(1.0)?, vec![1.0]);
/// let answers = solve_many(&[pushed(1.0)?, pushed(3.0)?], &Settings::default());
///
/// for (answer, expected) in answers.into_iter().zip([0.5, 1.0]) {
///     assert_eq!(answer?.displacement, [expected]);
/// }
/// # Ok::<(), signorini_qp::Error>(())
/// ```
pub fn solve_many(problems: &[ContactProblem], settings: &Settings) -> Vec<Result<Solution, Error>> {
    settings.each_of_many(problems.len(), |number, settings| solve(&problems[number], settings))
}

/// Solves a contact problem as a QP by the interior-point method, polished, certified to 1e-9.
///
/// # Errors
/// As [`solve`].
pub fn solve_qp(problem: &ContactProblem) -> Result<Solution, Error> {
    solve(problem, &Settings::with_method(Method::qp()))
}

impl Settings {
    /// The results of `solved` for each number below `count`, shared out as by [`solve_many`]: for problems made one by
    /// one.
    #[doc(hidden)]
    pub fn each_of_many<T: Send>(&self, count: usize, solved: impl Fn(usize, &Settings) -> T + Sync) -> Vec<T> {
        let of_one = Settings { threads: Some(1), ..self.clone() };
        let threads = self.threads.unwrap_or_else(threads_of_machine).clamp(1, count.max(1));
        let next = AtomicUsize::new(0);
        let of_thread = |()| -> Vec<(usize, T)> {
            let numbers =
                std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed)).take_while(|&number| number < count);
            numbers.map(|number| (number, solved(number, &of_one))).collect()
        };
        let mut all: Vec<(usize, T)> = in_order(vec![(); threads], of_thread).into_iter().flatten().collect();
        all.sort_unstable_by_key(|of| of.0);
        all.into_iter().map(|of| of.1).collect()
    }

    /// The threads that one problem takes if none are named: those of the machine, at most 8.
    pub fn threads_of_machine() -> usize {
        linear::threads_of_machine()
    }
}

impl ContactProblem {
    /// Returns `true` if the directory is that of a problem: it has a stiffness in either format.
    pub fn is_directory(directory: &std::path::Path) -> bool {
        stiffness_forms(directory).contains(&true)
    }

    /// The other end of the problem of a directory: its gaps in `g1.mtx`, its load in `f1.mtx`; without a file the gaps
    /// or the load stay unchanged.
    ///
    /// # Errors
    /// As [`read_problem`]; [`LinearError::FileSyntax`] if there is neither file, for a vector of another length, and
    /// for gaps that are infinite in other rows.
    pub fn read_other_end(&self, directory: &std::path::Path) -> Result<ContactProblem, Error> {
        matrix_market::read_other_end(directory, self)
    }

    /// The files of a problem directory: Matrix Market, written piece by piece.
    pub fn files(&self) -> Vec<file::Streamed<'_>> {
        matrix_market::streamed_files(self)
    }

    /// The same as files of PETSc, with this layout of the dofs.
    pub fn petsc_files<'a>(&'a self, layout: &'a PetscLayout) -> Vec<file::Streamed<'a>> {
        petsc::streamed_files(self, layout)
    }

    /// Solves the problem from what is known of its answer; else as [`solve`].
    ///
    /// # Errors
    /// As [`solve`].
    pub fn solve_from(&self, start: &Start, settings: &Settings) -> Result<Solution, Error> {
        run::solved(self, start, settings)
    }

    /// The dual active-set method alone, on a small problem in the units that it has: for comparisons of methods. It is
    /// the last attempt of [`solve`]. `is_definite` says that K is positive definite by itself.
    ///
    /// # Errors
    /// [`Error::NotCondensed`] for a problem that is too large for a dense basis of its rows, or whose stiffness has no
    /// factor; [`LinearError::Numerical`] for lack of memory.
    pub fn dual_active_set(&self, is_definite: bool) -> Result<Outcome, Error> {
        method::dual_active_set::dual_active_set(self, is_definite)
    }

    /// The problem at the share `t` of the way to `last`, which has the same matrices: its loads and gaps lie between
    /// those of both.
    ///
    /// # Errors
    /// [`LinearError::Length`] if `last` has other numbers of dofs or rows.
    pub fn towards(&self, last: &ContactProblem, t: f64) -> Result<ContactProblem, Error> {
        self.with(between(self.load(), last.load(), t), between(self.gap(), last.gap(), t))
    }

    /// The attempts of a solve from a start, in order, each with its condition and its reason: text, a line each.
    ///
    /// # Errors
    /// [`LinearError::Setting`] for a setting outside its range, [`Error::NoRoom`] if nothing fits into the memory, and
    /// those of an analysis of the stiffness.
    pub fn plan(&self, start: &Start, settings: &Settings) -> Result<String, Error> {
        let settings = &settings.started()?;
        plan::Ladder::of(self, 1, !start.is_unknown(), settings)?.in_words(self, settings)
    }

    /// The certificate of an answer: displacement u (length n, in m) and multiplier lambda (length m, in N, `<= 0` in
    /// compression; with equality rows followed by theirs, of either sign), with the energy bound if K is positive
    /// definite or the rows that press hold the body.
    ///
    /// # Errors
    /// `LinearError::Length` for vectors that do not fit, `LinearError::Numerical` if the factorisation of K fails for
    /// lack of memory.
    pub fn certify(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Certificate, Error> {
        let examination = Examination::of(self, [displacement, multiplier], &Bounding::OwnFactor)?;
        Ok(examination.certificate()?.certificate)
    }

    /// The rows for which an answer (u of length n, in m; lambda of length m, in N, `<= 0` in compression) proves, by
    /// its distance and force, that they are open or closed in the exact answer; `None` if K is not positive definite
    /// by itself, except for travels that forces drive against rows, and if no bound is known.
    ///
    /// # Errors
    /// As [`ContactProblem::certify`].
    pub fn prove(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Option<ProvenSet>, Error> {
        Examination::of(self, [displacement, multiplier], &Bounding::OwnFactor)?.proof(None)
    }

    /// The certificate of an answer (u, lambda), one entry per dof and per row of B and then of E, that came from
    /// elsewhere, within the memory of `settings`: with a factor if that is estimated to take at most `seconds`, else
    /// by multigrid.
    ///
    /// # Errors
    /// As [`ContactProblem::certify`]; [`Error::Infeasible`] as [`solve`], if an answer misses its rows;
    /// [`Error::NoRoom`] if there is no room for either.
    pub fn certify_within(
        &self,
        seconds: f64,
        answer: (&[f64], &[f64]),
        settings: &Settings,
    ) -> Result<Certificate, Error> {
        let (displacement, multiplier) = answer;
        let examine =
            |by: &Bounding| Ok(Examination::of(self, [displacement, multiplier], by)?.certificate()?.certificate);
        let certificate = if plan::is_bounded_by_factor(self, seconds, settings)? {
            examine(&Bounding::OwnFactor)
        } else {
            match engine::Hierarchical::new(self, settings) {
                Ok(levels) => examine(&Bounding::Cycles(&levels.multigrid, settings.watch.clone())),
                // A dof without stiffness, or a direction of negative energy, has no hierarchy.
                Err(error) if error.leaves_existence_open() => examine(&Bounding::Nothing),
                Err(error) => Err(error),
            }
        }?;
        // An answer that meets its rows shows that they can be met.
        if certificate.penetration > settings.goal().tolerance {
            run::check_rows(self, settings)?;
        }
        Ok(certificate)
    }

    /// The `count` lowest pairs of `K x = w M x`, with the mass M (n x n, positive semidefinite), on the vectors on
    /// which the rows `closed` and all equality rows vanish; fewer if M has a smaller rank. Unknowns of `first`, such
    /// as those without stiffness, are eliminated where a row allows it.
    ///
    /// ```
    /// use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix, Watch};
    ///
    /// // Two masses of 1, each on a spring to the ground and with one between them, all of stiffness 1: w = 1 and 3.
    /// let k = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(2, 2, &[(0, 0, 2.0), (1, 0, -1.0), (1, 1, 2.0)])?)?;
    /// let m = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?)?;
    /// let wall = SparseMatrix::from_triplets(1, 2, &[(0, 0, 1.0)])?;
    /// let problem = ContactProblem::new(k, vec![0.0; 2], wall, vec![1.0])?;
    /// let found = problem.modes(&m, (&[], &[]), 2, 1, &Watch::default())?;
    /// assert!((found.values[0] - 1.0).abs() < 1e-14 && (found.values[1] - 3.0).abs() < 1e-14 && found.is_complete);
    ///
    /// // With the first mass held at the wall, w = 2.
    /// let held = problem.modes(&m, (&[0], &[]), 2, 1, &Watch::default())?;
    /// assert!((held.values[0] - 2.0).abs() < 1e-14 && held.values.len() == 1);
    /// # Ok::<(), signorini_qp::Error>(())
    /// ```
    ///
    /// # Errors
    /// `LinearError::Shape` if the sizes differ, `LinearError::IndexOutOfRange` for a row beyond the last;
    /// `LinearError::NotConvex` if both matrices vanish on a common vector; [`Error::Interrupted`]; those of the
    /// factorisation.
    pub fn modes(
        &self,
        mass: &SymmetricMatrix,
        (closed, first): (&[usize], &[usize]),
        count: usize,
        threads: usize,
        watch: &Watch,
    ) -> Result<Modes, Error> {
        modes::modes(self, mass, (closed, first), count, threads, watch)
    }

    /// The derivatives of an answer of this problem, with a factor or a hierarchy of their own.
    ///
    /// # Errors
    /// As [`Prepared::new`] and [`Prepared::derivatives`].
    pub fn derivatives(&self, solution: &Solution, settings: &Settings) -> Result<Derivatives, Error> {
        derivative::derivatives(self, solution, settings)
    }

    /// The displacement `K^-1 f`, one entry per dof, in length: rows and equality rows are left out. It takes one
    /// factorisation and one step of refinement, and has no certificate. Of the settings the memory and the
    /// interruption count.
    ///
    /// # Errors
    /// [`LinearError::NotConvex`] for a stiffness that is not positive definite, [`Error::TooLarge`] if the factor does
    /// not fit into the memory, [`Error::Interrupted`], [`LinearError::Numerical`] if memory is not enough all the
    /// same.
    pub fn linear_displacement(&self, settings: &Settings) -> Result<Vec<f64>, Error> {
        let (stiffness, load) = (self.stiffness(), self.load());
        let analysis = Analysis::of(stiffness)?;
        check_memory(self, Kept::OneFactor { values: analysis.factor_entries() }, settings.memory)?;
        if settings.watch.is_over() {
            return Err(Error::Interrupted);
        }
        let factor = analysis.factor(stiffness)?;
        let mut displacement = factor.solve(load);
        let left: Vec<f64> = load.iter().zip(stiffness.mul(&displacement)).map(|(load, force)| load - force).collect();
        displacement.iter_mut().zip(factor.solve(&left)).for_each(|(value, step)| *value += step);
        Ok(displacement)
    }
    /// Factorises the stiffness once for many sets of held rows. Each call of the returned function is one iteration of
    /// the active-set loop, and gives displacement (one entry per dof, in length) and multiplier (one per row of B,
    /// then one per equality row, in force), which may have either sign; `None` if these rows do not hold the body.
    /// Equality rows are always held.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn with_contact_sets(&self) -> Result<impl Fn(&ContactSet) -> Option<[Vec<f64>; 2]>, Error> {
        let factored = engine::factored(self, &Settings::default())?;
        Ok(move |closed: &ContactSet| {
            let held = self.with_equality_rows(closed);
            let [displacement, multiplier] = engine::balanced(&factored, &held, self.load(), self.gap())?;
            Some([displacement, self.split(multiplier).concat()])
        })
    }
}

/// Reads the problem of a directory: Matrix Market files, with `K.mtx`, or PETSc's, with `K.petsc`. A directory with
/// both is refused: they may belong to two problems.
///
/// # Errors
/// [`LinearError::File`] for a file that is missing and for a directory with both; [`LinearError::FileSyntax`] and
/// [`LinearError::FileBytes`] for one that is malformed; those of [`ContactProblem::new`].
pub fn read_problem(directory: &std::path::Path) -> Result<ContactProblem, Error> {
    match stiffness_forms(directory) {
        [true, true] => {
            let both = format!("the folder has both {} and {}", matrix_market::STIFFNESS, petsc::STIFFNESS);
            let source = io::Error::new(io::ErrorKind::InvalidInput, format!("{both}; remove the files of one form"));
            Err(LinearError::File { action: "read", path: directory.to_path_buf(), source }.into())
        }
        [false, true] => petsc::read_problem(directory),
        [false, false] if directory.is_dir() => {
            let source = io::Error::new(io::ErrorKind::NotFound, NO_PROBLEM);
            Err(LinearError::File { action: "read", path: directory.to_path_buf(), source }.into())
        }
        _ => matrix_market::read_problem(directory),
    }
}

/// Flags: `true` if there is a stiffness in Matrix Market format, and in PETSc's.
fn stiffness_forms(directory: &std::path::Path) -> [bool; 2] {
    [matrix_market::STIFFNESS, petsc::STIFFNESS].map(|name| directory.join(name).exists())
}

impl Solution {
    /// The files of an answer: name and text, `u.mtx`, `lambda.mtx`, and with equality rows `mu.mtx`.
    pub fn files(&self) -> Vec<(&'static str, String)> {
        matrix_market::solution_files(self)
    }
}
