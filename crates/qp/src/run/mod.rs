//! Carries out a ladder: one loop makes the steps of the plan, judges each answer once, keeps the best, records all.

mod door;
mod ending;
mod proximal;

use std::sync::Arc;
use std::time::Instant;

use crate::certificate::{Bounding, EnergyNorm, Examination, Examined, at_rest};
use crate::engine::{Engine, Hierarchical, Load, Task, factored};
use crate::error::{Error, LinearError, Result};
use crate::existence::Existence;
use crate::linear::SymmetricMatrix;
use crate::method::{Ending, Outcome, Start};
use crate::plan::{Answered, Best, Door, Ended, From, History, Ladder, Means, Record, Step, Tried};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{Certificate, Seconds, Solution, Why};
use crate::transform::{Elimination, Scaling};

/// The answer of `problem` from a start, by the ladder of `settings`.
pub fn solved(problem: &ContactProblem, start: &Start, settings: &Settings) -> Result<Solution> {
    let (start, settings) = &checked(problem, start, settings)?;
    let ladder = Ladder::of(problem, 1, !start.is_unknown(), settings)?;
    answered(&mut Run::new(problem, &ladder, start, settings))
}

/// The flow of a solve, from the plan to the answer: the best one, if it meets the goal.
pub(crate) fn answered(run: &mut Run) -> Result<Solution, Error> {
    run.pass_the_door();
    run.carry_out(|run, step| {
        let Some(bench) = run.prepared(step)? else { return run.asked(step) };
        let Some(outcome) = run.found(&bench, step)? else { return Ok(Ended::Empty) };
        let answer = run.answer(outcome, step);
        run.examined(answer, &bench, step)
    });
    let mut best = run.decided()?;
    let proven = run.proven(&mut best);
    let solution = run.reported(best, proven);
    run.certified(solution)
}

/// Start and settings that fit a problem, with the clock running.
fn checked(problem: &ContactProblem, start: &Start, settings: &Settings) -> Result<(Start, Settings)> {
    let (settings, start) = (settings.started()?, start.of_all_rows(problem));
    start.check(problem.dofs(), problem.rows())?;
    problem.check_rows()?;
    Ok((start, settings))
}

/// The prepared data of an attempt, and its load.
#[derive(Clone, Debug)]
pub struct Workbench {
    pub attempt: usize,
    pub engine: Engine,
    pub load: Arc<Load>,
}

/// What is kept of a prepared problem without its equalities.
pub struct KeptRest<'a> {
    pub elimination: &'a Elimination,
    pub norm: &'a Option<EnergyNorm>,
    pub solve: &'a dyn Fn(&Start, &Settings) -> Result<Solution>,
}

pub struct Run<'a> {
    pub problem: &'a ContactProblem,
    pub ladder: &'a Ladder,
    pub start: &'a Start,
    pub settings: &'a Settings,
    pub history: History,
    /// The data that the caller keeps prepared.
    pub kept: Option<&'a Workbench>,
    pub rest: Option<&'a KeptRest<'a>>,
    /// The data that were prepared last.
    pub made: Option<Workbench>,
    /// The sets of the last method, and their number, with its attempt.
    last: Option<(usize, Outcome)>,
    pub existence: Option<Existence>,
    /// The motion that nothing holds in the problem without its equalities, as an error.
    pub moves: Option<Error>,
    /// `true` if a long equality was cut, so that no factor of the whole is made.
    pub is_cut: bool,
    pub clock: Instant,
}

impl<'a> Run<'a> {
    /// A run on `problem` from `start`, under settings with a running clock.
    pub fn new(problem: &'a ContactProblem, ladder: &'a Ladder, start: &'a Start, settings: &'a Settings) -> Self {
        let (history, is_cut, clock) = (ladder.history(settings), false, Instant::now());
        let (kept, rest, made, last, existence, moves) = (None, None, None, None, None, None);
        Run { problem, ladder, start, settings, history, kept, rest, made, last, existence, moves, is_cut, clock }
    }

    /// The same with data that may be prepared already: the first attempt is then that of these data.
    pub fn with(mut self, kept: Option<&'a Workbench>) -> Self {
        self.kept = kept;
        self.history.first = kept.map_or(self.history.first, |kept| kept.attempt);
        self
    }

