//! A problem prepared once, and solved for many gaps, loads, starts and settings, by the same loop as a single solve.

mod boundary;
mod delassus;

pub use boundary::{Path, between};
pub use delassus::Delassus;

use std::sync::Arc;

use crate::certificate::{Bounding, EnergyNorm, norm_on_equalities};
use crate::engine::{Engine, Factored, Load, Task};
use crate::error::{Error, Result};
use crate::linear::multigrid::Multigrid;
use crate::method::Start;
use crate::plan::{Attempt, Ended, Ladder, Means, Record, Step, Tried};
use crate::problem::ContactProblem;
use crate::run::{KeptRest, Run, Workbench, answered, solved};
use crate::settings::{Method, Settings};
use crate::solution::{Seconds, Solution};
use crate::transform::{Condensation, Elimination};

/// A contact problem prepared once for many gaps, loads and starts: its stiffness is factorised, or a multigrid
/// hierarchy is built for it, depending on the method.
///
/// Clones are cheap and share the prepared data, and so do [`with_load`](Self::with_load),
/// [`with_settings`](Self::with_settings) and [`starting_from`](Self::starting_from).
///
/// ```
/// use signorini_qp::{ContactProblem, Prepared, Settings, SparseMatrix, SymmetricMatrix};
///
/// // A spring of stiffness 2, pushed with force 3 towards a wall.
/// let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
/// let problem = ContactProblem::new(SymmetricMatrix::of_diagonal(vec![2.0]), vec![3.0], one(1.0)?, vec![1.0])?;
/// let prepared = Prepared::new(&problem, &Settings::default())?;
///
/// // At distance 1 the spring takes 2 x 1 of the force and the wall the rest; at distance 2 there is no contact.
/// assert_eq!(prepared.solve(&[1.0])?.multiplier, [-1.0]);
/// assert_eq!(prepared.solve(&[2.0])?.displacement, [1.5]);
/// // Twice the force: u = 1, and the wall takes 6 - 2.
/// assert_eq!(prepared.solve_load(vec![6.0])?.multiplier, [-4.0]);
/// # Ok::<(), signorini_qp::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The problem under the current load.
    pub(crate) problem: ContactProblem,
    pub(crate) settings: Settings,
    ladder: Arc<Ladder>,
    /// The data of the first attempt that memory and time allow; `None` if the stiffness cannot be prepared.
    pub(crate) bench: Option<Workbench>,
    /// The problem without its equalities; `None` also if it has none.
    without: Option<Arc<Without>>,
    pub(super) start: Start,
}

/// A problem without its equalities, prepared.
#[derive(Debug)]
struct Without {
    elimination: Elimination,
    rest: Prepared,
    /// The energy norm of the whole, by which each answer is judged.
    norm: Option<EnergyNorm>,
}

/// Number of gaps that a problem is prepared for if it is not known.
const MANY_GAPS: usize = 10;

