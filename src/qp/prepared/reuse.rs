//! The prepared data, used again for other gaps, loads, starts and settings.

use std::sync::Arc;

use super::boundary::{BoundarySolution, Inside};
use crate::error::Error;
use crate::qp::engine::{Body, Engine, Load, OnBoundary, Task};
use crate::qp::linear::multigrid::Multigrid;
use crate::qp::method::Start;
use crate::qp::plan::{Attempt, Ended, History, Known, Ladder, Means, Record, Step};
use crate::qp::problem::{ContactProblem, check_load};
use crate::qp::run::{Run, Unprepared, Workbench, engine_of};
use crate::qp::settings::Settings;
use crate::solution::{Seconds, Solution};

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
    problem: ContactProblem,
    pub(super) settings: Settings,
    ladder: Arc<Ladder>,
    /// The data of the first attempt that memory and time allow, with the current load.
    pub(super) bench: Workbench,
    pub(super) start: Start,
}

/// Number of gaps that a problem is prepared for if it is not known.
const MANY_GAPS: usize = 10;

impl Prepared {
    /// Prepares `problem` for the method of `settings`: a hierarchy for [`Method::Mprgp`](crate::Method::Mprgp), a factor for every other;
    /// [`Method::Auto`](crate::Method::Auto) takes the one that serves ten gaps in less time, as [`Prepared::for_gaps`].
    ///
    /// # Errors
    /// * [`Error::Setting`] for a setting outside its range,
    /// * [`Error::Infeasible`] for rows that contradict each other at the gaps of `problem`,
    /// * [`Error::OutOfTime`], [`Error::Interrupted`], [`Error::TooLarge`] and [`Error::NoRoom`] if there is not enough time or memory
    ///   left.
    ///
    /// A stiffness that cannot be prepared, for example because it is not convex, is judged by [`Prepared::solve`].
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        Self::for_gaps(problem, MANY_GAPS, settings)
    }

    /// The same for about this number of gaps, which share a factor or a hierarchy.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn for_gaps(problem: &ContactProblem, gaps: usize, settings: &Settings) -> Result<Self, Error> {
        problem.check_rows()?;
        let given = settings;
        let settings = &given.started()?;
        // A problem that is prepared stays in one piece.
        let ladder = Ladder::of(problem, Known { gaps, is_whole: true }, settings)?;
        let mut history = History::new(settings.goal());
        let with = |ladder: Ladder, attempt: usize, engine: Arc<dyn Engine>| {
            let load = Arc::new(Load::new(problem.load().to_vec()));
            let (bench, ladder) = (Workbench { attempt, engine, load }, Arc::new(ladder));
            Prepared { problem: problem.clone(), settings: given.clone(), ladder, bench, start: Start::default() }
        };
        let mut failed = None;
        while let Some(next) = ladder.next(&history, &settings.watch) {
            let number = next.place.attempt;
            let attempt = &ladder.attempts[number];
            if attempt.means == Means::Problem {
                break;
            }
            let ended = match engine_of(problem, attempt, settings) {
                Ok(engine) => return Ok(with(ladder.after_refusals(&history), number, engine)),
                Err(error @ (Error::TooLarge { .. } | Error::OutOfTime { .. })) => Ended::Refused(error),
                Err(error @ (Error::Numerical { .. } | Error::NotConvex { .. })) => Ended::Failed(error),
                Err(error) => return Err(error),
            };
            if matches!(ended, Ended::Failed(_)) {
                failed.get_or_insert(number);
            }
            history.records.push(Record { ended, ..Record::of(next, Step::Method) });
        }
        match failed {
            Some(number) => {
                let attempt = ladder.attempts[number].clone();
                let engine = Arc::new(Unprepared { problem: problem.clone(), attempt });
                Ok(with(ladder, number, engine))
            }
            None => Err(ladder.no_room(&history).or_else(|| history.into_refusal()).unwrap_or(Error::Interrupted)),
        }
    }

    /// The same problem under other settings. The prepared data are kept if their method works on them, with its condensation,
    /// precision and threads; otherwise the problem is prepared again.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn with_settings(&self, settings: &Settings) -> Result<Self, Error> {
        settings.started()?;
        let (attempt, ladder) = match self.ladder.under(settings) {
            Some(ladder) => (self.bench.attempt, ladder),
            None => {
                let ladder = Ladder::of(&self.problem, Known { gaps: MANY_GAPS, is_whole: true }, settings)?;
                let serves = |attempt: &Attempt| self.bench.engine.serves(&attempt.means);
                let Some(attempt) = ladder.attempts.iter().position(serves) else {
                    let prepared = Self::new(&self.problem.with_load(self.bench.load.force().to_vec())?, settings)?;
                    return Ok(prepared.starting_from(self.start.clone()));
                };
                (attempt, ladder)
            }
        };
        let bench = Workbench { attempt, ..self.bench.clone() };
        Ok(Prepared { settings: settings.clone(), ladder: Arc::new(ladder), bench, ..self.clone() })
    }

    /// The same problem under another load, length n, in N, along the positive axes; a factor is swept once for it.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::NotFinite`] for a load that does not fit.
    pub fn with_load(&self, load: Vec<f64>) -> Result<Self, Error> {
        check_load(&load, self.dofs())?;
        let bench = Workbench { load: Arc::new(Load::new(load)), ..self.bench.clone() };
        Ok(Prepared { bench, ..self.clone() })
    }

    /// The same, solved from a start, such as the contact set at the last gap.
    pub fn starting_from(&self, start: impl Into<Start>) -> Self {
        Prepared { start: start.into(), ..self.clone() }
    }

    /// Solves with these gaps, one per contact row, in m; negative if the obstacle starts inside the body.
    ///
    /// # Errors
    /// As [`solve`](crate::solve()); [`Error::Length`] and [`Error::NotFinite`] for gaps or a start that do not fit or, with a factor,
    /// gaps that are infinite in other rows than those of the problem that was prepared.
    pub fn solve(&self, gap: &[f64]) -> Result<Solution, Error> {
        let (problem, settings) = (self.problem_at(gap)?, self.settings.started()?);
        Run::new(&problem, &self.ladder, &self.start, &settings).with(&self.bench).solved()
    }

    /// Solves with another load, length n, in N, along the positive axes, and the gaps of the problem that was
    /// prepared.
    ///
    /// # Errors
    /// As [`Prepared::with_load`] and [`Prepared::solve`].
    pub fn solve_load(&self, load: Vec<f64>) -> Result<Solution, Error> {
        self.with_load(load)?.solve(self.problem.gap())
    }

    /// Contact set, multipliers and forces with these gaps, one per contact row, in the problem's unit of length,
    /// negative inside the body. The displacement of the body is not computed, so that a condensed problem costs only
    /// the solve on its contact boundary.
    ///
    /// # Errors
    /// As [`Prepared::solve`]; the certificate of the condensed problem must meet the tolerance.
    pub fn boundary(&self, gap: &[f64]) -> Result<BoundarySolution, Error> {
        self.on_boundary(gap, true)
    }

    fn on_boundary(&self, gap: &[f64], is_bounded: bool) -> Result<BoundarySolution, Error> {
        let question = self.question(gap)?;
        let task = question.task(self, &self.start);
        match self.bench.engine.clone().on_boundary(&task, is_bounded) {
            Ok(Some(found)) => Ok(self.boundary_of(found, gap)),
            // The certificate of the whole answer shows what is wrong, unless the answer meets its goal.
            Ok(None) | Err(_) => Ok(self.solve(gap)?.into()),
        }
    }

    fn boundary_of(&self, found: OnBoundary, gap: &[f64]) -> BoundarySolution {
        let OnBoundary { multiplier, contact_set, iterations, condensed_certificate, body } = found;
        let prepared = self.starting_from(&contact_set);
        let inside = Arc::new(Condensed { body, prepared, gap: gap.to_vec(), iterations });
        BoundarySolution { multiplier, contact_set, iterations, condensed_certificate, inside }
    }

    /// The problem at these gaps, under the current load.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::NotFinite`] for gaps or a start that do not fit, [`Error::Infeasible`] for rows that contradict each
    /// other at sight.
    fn problem_at(&self, gap: &[f64]) -> Result<ContactProblem, Error> {
        self.start.check(self.problem.dofs(), self.problem.rows())?;
        let problem = self.problem.with(self.bench.load.force().to_vec(), gap.to_vec())?;
        problem.check_rows()?;
        Ok(problem)
    }

    /// The question of a single step at these gaps.
    ///
    /// # Errors
    /// Those of the gaps and the start; [`Error::Setting`].
    pub(super) fn question(&self, gap: &[f64]) -> Result<Question, Error> {
        Ok(Question { problem: self.problem_at(gap)?, settings: self.settings.started()? })
    }
}

