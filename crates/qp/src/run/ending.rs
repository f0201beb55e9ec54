//! The ending of a run: the best answer, or the error that stands in its way.

use std::time::Instant;

use super::{Run, solved, without_certificate};
use crate::certificate::{Bounding, Examination};
use crate::error::{Error, Result};
use crate::method::{Ending, Outcome, Start};
use crate::plan::{Best, Door, Ended, Record, Step};
use crate::solution::{Attempt, Goal, ProvenSet, Seconds, Solution};

/// The error of an answer that is not certified, with the condition that decides.
fn fallen_short(solution: Solution, goal: Goal) -> Error {
    let (condition, value, tolerance) = solution.certificate.decisive(goal.required());
    Error::NotCertified { solution: Box::new(solution), condition, value, tolerance }
}

impl Run<'_> {
    pub fn decided(&mut self) -> Result<Best> {
        let is_decided = |record: &Record| match record.ended {
            Ended::Decided(Error::Interrupted) => self.history.best.is_none(),
            Ended::Decided(_) => true,
            _ => false,
        };
        if let Some(place) = self.history.records.iter().position(is_decided)
            && let Ended::Decided(error) = self.history.records.swap_remove(place).ended
        {
            return Err(error);
        }
        if !self.history.is_certified() {
            if let Some(error) = self.ladder.no_room(&self.history) {
                return Err(error);
            }
            // A motion says nothing of rows that are not met.
            let meets_rows = |best: &Best| best.solution.certificate.penetration <= self.history.sure_tolerance();
            let moves = if self.history.best.as_ref().is_some_and(meets_rows) { self.moves.take() } else { None };
            if let Some(error) = moves.or_else(|| self.doubt()) {
                return Err(error);
            }
        }
        match self.history.best.take() {
            Some(best) => Ok(best),
            None => Err(self.without_answer()?),
        }
    }

    pub fn reported(&self, mut best: Best, proven: (Option<ProvenSet>, f64)) -> Solution {
        let (why, reason) = (self.ladder.why(&self.history, &best), self.ladder.reason(&self.history, &best));
        let mut attempts = self.other_attempts(&best);
        attempts.append(&mut best.solution.attempts);
        let mut solution = Solution { attempts, ..best.solution };
        if solution.why.is_empty() {
            solution.why = why;
        }
        if solution.reason.is_empty() {
            solution.reason = reason;
        }
        let of =
            |stage: fn(&Seconds) -> f64| self.history.records.iter().map(|record| stage(&record.stages)).sum::<f64>();
        let proof = proven.1 + of(|stages| stages.proof);
        let (factor, certificate) = (of(|stages| stages.factor), of(|stages| stages.certificate));
        solution.proven = solution.proven.or(proven.0);
        solution.seconds = Seconds { factor, certificate, proof, solve: self.clock.elapsed().as_secs_f64() };
        solution
    }

    /// The answer in the rows as they were given, if it meets the goal.
    pub fn certified(&self, solution: Solution) -> Result<Solution> {
        let goal = self.settings.goal();
        if goal.is_met_by(&solution.certificate) {
            let without = self.without_open_rows(&solution)?;
            return Ok(without.unwrap_or_else(|| self.problem.in_given_rows(solution)));
        }
        let mut solution = self.problem.in_given_rows(solution);
        let cut_short = solution.cut_short.take().or_else(|| self.settings.watch.cut());
        Err(fallen_short(Solution { cut_short, ..solution }, goal))
    }

    /// The answer without rows closed in `solution` but proven open: the exact one is the same. `None` without any.
    fn without_open_rows(&self, solution: &Solution) -> Result<Option<Solution>> {
        let Some(proven) = &solution.proven else { return Ok(None) };
        let is_open = |row: usize| solution.contact_set.contains(row) && proven.open.contains(row);
        if !(0..self.problem.rows()).any(is_open) {
            return Ok(None);
        }
        let gaps = self.problem.gap().iter().enumerate();
        let gap = gaps.map(|(row, &gap)| if is_open(row) { f64::INFINITY } else { gap }).collect();
        let mut found = match solved(&self.problem.with_gap(gap)?, &Start::default(), self.settings) {
            Ok(found) => found,
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(_) => return Ok(None),
        };
        let multiplier = [&found.multiplier[..], &found.equality_multiplier].concat();
        let certificate = self.problem.certify(&found.displacement, &multiplier)?;
        found.certificate = certificate.judged(self.settings.goal());
        found.seconds.solve = self.clock.elapsed().as_secs_f64();
        Ok(found.certificate.met.is_some().then_some(found))
    }

    /// The error if it is open whether there is an answer, after a method met a motion without energy, or failed for a
    /// stiffness that is not definite. An answer with a bound leaves nothing open, and one of a settled method whose
    /// conditions hold stays an answer.
    fn doubt(&mut self) -> Option<Error> {
        let is_unheld = |record: &Record| match &record.ended {
            Ended::Answered(answered) => answered.is_unheld,
            Ended::Failed(error) => error.leaves_existence_open(),
            _ => false,
        };
        let tolerance = self.settings.goal().tolerance;
        let is_answer = |best: &Best| {
            let certificate = &best.solution.certificate;
            certificate.has_bound() || best.ending == Ending::Settled && certificate.conditions_hold(tolerance)
        };
        let has_answer = self.history.best.as_ref().is_some_and(is_answer);
        if has_answer || self.settings.watch.cut().is_some() || !self.history.records.iter().any(is_unheld) {
            return None;
        }
        if let Some(existence) = &self.existence {
            return existence.doubt().map(|reason| Error::Undecided { reason });
        }
        let question = self.history.records.iter_mut().find(|record| record.step == Step::Existence)?;
        match std::mem::replace(&mut question.ended, Ended::Empty) {
            Ended::Refused(error @ Error::TooLarge { .. }) => Some(error),
            Ended::Empty => {
                Some(Error::Undecided { reason: "its numbers leave the range of double precision".to_string() })
            }
            _ => None,
        }
    }

    /// The error if no step gave an answer: the limit of time, with the body at rest, or the last error.
    fn without_answer(&mut self) -> Result<Error> {
        let records = std::mem::take(&mut self.history.records);
        let errors = records.into_iter().filter_map(|record| match record.ended {
            Ended::Refused(error) | Ended::Failed(error) => Some(error),
            _ => None,
        });
        match (errors.last(), self.settings.watch.cut()) {
            (Some(Error::OutOfTime { .. }), cut_short) | (Some(_), cut_short @ Some(_)) => {
                let at_rest = without_certificate(Outcome::at_rest(self.problem, Ending::Unsettled), None);
                let answer = [&*at_rest.displacement, &at_rest.multiplier];
                let certificate = Examination::of(self.problem, answer, &Bounding::Nothing)?.certificate()?.certificate;
                let at_rest = self.problem.in_given_rows(Solution { certificate, cut_short, ..at_rest });
                Ok(fallen_short(at_rest, self.settings.goal()))
            }
            (Some(error), None) => Ok(error),
            (None, _) => Ok(Error::Interrupted),
        }
    }

    /// The rows that the best answer proves, and the seconds: by prepared data, or for equalities with an own factor.
    pub fn proven(&self, best: &mut Best) -> (Option<ProvenSet>, f64) {
        let (watch, equalities) = (&self.settings.watch, self.problem.equalities());
        let by = match self.made.as_ref().or(self.kept) {
            _ if !self.settings.prove => Bounding::Nothing,
            None if best.tried.is_some() || equalities.is_empty() || self.is_cut || watch.is_over() => {
                Bounding::Nothing
            }
            None => Bounding::OwnFactor,
            Some(bench) if watch.acknowledge() || !watch.allows(bench.engine.proof_seconds()) => Bounding::Nothing,
            // Without a norm at hand there is no factor of the stiffness alone.
            Some(bench) => match bench.engine.bounding(&watch.finishing()) {
                Bounding::OwnFactor if self.problem.without_stiffness().is_empty() => Bounding::Nothing,
                by => by,
            },
        };
        if matches!(by, Bounding::Nothing) {
            return (None, 0.0);
        }
        let clock = Instant::now();
        let Best { solution: Solution { displacement, multiplier, .. }, evidence, .. } = best;
        let examination = Examination::of(self.problem, [displacement, multiplier], &by);
        let proven = examination.and_then(|examination| examination.proof(evidence.take()));
        (proven.ok().flatten(), clock.elapsed().as_secs_f64())
    }

    /// The attempts that did not give the best answer, each with the ending of its own best.
    fn other_attempts(&self, best: &Best) -> Vec<Attempt> {
        let mut others: Vec<(usize, Attempt)> = Vec::new();
        for record in self.history.records.iter().filter(|record| record.attempt != best.attempt) {
            if !matches!(record.ended, Ended::Answered(_) | Ended::Refused(_) | Ended::Failed(_)) {
                continue;
            }
            let reason = record.shortfall(self.settings.goal());
            let reason = match record.tried.and_then(|tried| tried.condensed_dofs) {
                Some(dofs) => format!("on {dofs} condensed dofs {reason}"),
                None => reason,
            };
            let method = match (record.attempt, &self.ladder.door, &record.answer) {
                (0, Some(Door::Pieces(pieces)), _) => format!("{} pieces", pieces.count()),
                (_, _, Some((method, _))) => method.clone(),
                _ => {
                    let named = self.ladder.attempts[record.attempt].method;
                    record.tried.map_or(named, |tried| tried.method).name().to_string()
                }
            };
            match others.last_mut().filter(|other| other.0 == record.attempt) {
                Some((_, other)) => {
                    other.seconds += record.seconds;
                    // An attempt is named by its best answer.
                    if record.is_best() {
                        (other.method, other.reason) = (method, reason);
                    }
                }
                None => others.push((record.attempt, Attempt { method, seconds: record.seconds, reason })),
            }
        }
        others.into_iter().map(|other| other.1).collect()
    }
}
