//! The one loop of a solve.

use std::sync::Arc;
use std::time::Instant;

use super::elimination::{self, KeptRest, Rest};
use super::pieces;
use crate::certificate::{Bounding, Examination, Examined, at_rest, with_rounding};
use crate::engine::{Engine, Factored, Found, Hierarchical, Load, Task};
use crate::error::{Error, LinearError};
use crate::existence::Existence;
use crate::linear::SymmetricMatrix;
use crate::method::{Ending, Outcome, Start};
use crate::plan::{Answered, Attempt, Best, Ended, From, History, Known, Ladder, Means, Next, Record, Step, Tried};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{Certificate, Seconds, Solution, Why};
use crate::transform::Scaling;

/// The answer of `problem` from a start, by the ladder of `settings`.
pub fn solved(problem: &ContactProblem, start: &Start, settings: &Settings) -> Result<Solution, Error> {
    by(problem, start, settings, |ladder| ladder)
}

/// The same, by a part of the ladder.
fn by(
    problem: &ContactProblem,
    start: &Start,
    settings: &Settings,
    part: impl Fn(Ladder) -> Ladder,
) -> Result<Solution, Error> {
    let settings = &settings.started()?;
    let start = &start.of_all_rows(problem);
    start.check(problem.dofs(), problem.rows())?;
    problem.check_rows()?;
    let ladder = part(Ladder::of(problem, Known { gaps: 1, is_whole: !start.is_unknown() }, settings)?);
    Run::new(problem, &ladder, start, settings).solved()
}

/// The engine with these means; `None` for the problem alone.
pub(crate) fn engine_by(
    means: Means,
    problem: &ContactProblem,
    settings: &Settings,
) -> Result<Option<Arc<dyn Engine>>, Error> {
    Ok(match means {
        Means::Problem => None,
        Means::Multigrid => Some(Arc::new(Hierarchical::new(problem, settings)?)),
        Means::Factor(with) => Some(Arc::new(Factored::new(problem, &with, settings)?)),
    })
}

/// The prepared data of an attempt, and its load.
#[derive(Clone, Debug)]
pub(crate) struct Workbench {
    pub attempt: usize,
    pub engine: Arc<dyn Engine>,
    pub load: Arc<Load>,
}

/// A ladder that is being carried out.
pub(crate) struct Run<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) ladder: &'a Ladder,
    start: &'a Start,
    pub(super) settings: &'a Settings,
    pub(super) history: History,
    /// The data that the caller keeps prepared.
    pub kept: Option<&'a Workbench>,
    /// What the caller keeps of the problem without its equalities.
    pub rest: Option<&'a KeptRest<'a>>,
    /// The data that were prepared last.
    pub(super) made: Option<Workbench>,
    /// The sets of the last method, and their number, with its attempt.
    last: Option<(usize, Outcome)>,
    pub(super) existence: Option<Existence>,
    /// The motion that nothing holds in the problem without its equalities, as an error.
    pub(super) moves: Option<Error>,
    /// `true` if a long equality was cut, so that no factor of the whole is made.
    pub(super) is_cut: bool,
    pub(super) clock: Instant,
}

impl<'a> Run<'a> {
    /// A run on `problem` from `start`, under settings with a running clock.
    pub fn new(problem: &'a ContactProblem, ladder: &'a Ladder, start: &'a Start, settings: &'a Settings) -> Self {
        let (history, is_cut, clock) = (History::new(settings.goal()), false, Instant::now());
        let (kept, rest, made, last, existence, moves) = (None, None, None, None, None, None);
        Run { problem, ladder, start, settings, history, kept, rest, made, last, existence, moves, is_cut, clock }
    }

    /// The same with data that are prepared already: the first attempt is that of these data.
    pub fn with(self, kept: &'a Workbench) -> Self {
        Run { kept: Some(kept), history: History { first: kept.attempt, ..self.history }, ..self }
    }

