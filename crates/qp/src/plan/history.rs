//! What was tried and what came of it.

use super::attempt::{Limits, Next, Place, Step, Tried};
use crate::certificate::Evidence;
use crate::error::{Error, LinearError};
use crate::method::Ending;
use crate::solution::{Certificate, Goal, Seconds, Solution};

/// What came of a step.
#[derive(Debug)]
pub enum Ended {
    Answered(Answered),
    /// Nothing: the step has no means here, or does not find an answer.
    Empty,
    /// Existence: nothing speaks against an answer.
    MayExist,
    /// Memory or time do not allow it.
    Refused(Error),
    /// It failed; another step may do better.
    Failed(Error),
    /// An error that no other step changes.
    Decided(Error),
}

impl Ended {
    /// What came of a step that ended with an error.
    pub fn by(error: Error) -> Self {
        match error {
            Error::TooLarge { .. } | Error::OutOfTime { .. } => Ended::Refused(error),
            Error::Linear(LinearError::Numerical { .. } | LinearError::NotConvex { .. }) => Ended::Failed(error),
            _ => Ended::Decided(error),
        }
    }
}

/// An answer of a step, beside those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answered {
    pub is_settled: bool,
    /// `true` if the method met a free motion, or a negative energy.
    pub is_unheld: bool,
    pub iterations: usize,
    pub is_best: bool,
    /// `true` if it misses by no more than half of what the best before missed by.
    pub gains: bool,
}

impl Answered {
    /// Two answers of one step together.
    pub fn or(self, other: Answered) -> Self {
        Answered { is_best: self.is_best || other.is_best, gains: self.gains || other.gains, ..other }
    }
}

/// A step that was made.
#[derive(Debug)]
pub struct Record {
    pub place: Place,
    pub step: Step,
    pub limits: Limits,
    /// The method, if the data of the attempt were prepared.
    pub tried: Option<Tried>,
    pub ended: Ended,
    /// Wall-clock seconds of the step.
    pub seconds: f64,
    /// Seconds of factorisations, certificates and proofs.
    pub stages: Seconds,
    /// The method with its variant, and the certificate of its answer, if it has one.
    pub answer: Option<(String, Certificate)>,
}

impl Record {
    /// A step that begins.
    pub fn of(next: Next, step: Step) -> Self {
        let Next { place, limits, .. } = next;
        let (ended, stages) = (Ended::Empty, Seconds::default());
        Record { place, step, limits, tried: None, ended, seconds: 0.0, stages, answer: None }
    }

    /// The reason why this step did not give an answer that meets the goal, in a few words.
    pub fn shortfall(&self, goal: Goal) -> String {
        match (&self.ended, &self.answer) {
            (Ended::Refused(error) | Ended::Failed(error) | Ended::Decided(error), _) => error.to_string(),
            (_, Some((_, certificate))) => match certificate.decisive(goal.required()) {
                (condition, value, _) if value.is_infinite() => format!("no {condition} is known"),
                (condition, value, tolerance) => format!("{condition} is {value:.1e}, above {tolerance:.1e}"),
            },
            _ => String::new(),
        }
    }

    /// Returns `true` for a step that improves the best answer.
    pub fn improves(&self) -> bool {
        matches!(self.step, Step::Refinement | Step::Repair)
    }
}

/// The best answer so far, with the attempt that found it.
#[derive(Debug)]
pub struct Best {
    pub solution: Solution,
    pub attempt: usize,
    /// The method of that attempt, if its data were prepared.
    pub tried: Option<Tried>,
    pub ending: Ending,
    pub evidence: Option<Evidence>,
}

impl Best {
    /// An answer of a settled method without an engine.
    pub fn of(solution: Solution, attempt: usize) -> Self {
        Best { solution, attempt, tried: None, ending: Ending::Settled, evidence: None }
    }
}

/// All steps that were made, and the best answer.
#[derive(Debug)]
pub struct History {
    pub goal: Goal,
    pub first: usize,
    pub records: Vec<Record>,
    pub best: Option<Best>,
}

impl History {
    /// Nothing was tried yet.
    pub fn new(goal: Goal) -> Self {
        // Most runs end with their first step.
        History { goal, first: 0, records: Vec::with_capacity(1), best: None }
    }

    /// Returns `true` if an answer meets the goal.
    pub fn is_certified(&self) -> bool {
        self.best.as_ref().is_some_and(|best| self.goal.is_met_by(&best.solution.certificate))
    }

    /// Offers the answer of a step: it is kept if it is better than the best so far.
    pub fn offer(&mut self, answer: Best) -> Answered {
        /// A clear gain leaves at most this share of the worst condition.
        const CLEAR: f64 = 0.5;
        let certificate = &answer.solution.certificate;
        let gains = |share: f64| {
            self.best.as_ref().is_none_or(|best| certificate.gains_on(&best.solution.certificate, self.goal, share))
        };
        let answered = Answered {
            is_settled: answer.ending == Ending::Settled,
            is_unheld: answer.ending == Ending::Unheld,
            iterations: answer.solution.iterations,
            is_best: gains(1.0),
            gains: gains(CLEAR),
        };
        if answered.is_best {
            self.best = Some(answer);
        }
        answered
    }

    pub fn last_answer(&self) -> Option<&Answered> {
        let answers = self.records.iter().rev().filter_map(|record| match &record.ended {
            Ended::Answered(answered) if !record.improves() => Some(answered),
            _ => None,
        });
        { answers }.next()
    }

    /// The last attempt with prepared data.
    pub fn last_tried(&self) -> Option<&Tried> {
        self.records.iter().rev().find_map(|record| record.tried.as_ref())
    }

    /// The last refusal, if nothing else was found.
    pub fn into_refusal(self) -> Option<Error> {
        let refused = |record: Record| if let Ended::Refused(error) = record.ended { Some(error) } else { None };
        self.records.into_iter().filter_map(refused).last()
    }

    /// Returns `true` if existence was looked at.
    pub fn was_in_doubt(&self) -> bool {
        self.records.iter().any(|record| record.step == Step::Existence)
    }
}