    /// Makes one step after the other, until the plan names none.
    pub fn carry_out(&mut self, make: impl Fn(&mut Self, &mut Record) -> Result<Ended>) {
        while let Some(step) = self.ladder.next(&self.history) {
            self.record(step, &make);
        }
    }

    fn record(&mut self, mut step: Record, make: impl FnOnce(&mut Self, &mut Record) -> Result<Ended>) {
        let clock = Instant::now();
        step.ended = match make(self, &mut step) {
            Ok(ended) => ended,
            Err(error @ Error::Linear(LinearError::NotConvex { .. })) if step.step == Step::Existence => {
                Ended::Decided(error)
            }
            Err(error) => Ended::by(error),
        };
        step.seconds = clock.elapsed().as_secs_f64();
        self.history.records.push(step);
    }

    /// Solves what is left once equalities are eliminated, or each of the pieces that nothing couples.
    fn pass_the_door(&mut self) {
        let ladder = self.ladder;
        match &ladder.door {
            Some(Door::Equalities) if !self.problem.equalities().is_empty() => {
                self.record(ladder.step_at(0, 0), Self::by_elimination);
            }
            Some(Door::Pieces(pieces)) => self.record(ladder.step_at(0, 0), |run, step| run.in_pieces(pieces, step)),
            _ => {}
        }
    }

    fn asked(&mut self, step: &mut Record) -> Result<Ended> {
        match step.step {
            Step::Existence => self.looked_at_existence(),
            Step::Proximal => self.by_proximal_steps(step),
            Step::Uniqueness => self.looked_at_uniqueness(),
            _ => Ok(Ended::Empty),
        }
    }

    /// The prepared data of an attempt, `None` for a question; others are freed first, unless the caller keeps them.
    pub fn prepared(&mut self, step: &mut Record) -> Result<Option<Workbench>> {
        if step.means == Means::Problem || step.step == Step::Existence {
            return Ok(None);
        }
        let attempt = step.attempt;
        let is_of = |bench: &&Workbench| bench.attempt == attempt;
        if let Some(bench) = self.kept.filter(is_of).or(self.made.as_ref().filter(is_of)) {
            return Ok(Some(bench.clone()));
        }
        self.made = None;
        let kept_bytes = self.kept.map_or(0.0, |kept| kept.engine.bytes());
        let memory = self.settings.memory.map(|most| (most - kept_bytes).max(0.0));
        let settings = Settings { memory, ..self.ladder.attempts[attempt].settings(self.settings) };
        let engine = match step.means {
            Means::Problem => return Ok(None),
            Means::Multigrid => Engine::Levels(Arc::new(Hierarchical::new(self.problem, &settings)?)),
            Means::Factor => Engine::Factor(Arc::new(factored(self.problem, &settings)?)),
        };
        step.stages.factor += engine.seconds().factor;
        let load = Arc::new(Load::new(self.problem.load().to_vec()));
        self.made = Some(Workbench { attempt, engine, load });
        Ok(self.made.clone())
    }

    /// What a step finds by the prepared data: they scale, start the method, and expand.
    fn found(&self, bench: &Workbench, record: &mut Record) -> Result<Option<Outcome>> {
        let attempt = &self.ladder.attempts[record.attempt];
        let settings = &attempt.settings(self.settings);
        let tried = bench.engine.tried(attempt.method);
        record.tried = Some(tried);
        // The interior point has no use for a set.
        let from = match (record.start, tried.method) {
            (From::Cycles, Method::Qp(_)) => From::Given,
            (from, _) => from,
        };
        let start = &self.start_from(from, record.step);
        let best = self.history.best.as_ref().map(|best| &best.solution);
        let (problem, load, step, limits) = (self.problem, &bench.load, record.step, record.limits);
        let found = bench.engine.make(&Task { step, problem, load, start, limits, settings, best })?;
        let Some((found, factor_seconds)) = found else { return Ok(None) };
        record.stages.factor += factor_seconds;
        match &found.ending {
            Ending::Infeasible { rows, weights } => Err(problem.infeasible(rows, weights)),
            _ => Ok(Some(found)),
        }
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

    fn answer(&mut self, mut outcome: Outcome, step: &Record) -> Best {
        let (attempt, ending) = (step.attempt, outcome.ending.clone());
        let solution = match (step.improves(), &self.history.best) {
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
                without_certificate(outcome, step.tried.as_ref())
            }
        };
        Best { ending, tried: step.tried, ..Best::of(solution, attempt) }
    }