    /// Carries out the ladder; the best answer, if it meets the goal.
    pub fn solved(mut self) -> Result<Solution, Error> {
        self.carry_out();
        self.ended()
    }

    /// Makes one step after the other, until the plan names none.
    pub(super) fn carry_out(&mut self) {
        while let Some(next) = self.ladder.next(&self.history, &self.settings.watch) {
            let clock = Instant::now();
            let attempt = &self.ladder.attempts[next.place.attempt];
            let step = attempt.steps[next.place.rung].step;
            let mut record = Record::of(next, step);
            record.ended = match self.made_step(&next, attempt, &mut record) {
                Ok(ended) => ended,
                Err(error @ Error::Linear(LinearError::NotConvex { .. })) if step == Step::Existence => {
                    Ended::Decided(error)
                }
                Err(error) => Ended::by(error),
            };
            record.seconds = clock.elapsed().as_secs_f64();
            self.history.records.push(record);
        }
    }

    fn made_step(&mut self, next: &Next, attempt: &Attempt, record: &mut Record) -> Result<Ended, Error> {
        match record.step {
            Step::Pieces => self.in_pieces(record),
            Step::Elimination => self.by_elimination(record),
            Step::Existence => self.looked_at_existence(),
            Step::Proximal => self.by_proximal_steps(record),
            Step::Uniqueness => self.looked_at_uniqueness(),
            _ => self.with_engine(next, attempt, record),
        }
    }

    fn with_engine(&mut self, next: &Next, attempt: &Attempt, record: &mut Record) -> Result<Ended, Error> {
        let Some(bench) = self.prepared(next.place.attempt, record)? else { return Ok(Ended::Empty) };
        let Workbench { engine, load, .. } = bench;
        let (method, settings) = (attempt.means.method(), self.settings);
        let tried = engine.tried(method);
        record.tried = Some(tried);
        // The interior point has no use for a set.
        let from = match (next.start, tried.method) {
            (From::Cycles, Method::Qp(_)) => From::Given,
            (from, _) => from,
        };
        let start = self.start_from(from, record.step);
        let best = self.history.best.as_ref().map(|best| &best.solution);
        let (problem, step, limits) = (self.problem, record.step, next.limits);
        let task = Task { step, problem, load: &load, start: &start, limits, method, settings, best };
        let Some(found) = engine.make(&task)? else { return Ok(Ended::Empty) };
        record.stages.factor += found.factor_seconds;
        if let Ending::Infeasible { rows, weights } = &found.outcome.ending {
            return Ok(Ended::Decided(problem.infeasible(rows, weights)));
        }
        let (ending, solution) = (found.outcome.ending.clone(), self.answer(found, &tried, record));
        self.settings.watch.step("certificate", 0);
        let is_unsettled = record.step == Step::Method && ending == Ending::Unsettled;
        let by = match is_unsettled && self.ladder.wanders_by(tried.method) {
            true => Bounding::Nothing,
            false => engine.bounding(&self.settings.watch.finishing()),
        };
        let answer = Best { ending, tried: Some(tried), ..Best::of(solution, next.place.attempt) };
        self.judged(answer, &by, record).map(Ended::Answered)
    }

    /// The prepared data of an attempt; those of another attempt are freed first, unless the caller keeps them.
    fn prepared(&mut self, attempt: usize, record: &mut Record) -> Result<Option<Workbench>, Error> {
        let is_of = |bench: &&Workbench| bench.attempt == attempt;
        if let Some(bench) = self.kept.filter(is_of).or(self.made.as_ref().filter(is_of)) {
            return Ok(Some(bench.clone()));
        }
        self.made = None;
        let kept_bytes = self.kept.map_or(0.0, |kept| kept.engine.bytes());
        let memory = self.settings.memory.map(|most| (most - kept_bytes).max(0.0));
        let settings = Settings { memory, ..self.settings.clone() };
        let engine = engine_by(self.ladder.attempts[attempt].means, self.problem, &settings)?;
        let Some(engine) = engine else { return Ok(None) };
        record.stages.factor += engine.seconds().factor;
        let load = Arc::new(Load::new(self.problem.load().to_vec()));
        self.made = Some(Workbench { attempt, engine, load });
        Ok(self.made.clone())
    }