/// The inside of an answer on the boundary: the whole answer is found from the same set.
#[derive(Debug)]
struct Condensed {
    body: Arc<dyn Body>,
    prepared: Prepared,
    gap: Vec<f64>,
    iterations: usize,
}

impl Inside for Condensed {
    fn displacement(&self) -> Vec<f64> {
        self.body.displacement()
    }

    fn solution(&self) -> Result<Solution, Error> {
        let solution = self.prepared.solve(&self.gap)?;
        Ok(Solution { iterations: self.iterations, ..solution })
    }
}

/// A problem under some load at some gaps, and settings with a running clock.
pub(super) struct Question {
    problem: ContactProblem,
    settings: Settings,
}

impl Question {
    /// The first step of that attempt.
    pub fn task<'a>(&'a self, prepared: &'a Prepared, start: &'a Start) -> Task<'a> {
        let Workbench { attempt, load, .. } = &prepared.bench;
        let Attempt { means, limits, .. } = prepared.ladder.attempts[*attempt];
        let (problem, method, settings) = (&self.problem, means.method(), &self.settings);
        Task { step: Step::Method, problem, load, start, limits, method, settings, best: None }
    }
}

impl Prepared {
    /// Number of dofs of the problem.
    pub fn dofs(&self) -> usize {
        self.problem.dofs()
    }