    fn examined(&mut self, answer: Best, bench: &Workbench, step: &mut Record) -> Result<Ended> {
        self.settings.watch.step("certificate", 0);
        let is_unsettled = step.step == Step::Method && answer.ending == Ending::Unsettled;
        let by = match is_unsettled && answer.tried.is_some_and(|tried| self.history.wanders_by(tried.method)) {
            true => Bounding::Nothing,
            false => bench.engine.bounding(&self.settings.watch.finishing()),
        };
        self.judged(answer, &by, step).map(Ended::Answered)
    }

    /// Judges an answer, and the same with the parts at rest that may rest; the best so far is kept.
    pub fn judged(&mut self, answer: Best, by: &Bounding, record: &mut Record) -> Result<Answered> {
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

    fn looked_at_existence(&mut self) -> Result<Ended> {
        let Some(existence) = Existence::of(self.problem, self.settings)? else { return Ok(Ended::Empty) };
        if let Some(unbounded) = existence.unbounded() {
            check_rows(self.problem, self.settings)?;
            return Err(unbounded);
        }
        self.existence = Some(existence);
        Ok(Ended::MayExist)
    }

    fn looked_at_uniqueness(&mut self) -> Result<Ended> {
        let (Some(existence), Some(best)) = (&self.existence, &self.history.best) else { return Ok(Ended::Empty) };
        existence.check_unique(self.problem, &best.solution, self.history.sure_tolerance())?;
        Ok(Ended::MayExist)
    }
}

/// The outcome of a method as a solution, without a certificate; at rest without a method.
pub fn without_certificate(outcome: Outcome, tried: Option<&Tried>) -> Solution {
    let name = tried.map_or("none", |tried| tried.method.name());
    let Outcome { displacement, multiplier, contact_set, iterations, history, variant, .. } = outcome;
    Solution {
        condensed_dofs: tried.and_then(|tried| tried.condensed_dofs).unwrap_or(displacement.len()),
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
        lost_pivot: tried.and_then(|tried| tried.lost_pivot),
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
pub fn check_rows(problem: &ContactProblem, settings: &Settings) -> Result<()> {
    problem.check_rows()?;
    let (contact, rest) = (problem.contact().clone(), vec![0.0; problem.dofs()]);
    let stiffness = SymmetricMatrix::of_diagonal(Scaling::of(problem.stiffness(), &contact)?.identity(0));
    let nearest = ContactProblem::computed(stiffness, rest, contact, problem.gap().to_vec())?;
    let met = || {
        let (start, settings) = &checked(&nearest, &Start::default(), &settings.of_question())?;
        let ladder = Ladder::of(&nearest, 1, false, settings)?.without_existence();
        answered(&mut Run::new(&nearest, &ladder, start, settings))
    };
    match met() {
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
            let ladder = Ladder::of(&problem, 1, false, &settings).unwrap();
            let start = Start::default();
            let mut run = Run::new(&problem, &ladder, &start, &settings);
            let is_answered = answered(&mut run).is_ok();
            let steps: Vec<(usize, usize)> =
                run.history.records.iter().map(|record| (record.attempt, record.rung)).collect();
            assert!(steps.is_sorted(), "{name}: {steps:?}");
            for (pair, record) in steps.windows(2).zip(run.history.records.iter().skip(1)) {
                let is_again = record.improves() || record.means == Means::Multigrid;
                assert!(pair[0] != pair[1] || is_again, "{name}: {steps:?}");
            }
            for record in &run.history.records {
                let attempt = &ladder.attempts[record.attempt];
                assert_eq!(attempt.steps[record.rung].step, record.step, "{name}");
                assert!(record.tried.is_none() || attempt.means != Means::Problem, "{name}");
            }
            assert_eq!(is_answered, is_solved, "{name}: {steps:?}");
        }
    }
}