    fn start_from(&self, from: From, step: Step) -> Start {
        let best = || self.history.best.as_ref().map(|best| &best.solution);
        match (from, step) {
            (_, Step::Continuation | Step::Dual) => {
                self.last.as_ref().map_or_else(Start::default, |last| Start::from(&last.1.contact_set))
            }
            (From::Given, _) => self.start.clone(),
            (From::Cycles, _) if self.start.is_unknown() => {
                let near = Hierarchical::new(self.problem, self.settings).ok();
                near.and_then(|near| near.near(&self.settings.watch)).unwrap_or_default()
            }
            (From::Cycles, _) => self.start.clone(),
            (From::Best, _) => best().map_or_else(|| self.start.clone(), Start::from),
            (From::Nothing, _) => Start::default(),
        }
    }

    /// What was found as an answer, not judged yet.
    fn answer(&mut self, found: Found, tried: &Tried, record: &Record) -> Solution {
        let mut outcome = found.outcome;
        let attempt = record.place.attempt;
        match (record.improves(), &self.history.best) {
            (true, Some(best)) => Solution {
                displacement: outcome.displacement,
                multiplier: outcome.multiplier,
                contact_set: outcome.contact_set,
                refinements: best.solution.refinements + 1,
                ..best.solution.clone()
            },
            _ => {
                // The steps of one attempt count together.
                if let Some((_, before)) = self.last.take().filter(|last| last.0 == attempt) {
                    outcome = outcome.after(before);
                }
                let [displacement, multiplier] =
                    [&mut outcome.displacement, &mut outcome.multiplier].map(std::mem::take);
                self.last = Some((attempt, outcome.clone()));
                let outcome = Outcome { displacement, multiplier, ..outcome };
                let condensed_dofs = tried.condensed_dofs.unwrap_or(outcome.displacement.len());
                let solution = without_certificate(outcome, tried.method.name());
                Solution { condensed_dofs, lost_pivot: tried.lost_pivot, ..solution }
            }
        }
    }

    /// Judges an answer, and the same with those parts at rest that may rest; the better one is kept if it is the best
    /// so far.
    pub(super) fn judged(&mut self, answer: Best, by: &Bounding, record: &mut Record) -> Result<Answered, Error> {
        let clock = Instant::now();
        let Solution { displacement, multiplier, .. } = &answer.solution;
        let examination = Examination::of(self.problem, [displacement, multiplier], by)?;
        let Examined { certificate, evidence, may_rest } = examination.certificate()?;
        record.stages.certificate += clock.elapsed().as_secs_f64();
        let wants_best = answer.tried.is_none_or(|tried| tried.method.wants_best());
        let at_rest = at_rest(self.problem, displacement, &may_rest).filter(|_| wants_best);
        let at_rest = at_rest.map(|displacement| Best {
            solution: Solution { displacement, ..answer.solution.clone() },
            ending: answer.ending.clone(),
            evidence: None,
            ..answer
        });
        let certificate = certificate.judged(self.settings.goal());
        let solution = Solution { certificate, ..answer.solution };
        record.answer = Some((solution.method.clone(), certificate));
        let answered = self.history.offer(Best { solution, evidence, ..answer });
        match at_rest {
            Some(at_rest) => Ok(answered.or(self.judged(at_rest, by, record)?)),
            None => Ok(answered),
        }
    }

    /// The answers of the pieces as one.
    fn in_pieces(&mut self, record: &mut Record) -> Result<Ended, Error> {
        let Some(pieces) = &self.ladder.pieces else { return Ok(Ended::Empty) };
        let pieces = Arc::clone(pieces);
        let joined = pieces::solved(self.problem, &pieces, self.settings, |piece, settings| {
            solved(piece, &Start::default(), settings)
        })?;
        let Some((solution, certificates)) = joined else { return Ok(Ended::Empty) };
        let Seconds { factor, certificate, proof, .. } = solution.seconds;
        record.stages = Seconds { factor, certificate, proof, solve: 0.0 };
        let answer = Best::of(solution, record.place.attempt);
        self.judged(answer, &Bounding::Pieces(&certificates), record).map(Ended::Answered)
    }

