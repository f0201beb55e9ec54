//! The certified quadratic program: minimise 1/2 u'K u - f'u subject to B u - g <= 0. It knows no mechanics.
//!
//! From a problem to its answer:
//!
//! ```text
//! problem -> plan -> run: rows selected -> scaled -> condensed -> method -> expanded -> unscaled -> certificate -> plan again
//! ```
//!
//! `plan` alone decides what is tried, by the seconds and bytes of `cost`; `run` carries it out with the data that an engine prepares
//! once for many loads and gaps; `existence` alone says that a problem has no answer, or more than one.

mod certificate;
pub(crate) mod cost;
mod directory;
mod engine;
mod existence;
pub(crate) mod linear;
pub(crate) mod matrix_market;
pub(crate) mod method;
pub(crate) mod panics;
pub(crate) mod petsc;
mod plan;
mod prepared;
pub(crate) mod problem;
mod run;
mod settings;
pub(crate) mod transform;

#[cfg(feature = "cli")]
pub(crate) use directory::is_problem_directory;
pub use directory::read_problem;
pub use linear::multigrid::NearNullSpace;
pub use linear::{SparseMatrix, SymmetricMatrix};
pub use matrix_market::{problem_files, read_vector, solution_files};
pub use method::Start;
pub use method::interior_point::InteriorPoint;
pub use method::parametric::Event;
pub use method::penalty::Penalty;
#[cfg(feature = "cli")]
pub(crate) use prepared::between;
pub use prepared::{BoundarySolution, Path, Prepared};
pub use problem::ContactProblem;
#[cfg(feature = "cli")]
pub(crate) use run::solved as solve_from;
pub use settings::{Condense, Method, Precision, Settings};

#[cfg(feature = "cli")]
use certificate::Bounding;
#[cfg(feature = "cli")]
use engine::Engine;

use crate::error::Error;
#[cfg(feature = "cli")]
use crate::solution::Certificate;
use crate::solution::{ContactSet, Solution};

/// Solves a contact problem; `Ok` means that the answer is certified to `settings.tolerance`.
///
/// ```
/// use signorini::{ContactProblem, Method, Settings, SparseMatrix, SymmetricMatrix, solve};
///
/// // A spring of stiffness 2 at rest, a wall that starts 0.5 inside: g = -0.5.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let stiffness = SymmetricMatrix::from_lower(one(2.0)?)?;
/// let problem = ContactProblem::new(stiffness, vec![0.0], one(1.0)?, vec![-0.5])?;
///
/// let solution = solve(&problem, &Settings::with_method(Method::ActiveSet))?;
/// assert_eq!(solution.displacement, [-0.5]);
/// assert_eq!(solution.multiplier, [2.0 * -0.5]);
/// # Ok::<(), signorini::Error>(())
/// ```
///
/// # Errors
/// * [`Error::Setting`] for a setting outside its range,
/// * [`Error::Infeasible`] for contact rows that contradict each other,
/// * [`Error::Unbounded`] for a load along a rigid-body mode that nothing stops,
/// * [`Error::UnderHeld`] for a rigid-body mode that nothing resists: the answer would not be unique,
/// * [`Error::NotConvex`] for a stiffness with a negative eigenvalue,
/// * [`Error::NotCertified`] with the best answer, if it does not meet the tolerance,
/// * [`Error::NoRoom`] if no way within `settings.memory` leads to a certified answer, [`Error::TooLarge`] if the named method does not
///   fit,
/// * [`Error::Interrupted`] if the watch was asked to stop before there was an answer,
/// * [`Error::Numerical`] if memory does not suffice.
pub fn solve(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    run::solved(problem, &Start::default(), settings)
}

/// What a solve would try from a start, in order, in words.
///
/// # Errors
/// [`Error::Setting`] for a setting outside its range, [`Error::NoRoom`] if nothing fits into the memory, and those of an analysis of the
/// stiffness.
#[cfg(feature = "cli")]
pub(crate) fn plan_in_words(problem: &ContactProblem, start: &Start, settings: &Settings) -> Result<String, Error> {
    let settings = &settings.started()?;
    let known = plan::Known { gaps: 1, is_whole: !start.is_unknown() };
    plan::Ladder::of(problem, known, settings)?.in_words(problem, settings)
}

/// The certificate of an answer (u, lambda) that came from elsewhere, within the memory of `settings`: with a factor if that is
/// estimated to take at most `seconds`, else by multigrid.
///
/// # Errors
/// As [`ContactProblem::certify`]; [`Error::Infeasible`] as [`solve`], if an answer misses its rows;
/// [`Error::NoRoom`] if there is no room for either.
#[cfg(feature = "cli")]
pub(crate) fn certify_within(
    problem: &ContactProblem,
    seconds: f64,
    answer: (&[f64], &[f64]),
    settings: &Settings,
) -> Result<Certificate, Error> {
    let (displacement, multiplier) = answer;
    let examine = |by: &Bounding| Ok(problem.examine(by, displacement, multiplier)?.certificate);
    let certificate = if plan::is_bounded_by_factor(problem, seconds, settings)? {
        examine(&Bounding::OwnFactor)
    } else {
        match engine::Hierarchical::new(problem, settings) {
            Ok(hierarchical) => examine(&hierarchical.bounding(&settings.watch, 0.0)),
            // A dof without stiffness, or a direction of negative energy, has no hierarchy.
            Err(Error::NotConvex { .. }) => examine(&Bounding::Nothing),
            Err(error) => Err(error),
        }
    }?;
    // An answer that meets its rows shows that they can be met.
    if certificate.penetration > settings.goal().tolerance {
        existence::check_rows(problem, settings, run::solve_any)?;
    }
    Ok(certificate)
}

/// Solves a contact problem as a QP by the interior-point method, polished, certified to 1e-9.
///
/// # Errors
/// As [`solve`].
pub fn solve_qp(problem: &ContactProblem) -> Result<Solution, Error> {
    solve(problem, &Settings::with_method(Method::qp()))
}

/// Displacement and multiplier of a body with some rows held at their gaps and all others free; `None` if these do not hold it.
pub(crate) type Held = Option<(Vec<f64>, Vec<f64>)>;

/// Factorises `problem` once for many sets of held rows: each call of the returned function is one iteration of the active-set loop;
/// its multiplier may have either sign.
///
/// # Errors
/// As [`Prepared::new`].
#[cfg_attr(not(feature = "pictures"), allow(dead_code))]
pub(crate) fn with_contact_sets(problem: &ContactProblem) -> Result<impl Fn(&ContactSet) -> Held, Error> {
    let factored = engine::Factored::new(problem, &plan::WithFactor::BY_RULES, &Settings::default())?;
    Ok(move |closed: &ContactSet| factored.with_contact_set(closed))
}
