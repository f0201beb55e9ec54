//! The door to the engines: a problem prepared once, and solved for many gaps, loads and starts.

use std::sync::Arc;

use super::boundary::BoundarySolution;
use super::case::{Case, Engine};
use super::factored::Factored;
use super::loading::Load;
use super::multigrid::Hierarchical;
use crate::error::Error;
use crate::qp::judged::{in_time, with_solution};
use crate::qp::linear::multigrid::Multigrid;
use crate::qp::method::Start;
use crate::qp::plan::{Tried, method_for};
use crate::qp::problem::{ContactProblem, check_load};
use crate::qp::settings::{Method, Settings};
use crate::solution::{Seconds, Solution, Why};

/// A contact problem prepared once for many gaps, loads and starts: its stiffness is factorised, or a multigrid hierarchy is
/// built for it, depending on the method.
///
/// Clones are cheap and share the prepared data, and so do [`with_load`](Self::with_load),
/// [`with_settings`](Self::with_settings) and [`starting_from`](Self::starting_from).
///
/// ```
/// use signorini::{ContactProblem, Prepared, Settings, SparseMatrix, SymmetricMatrix};
///
/// // A spring of stiffness 2, pushed with force 3 towards a wall.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let stiffness = SymmetricMatrix::from_lower(one(2.0)?)?;
/// let problem = ContactProblem::new(stiffness, vec![3.0], one(1.0)?, vec![1.0])?;
/// let prepared = Prepared::new(&problem, &Settings::default())?;
///
/// // At distance 1 the spring takes 2 x 1 of the force and the wall the rest; at distance 2 there is no contact.
/// assert_eq!(prepared.solve(&[1.0])?.multiplier, [-1.0]);
/// assert_eq!(prepared.solve(&[2.0])?.displacement, [1.5]);
/// // Twice the force: u = 1, and the wall takes 6 - 2.
/// assert_eq!(prepared.solve_load(vec![6.0])?.multiplier, [-4.0]);
/// # Ok::<(), signorini::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Prepared {
    pub(super) engine: Arc<dyn Engine>,
    pub(super) settings: Settings,
    load: Arc<Load>,
    start: Start,
    /// The reasons for this preparation; `None` if that was decided elsewhere.
    why: Option<Arc<Why>>,
}

/// Number of gaps that a problem is prepared for if it is not known.
const MANY_GAPS: usize = 10;

/// The engine for the method of `settings`: MPRGP works on a hierarchy, every other method on a factor.
///
/// # Errors
/// Those of the engine.
fn engine_of(problem: &ContactProblem, settings: &Settings) -> Result<Arc<dyn Engine>, Error> {
    let settings = &settings.started()?;
    Ok(match settings.method {
        Method::Mprgp => Arc::new(Hierarchical::new(problem, settings)?),
        _ => Arc::new(Factored::new(problem, settings)?),
    })
}

impl Prepared {
    /// Prepares `problem` for the method of `settings`: a hierarchy for [`Method::Mprgp`], a factor for every other;
    /// [`Method::Auto`] takes the one that serves ten gaps in less time, as [`Prepared::for_gaps`].
    ///
    /// # Errors
    /// * [`Error::Setting`] for a setting outside its range,
    /// * [`Error::Infeasible`] for rows that contradict each other at the gaps of `problem`,
    /// * [`Error::NotConvex`] for a stiffness with a negative eigenvalue,
    /// * [`Error::OutOfTime`], [`Error::Interrupted`] and [`Error::TooLarge`] if there is not enough time or memory left,
    /// * [`Error::Numerical`] if the preparation fails for lack of memory.
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        Self::for_gaps(problem, MANY_GAPS, settings)
    }

    /// The same for about this number of gaps, which share a factor or a hierarchy.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn for_gaps(problem: &ContactProblem, gaps: usize, settings: &Settings) -> Result<Self, Error> {
        let (method, why) = method_for(problem, gaps, settings);
        let prepared = Self::by_method(problem, &Settings { method, ..settings.clone() })?;
        Ok(Prepared { settings: settings.clone(), why: why.map(Arc::new), ..prepared })
    }

    /// The same for the method of `settings`, with a factor if they leave the choice.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub(in crate::qp) fn by_method(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        let (engine, load) = (engine_of(problem, settings)?, Arc::new(Load::new(problem.load().to_vec())));
        Ok(Prepared { engine, settings: settings.clone(), load, start: Start::default(), why: None })
    }

    /// The same problem under other settings. The prepared data are kept if their method works on them, with its condensation,
    /// precision and threads; otherwise the problem is prepared again.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn with_settings(&self, settings: &Settings) -> Result<Self, Error> {
        let (settings, start) = (settings.clone(), self.start.clone());
        if self.engine.serves(settings.method) {
            return Ok(Prepared { settings, start, ..self.clone() });
        }
        let engine = engine_of(self.engine.problem(), &settings)?;
        let load = Arc::new(Load::new(self.load.force().to_vec()));
        Ok(Prepared { engine, settings, start, load, why: None })
    }

    /// The same problem under another load, length n, in N, along the positive axes; a factor is swept once for it.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::NotFinite`] for a load that does not fit.
    pub fn with_load(&self, load: Vec<f64>) -> Result<Self, Error> {
        check_load(&load, self.dofs())?;
        Ok(Prepared { load: Arc::new(Load::new(load)), ..self.clone() })
    }

    /// The same, solved from a start, such as the contact set at the last gap.
    pub fn starting_from(&self, start: impl Into<Start>) -> Self {
        Prepared { start: start.into(), ..self.clone() }
    }

    /// Solves with these gaps, one per contact row, in m; negative if the obstacle starts inside the body.
    ///
    /// # Errors
    /// As [`solve`](crate::solve()); [`Error::Length`] and [`Error::NotFinite`] for gaps or a start that do not fit or, with a factor,
    /// gaps that are infinite in other rows than those of the problem that was prepared; [`Error::OutOfTime`] if there is no time for a
    /// first factorisation.
    pub fn solve(&self, gap: &[f64]) -> Result<Solution, Error> {
        let settings = &self.settings.started()?;
        let solved = self.engine.solve(&self.case(gap, settings)?);
        let solved = match solved {
            Err(Error::OutOfTime { .. }) => solved,
            solved => in_time(self.engine.problem(), settings, solved),
        };
        with_solution(solved, |solution| Solution { why: self.why.as_deref().cloned(), ..solution })
    }

    /// Solves with another load, length n, in N, along the positive axes, and the gaps of the problem that was
    /// prepared.
    ///
    /// # Errors
    /// As [`Prepared::with_load`] and [`Prepared::solve`].
    pub fn solve_load(&self, load: Vec<f64>) -> Result<Solution, Error> {
        self.with_load(load)?.solve(self.engine.problem().gap())
    }

    /// Contact set, multipliers and forces with these gaps, one per contact row, in the problem's unit of length,
    /// negative inside the body. The displacement of the body is not computed, so that a condensed problem costs only
    /// the solve on its contact boundary.
    ///
    /// # Errors
    /// As [`Prepared::solve`]; the certificate of the condensed problem must meet the tolerance.
    pub fn boundary(&self, gap: &[f64]) -> Result<BoundarySolution, Error> {
        let settings = &self.settings.started()?;
        self.engine.clone().boundary(&self.case(gap, settings)?)
    }

    /// The question to the engine at these gaps.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::NotFinite`] for a start that does not fit.
    pub(super) fn case<'a>(&'a self, gap: &'a [f64], settings: &'a Settings) -> Result<Case<'a>, Error> {
        let problem = self.engine.problem();
        self.start.check(problem.dofs(), problem.rows())?;
        Ok(Case { load: &self.load, gap, start: &self.start, settings, given: &self.settings, is_bounded: true })
    }
}