impl Prepared {
    /// Prepares `problem` for the method of `settings`: a hierarchy for [`Method::Mprgp`](crate::Method::Mprgp), a
    /// factor for every other; [`Method::Auto`](crate::Method::Auto) takes the one that serves ten gaps in less time,
    /// as [`Prepared::for_gaps`].
    ///
    /// # Errors
    /// * `LinearError::Setting` for a setting outside its range,
    /// * [`Error::Infeasible`] for rows that contradict each other at the gaps of `problem`,
    /// * [`Error::OutOfTime`], [`Error::Interrupted`], [`Error::TooLarge`] and [`Error::NoRoom`] if there is not enough
    ///   time or memory left.
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
        let (ladder, start) = (Ladder::of(problem, gaps, true, settings)?, Start::default());
        let mut run = Run::new(problem, &ladder, &start, settings);
        run.carry_out(|run, step| run.prepared(step).map(|_| Ended::Prepared));
        let (bench, mut history) = (run.made, run.history);
        let is_decided = |last: &mut Record| matches!(last.ended, Ended::Decided(_));
        if let Some(Record { ended: Ended::Decided(error), .. }) = history.records.pop_if(is_decided) {
            return Err(error);
        }
        let has_failed = history.records.iter().any(|record| matches!(record.ended, Ended::Failed(_)));
        if bench.is_none() && !has_failed {
            return Err(ladder.no_room(&history).or_else(|| history.into_refusal()).unwrap_or(Error::Interrupted));
        }
        let ladder = Arc::new(if bench.is_some() { ladder.after_refusals(&history) } else { ladder });
        let (problem, given) = (problem.clone(), given.clone());
        let whole = Prepared { problem, settings: given, ladder, bench, without: None, start };
        Ok(Prepared { without: whole.eliminated(gaps, settings), ..whole })
    }

    /// The problem without its equalities, prepared within the memory that this leaves.
    fn eliminated(&self, gaps: usize, settings: &Settings) -> Option<Arc<Without>> {
        let bench = self.bench.as_ref().filter(|_| !self.problem.equalities().is_empty())?;
        let memory = settings.memory.map(|most| (most - bench.engine.bytes()).max(1.0));
        let elimination = Elimination::of(&self.problem).ok()??;
        let rest = elimination.problem(&self.problem).ok()?;
        let rest = Self::for_gaps(&rest, gaps, &Settings { memory, ..settings.clone() }).ok()?;
        let norm = match bench.engine.bounding(&settings.watch) {
            Bounding::Factor(norm) => Some(norm),
            Bounding::OwnFactor if !elimination.is_cut() => norm_on_equalities(&self.problem).ok()?,
            _ => None,
        };
        let norm = norm.map(|norm| norm.keeping(self.problem.contact()));
        Some(Arc::new(Without { elimination, rest, norm }))
    }

    /// The same problem under other settings. The prepared data are kept if their method works on them, with its
    /// condensation and threads; otherwise the problem is prepared again.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn with_settings(&self, settings: &Settings) -> Result<Self, Error> {
        settings.started()?;
        let anew = || Ok(Self::new(&self.problem, settings)?.starting_from(self.start.clone()));
        let Some(bench) = &self.bench else { return anew() };
        let (attempt, ladder) = match self.ladder.under(settings) {
            Some(ladder) => (bench.attempt, ladder),
            None => {
                let ladder = Ladder::of(&self.problem, MANY_GAPS, true, settings)?;
                let means = if bench.engine.factor().is_some() { Means::Factor } else { Means::Multigrid };
                let serves = |attempt: &Attempt| attempt.means == means;
                let Some(attempt) = ladder.attempts.iter().position(serves) else { return anew() };
                (attempt, ladder)
            }
        };
        let bench = Some(Workbench { attempt, ..bench.clone() });
        Ok(Prepared { settings: settings.clone(), ladder: Arc::new(ladder), bench, ..self.clone() })
    }

    /// The same problem under another load, length n, in N, along the positive axes; a factor is swept once for it.
    ///
    /// # Errors
    /// `LinearError::Length` and `LinearError::NotFinite` for a load that does not fit.
    pub fn with_load(&self, load: Vec<f64>) -> Result<Self, Error> {
        let problem = self.problem.with_load(load.clone())?;
        let load = Arc::new(Load::new(load));
        let bench = self.bench.clone().map(|bench| Workbench { load, ..bench });
        Ok(Prepared { problem, bench, ..self.clone() })
    }

    /// The same problem at other gaps, one per contact row, in m; negative if the obstacle starts inside the body. A
    /// solve is given its gaps: these are for [`derivatives`](Self::derivatives).
    ///
    /// # Errors
    /// `LinearError::Length` and `LinearError::NotFinite` for gaps that do not fit.
    pub fn with_gap(&self, gap: Vec<f64>) -> Result<Self, Error> {
        Ok(Prepared { problem: self.problem.with_gap(gap)?, ..self.clone() })
    }

    /// The same, solved from a start, such as the contact set at the last gap.
    pub fn starting_from(&self, start: impl Into<Start>) -> Self {
        Prepared { start: start.into(), ..self.clone() }
    }

    /// Solves with these gaps, one per contact row, in m; negative if the obstacle starts inside the body.
    ///
    /// # Errors
    /// As [`solve`](crate::solve()); `LinearError::Length` and `LinearError::NotFinite` for gaps or a start that do
    /// not fit or, with a factor, gaps that are infinite in other rows than those of the problem that was prepared.
    pub fn solve(&self, gap: &[f64]) -> Result<Solution, Error> {
        let (problem, settings) = (self.problem_at(gap)?, self.settings.started()?);
        if !problem.equalities().is_empty() {
            return self.without_equalities(&problem, &settings);
        }
        let run = Run::new(&problem, &self.ladder, &self.start, &settings);
        answered(&mut run.with(self.bench.as_ref()))
    }

    /// Solves a problem with equalities, which are eliminated already if they are those of the one that was prepared.
    fn without_equalities(&self, problem: &ContactProblem, settings: &Settings) -> Result<Solution> {
        let kept = self.without.as_ref().filter(|without| without.elimination.serves(problem, &self.problem));
        let Some(Without { elimination, rest, norm }) = kept.map(Arc::as_ref) else {
            return solved(problem, &self.start, settings);
        };
        let solve = |start: &Start, settings: &Settings| {
            let settings = Settings { memory: rest.settings.memory, ..settings.clone() };
            let (load, rest) = (elimination.load(problem), rest.with_settings(&settings)?);
            // The same load is swept already.
            let rest = if load == rest.problem.load() { rest } else { rest.with_load(load)? };
            rest.starting_from(start.clone()).solve(&elimination.gap(problem, rest.problem.contact()))
        };
        let norm = &norm.as_ref().map(|norm| norm.watched(&settings.watch.finishing()));
        let kept = KeptRest { elimination, norm, solve: &solve };
        let start = self.start.of_all_rows(problem);
        let mut run = Run::new(problem, &self.ladder, &start, settings).with(self.bench.as_ref());
        run.rest = Some(&kept);
        answered(&mut run)
    }

    /// Solves with another load, length n, in N, along the positive axes, and the gaps of the problem that was
    /// prepared.
    ///
    /// # Errors
    /// As [`Prepared::with_load`] and [`Prepared::solve`].
    pub fn solve_load(&self, load: Vec<f64>) -> Result<Solution, Error> {
        self.with_load(load)?.solve(self.problem.gap())
    }

    fn problem_at(&self, gap: &[f64]) -> Result<ContactProblem> {
        self.start.of_all_rows(&self.problem).check(self.problem.dofs(), self.problem.rows())?;
        let problem = self.problem.with_gap(gap.to_vec())?;
        problem.check_rows()?;
        Ok(problem)
    }

    /// What the prepared data answer to the method alone, from a start at these gaps; `None` without prepared data.
    pub(super) fn ask<T>(
        &self,
        gap: &[f64],
        start: &Start,
        answer: impl FnOnce(&Engine, &Task) -> Result<Option<T>>,
    ) -> Result<Option<T>> {
        let Some(Workbench { attempt, engine, load }) = &self.bench else { return Ok(None) };
        let (problem, settings) = (&self.problem_at(gap)?, &self.settings.started()?);
        let by = &self.ladder.attempts[*attempt];
        let (step, limits, settings, best) = (Step::Method, by.limits, &by.settings(settings), None);
        answer(engine, &Task { step, problem, load, start, limits, settings, best })
    }

    /// Number of dofs of the problem.
    pub fn dofs(&self) -> usize {
        self.problem.dofs()
    }

    fn tried(&self) -> Option<Tried> {
        self.bench.as_ref().map(|bench| bench.engine.tried(Method::Auto))
    }

    pub(super) fn factored(&self) -> Option<&Arc<Factored>> {
        self.bench.as_ref().and_then(|bench| bench.engine.factor())
    }

    /// Number of unknowns that the prepared methods work on: less than those of the problem if it is condensed.
    pub fn condensed_dofs(&self) -> usize {
        self.tried().and_then(|tried| tried.condensed_dofs).unwrap_or(self.dofs())
    }

    /// Number of values of the factor of the stiffness; zero if the methods factorise by themselves or not at all.
    pub fn factor_entries(&self) -> usize {
        self.factored().and_then(|factored| factored.condensation.as_ref()).map_or(0, Condensation::factor_entries)
    }

    /// Memory of the values of the factor, in bytes.
    pub fn factor_bytes(&self) -> usize {
        self.factor_entries() * size_of::<f64>()
    }

    /// Multiplications of the factorisation of the stiffness; zero without one.
    pub fn multiplications(&self) -> f64 {
        self.tried().map_or(0.0, |tried| tried.multiplications)
    }

    /// The attempts and steps that a solve makes, in order, each with its condition and its reason, a line each.
    pub fn plan(&self) -> String {
        self.ladder.to_string()
    }

    /// The multigrid hierarchy; `None` if the stiffness was factorised.
    #[doc(hidden)]
    pub fn hierarchy(&self) -> Option<&Multigrid> {
        self.bench.as_ref().and_then(|bench| bench.engine.hierarchy())
    }

    /// The seconds of the preparation, part by part; zero before it.
    pub fn seconds(&self) -> Seconds {
        self.bench.as_ref().map_or(Seconds::default(), |bench| bench.engine.seconds())
    }
}