    /// The answer without the equalities, and these put back.
    fn by_elimination(&mut self, record: &mut Record) -> Result<Ended, Error> {
        // What is exact enough for the rest may be far from that for a whole that moves almost without energy.
        let exact = Settings { tolerance: Some(f64::MIN_POSITIVE), accuracy: None, ..self.settings.clone() };
        let mut all: Option<Answered> = None;
        for settings in [self.settings, &exact] {
            let (answer, of_rest) = match elimination::solved(self.problem, self.start, settings, self.rest, solved)? {
                Rest::Answer(answer, of_rest) => (*answer, of_rest),
                Rest::Moves(error) => {
                    self.moves = Some(error);
                    break;
                }
                Rest::Open => break,
            };
            let Seconds { factor, certificate, .. } = answer.seconds;
            record.stages.factor += factor;
            record.stages.certificate += certificate;
            // An error has the same energy in the rest, but for the rounding of the displacement.
            let of_rest = of_rest.map(|rest| [with_rounding(self.problem, rest, &answer.displacement)]);
            self.is_cut = of_rest.is_some();
            let norm = self.rest.and_then(|kept| kept.norm.clone());
            let by_norm = || norm.map_or(Bounding::OwnFactor, Bounding::Factor);
            let by = of_rest.as_ref().map_or_else(by_norm, |rest| Bounding::Pieces(rest));
            let answered = self.judged(Best::of(answer, record.place.attempt), &by, record)?;
            all = Some(all.map_or(answered, |all| all.or(answered)));
            if self.history.is_certified() || !settings.method.wants_best() {
                break;
            }
        }
        Ok(all.map_or(Ended::Empty, Ended::Answered))
    }

    /// Whether an answer exists.
    fn looked_at_existence(&mut self) -> Result<Ended, Error> {
        let Some(existence) = Existence::of(self.problem, self.settings)? else { return Ok(Ended::Empty) };
        if let Some(unbounded) = existence.unbounded() {
            check_rows(self.problem, self.settings)?;
            return Err(unbounded);
        }
        self.existence = Some(existence);
        Ok(Ended::MayExist)
    }

    /// Checks that the best answer is the only one.
    fn looked_at_uniqueness(&mut self) -> Result<Ended, Error> {
        let (Some(existence), Some(best)) = (&self.existence, &self.history.best) else { return Ok(Ended::Empty) };
        existence.check_unique(self.problem, &best.solution, self.ladder.sure_tolerance())?;
        Ok(Ended::MayExist)
    }
}

/// The outcome of the method called `name` as a solution, without a certificate.
pub(super) fn without_certificate(outcome: Outcome, name: &str) -> Solution {
    let Outcome { displacement, multiplier, contact_set, iterations, history, variant, .. } = outcome;
    Solution {
        condensed_dofs: displacement.len(),
        displacement,
        multiplier,
        equality_multiplier: Vec::new(),
        contact_set,
        method: format!("{name}{variant}"),
        iterations,
        history,
        certificate: Certificate::unknown(),
        proven: None,
        cut_short: None,
        refinements: 0,
        lost_pivot: None,
        reason: String::new(),
        why: Why::default(),
        attempts: Vec::new(),
        seconds: Seconds::default(),
    }
}