impl Prepared {
    /// Number of dofs of the problem.
    pub fn dofs(&self) -> usize {
        self.engine.problem().dofs()
    }

    /// Number of unknowns that the methods work on.
    pub fn condensed_dofs(&self) -> usize {
        self.engine.factor().map_or(self.dofs(), |factor| factor.unknowns)
    }

    /// Number of values of the factor of the stiffness; zero if the methods factorise by themselves or not at all.
    pub fn factor_entries(&self) -> usize {
        self.engine.factor().map_or(0, |factor| factor.entries)
    }

    /// Memory of the values of the factor, in bytes: 8 for each, 4 in single precision.
    pub fn factor_bytes(&self) -> usize {
        self.factor_entries() * if self.is_single() { size_of::<f32>() } else { size_of::<f64>() }
    }

    /// Multiplications of the factorisation of the stiffness; zero without one.
    pub fn multiplications(&self) -> f64 {
        self.engine.factor().map_or(0.0, |factor| factor.multiplications)
    }

    /// Returns `true` if the factor is in single precision.
    pub fn is_single(&self) -> bool {
        self.engine.factor().is_some_and(|factor| factor.is_single)
    }

    /// The multigrid hierarchy; `None` if the stiffness was factorised.
    #[doc(hidden)]
    pub fn hierarchy(&self) -> Option<&Multigrid> {
        self.engine.hierarchy()
    }

    /// The time of the preparation.
    pub fn seconds(&self) -> Seconds {
        self.engine.seconds()
    }

    /// A start for another method, at a small part of the cost of an answer; `None` if the engine finds none.
    pub(in crate::qp) fn near(&self) -> Option<Start> {
        self.engine.near(&self.settings)
    }

    /// The methods and means that a solve tries here.
    pub(in crate::qp) fn tried(&self) -> Tried {
        self.engine.tried(&self.settings)
    }
}

/// The functions that a motion calls in every step.
impl Prepared {
    /// As [`Prepared::boundary`], for one of many steps: only its conditions must meet the tolerance, which costs no triangular
    /// solve, unless the settings name an accuracy.
    ///
    /// # Errors
    /// As [`Prepared::boundary`].
    pub(crate) fn step(&self, gap: &[f64]) -> Result<BoundarySolution, Error> {
        let settings = &self.settings.started()?;
        let case = Case { is_bounded: settings.accuracy.is_some(), ..self.case(gap, settings)? };
        self.engine.clone().boundary(&case)
    }

    /// The displacement at these gaps without a certificate; `None` if the method did not settle on a set, or if its answer is
    /// only valid with a certificate.
    ///
    /// # Errors
    /// As [`Prepared::boundary`].
    pub(crate) fn settled(&self, gap: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let settings = &self.settings.started()?;
        self.engine.settled(&self.case(gap, settings)?)
    }

    /// The displacement that the load causes if no row is closed, in the precision of the factor; `None` without one.
    pub(crate) fn response(&self) -> Option<Vec<f64>> {
        self.engine.response(&self.load)
    }
}