    /// Number of unknowns that the methods work on.
    pub fn condensed_dofs(&self) -> usize {
        self.bench.engine.factor().map_or(self.dofs(), |factor| factor.unknowns)
    }

    /// Number of values of the factor of the stiffness; zero if the methods factorise by themselves or not at all.
    pub fn factor_entries(&self) -> usize {
        self.bench.engine.factor().map_or(0, |factor| factor.entries)
    }

    /// Memory of the values of the factor, in bytes: 8 for each, 4 in single precision.
    pub fn factor_bytes(&self) -> usize {
        self.factor_entries() * if self.is_single() { size_of::<f32>() } else { size_of::<f64>() }
    }

    /// Multiplications of the factorisation of the stiffness; zero without one.
    pub fn multiplications(&self) -> f64 {
        self.bench.engine.tried(None, &self.settings).multiplications
    }

    /// Returns `true` if the factor is in single precision.
    pub fn is_single(&self) -> bool {
        self.bench.engine.factor().is_some_and(|factor| factor.is_single)
    }

    /// The attempts and steps that a solve makes, in order, each with its condition and its reason, a line each.
    pub fn plan(&self) -> String {
        self.ladder.to_string()
    }

    /// The multigrid hierarchy; `None` if the stiffness was factorised.
    #[doc(hidden)]
    pub fn hierarchy(&self) -> Option<&Multigrid> {
        self.bench.engine.hierarchy()
    }

    /// The time of the preparation.
    pub fn seconds(&self) -> Seconds {
        self.bench.engine.seconds()
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
        self.on_boundary(gap, self.settings.accuracy.is_some())
    }

    /// The displacement at these gaps without a certificate; `None` if the method did not settle on a set, or if its answer is
    /// only valid with a certificate.
    ///
    /// # Errors
    /// As [`Prepared::boundary`].
    pub(crate) fn settled(&self, gap: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let question = self.question(gap)?;
        self.bench.engine.settled(&question.task(self, &self.start))
    }

    /// The displacement that the load causes if no row is closed, in the precision of the factor; `None` without one.
    pub(crate) fn response(&self) -> Option<Vec<f64>> {
        self.bench.engine.response(&self.bench.load)
    }
}