/// Checks that some displacement meets all contact rows of `problem`: the nearest to rest, in units of equal stiffness.
///
/// # Errors
/// [`Error::Infeasible`] for contact rows that contradict each other; if that is not decided, they count as met.
pub(crate) fn check_rows(problem: &ContactProblem, settings: &Settings) -> Result<(), Error> {
    problem.check_rows()?;
    let (contact, rest) = (problem.contact().clone(), vec![0.0; problem.dofs()]);
    let stiffness = SymmetricMatrix::of_diagonal(Scaling::of(problem.stiffness(), &contact)?.identity(0));
    let nearest = ContactProblem::computed(stiffness, rest, contact, problem.gap().to_vec())?;
    match by(&nearest, &Start::default(), &settings.of_question(), Ladder::without_existence) {
        Err(infeasible @ Error::Infeasible { .. }) => Err(infeasible),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::method::interior_point::InteriorPoint;
    use crate::plan::Means;
    use crate::settings::Method;

    /// A chain of springs between a support and nothing, its last dofs before walls, under a force on each dof.
    fn chain(dofs: usize, ground: f64, walls: &[(usize, f64)], force: f64) -> ContactProblem {
        let mut entries = vec![(0, 0, ground)];
        for dof in 1..dofs {
            entries.extend([(dof, dof, 1.0), (dof - 1, dof - 1, 1.0), (dof, dof - 1, -1.0)]);
        }
        let rows: Vec<_> = walls.iter().enumerate().map(|(row, wall)| (row, wall.0, 1.0)).collect();
        let gap: Vec<f64> = walls.iter().map(|wall| wall.1).collect();
        ContactProblem::of_entries(&entries, &vec![force; dofs], &rows, &gap)
    }

    fn by(method: Method) -> Settings {
        Settings::with_method(method)
    }

    /// The steps of a run are those of its ladder, in its order; only steps that may gain are made again.
    #[test]
    fn the_steps_that_are_recorded_are_those_of_the_plan() {
        let held = || chain(30, 1.0, &[(29, 1.0), (20, 0.5)], 1.0);
        let loose = Method::Qp(InteriorPoint { polish: false, tolerance: 1e-2 });
        let kinds: [(&str, ContactProblem, Settings, bool); 11] = [
            ("held", held(), Settings::default(), true),
            ("as exact as doubles", held(), Settings::default().with_tolerance(1e-300), true),
            ("by name", held(), by(Method::ActiveSet), true),
            ("polished", held(), by(Method::qp()), true),
            ("unpolished", held(), by(loose), false),
            ("penalty", held(), by(Method::penalty()), false),
            ("multigrid", held(), by(Method::Mprgp), true),
            ("held by a wall", chain(30, 0.0, &[(29, 1.0)], 1.0), Settings::default(), true),
            ("driven away", chain(30, 0.0, &[(29, 1.0)], -1.0), Settings::default(), false),
            ("in balance", chain(30, 0.0, &[(29, 1.0)], 0.0), Settings::default(), false),
            ("without time", held(), Settings::default().with_time(Duration::from_nanos(1)), false),
        ];
        for (name, problem, settings, is_solved) in kinds {
            let settings = settings.started().unwrap();
            let ladder = Ladder::of(&problem, Known { gaps: 1, is_whole: false }, &settings).unwrap();
            let start = Start::default();
            let mut run = Run::new(&problem, &ladder, &start, &settings);
            run.carry_out();
            let steps: Vec<(usize, usize)> =
                run.history.records.iter().map(|record| (record.place.attempt, record.place.rung)).collect();
            assert!(steps.is_sorted(), "{name}: {steps:?}");
            for (before, record) in run.history.records.iter().zip(run.history.records.iter().skip(1)) {
                let is_by_cycles = ladder.attempts[record.place.attempt].means == Means::Multigrid;
                assert!(before.place != record.place || record.improves() || is_by_cycles, "{name}: {steps:?}");
            }
            for record in &run.history.records {
                let attempt = &ladder.attempts[record.place.attempt];
                assert_eq!(attempt.steps[record.place.rung].step, record.step, "{name}");
                assert!(record.tried.is_none() || attempt.means != Means::Problem, "{name}");
            }
            assert_eq!(run.ended().is_ok(), is_solved, "{name}: {steps:?}");
        }
    }
}
