//! What was tried and what came of it.

use crate::certificate::Evidence;
use crate::error::{Error, LinearError};
use crate::method::Ending;
use crate::method::mprgp::Limits;
use crate::settings::{Method, Settings};
use crate::solution::{Certificate, Goal, Seconds, Solution};

/// An answer shows which rows press only if its conditions hold to this, for every requested tolerance.
const SURE_CONDITIONS: f64 = 1e-9;

/// What a step works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Means {
    Problem,
    /// A factor of the stiffness.
    Factor,
    /// A multigrid hierarchy of the stiffness, for MPRGP.
    Multigrid,
}

/// What is done in an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    Method,
    /// The active set, from the set that the interior point reaches.
    InteriorPoint,
    /// The active set, from the set that a penalty ladder reaches.
    Continuation,
    Dual,
    /// The best answer, refined by the answer for its residual.
    Refinement,
    /// The best answer, changed by the repair of its own bound.
    Repair,
    /// Whether the problem has an answer, from the problem alone.
    Existence,
    /// Steps with a regular stiffness in place of a singular one.
    Proximal,
    /// The check that the best answer is the only one.
    Uniqueness,
}

/// The start of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// The start that the caller gave, or none.
    Given,
    /// The start that the caller gave, or the set of a few cycles: a front of closed rows moves one row of nodes a set.
    Cycles,
    /// The best answer of the attempts so far.
    Best,
    Nothing,
}

/// The method of an attempt, once its data are prepared, with its number of unknowns if they are fewer than all.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tried {
    pub method: Method,
    pub condensed_dofs: Option<usize>,
    /// `true` if the answer may fall short of a goal that a slower way would reach.
    pub is_shortcut: bool,
    /// The smallest pivot of the stiffness, for a diagonal of order one, if it is close to rounding.
    pub lost_pivot: Option<f64>,
    /// `true` if the stiffness is known to be singular to rounding.
    pub is_singular: bool,
    pub multiplications: f64,
    /// Estimated seconds of a set of closed rows, if each has a factor of its own; zero if not.
    pub set_seconds: f64,
}

impl Tried {
    /// The method and its unknowns in words, if the rules chose it.
    pub fn in_words(&self) -> String {
        let (method, on, multiplications) = (self.method.name(), unknowns(self.condensed_dofs), self.multiplications);
        format!("of such methods {method}, {on}, for {multiplications:.1e} multiplications of a factor")
    }
}

/// The unknowns of a method in words; with this number of dofs, if they are fewer than all.
pub fn unknowns(condensed_dofs: Option<usize>) -> String {
    condensed_dofs.map_or_else(|| "on all dofs".to_string(), |dofs| format!("condensed to {dofs} dofs"))
}

/// What came of a step.
#[derive(Debug)]
pub enum Ended {
    Answered(Answered),
    /// Nothing: the step has no means here, or does not find an answer.
    Empty,
    /// Existence: nothing speaks against an answer.
    MayExist,
    /// The data are prepared, and nothing else is to be done.
    Prepared,
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

/// A step: the next one, or one that was made.
#[derive(Debug)]
pub struct Record {
    /// The place of the step in the ladder: its attempt, and its number there.
    pub attempt: usize,
    pub rung: usize,
    pub means: Means,
    pub step: Step,
    pub start: From,
    /// The limits that the steps before leave for it.
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

    /// Returns `true` if the step gave the best answer of those up to it.
    pub fn is_best(&self) -> bool {
        matches!(self.ended, Ended::Answered(Answered { is_best: true, .. }))
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
    pub settings: Settings,
    /// `true` if the program chooses the method, and the stiffness has all entries.
    pub is_dense: bool,
    /// Estimated seconds of a multigrid hierarchy, if it was compared and fits into the memory.
    pub hierarchy_seconds: Option<f64>,
    /// `true` if equalities are eliminated first.
    pub is_eliminated: bool,
    pub first: usize,
    pub records: Vec<Record>,
    pub best: Option<Best>,
}

impl History {
    /// Returns `true` if an answer meets the goal.
    pub fn is_certified(&self) -> bool {
        self.certificate().is_some_and(|best| self.settings.goal().is_met_by(best))
    }

    pub fn falls_short(&self) -> bool {
        !self.is_certified()
    }

    pub fn certificate(&self) -> Option<&Certificate> {
        self.best.as_ref().map(|best| &best.solution.certificate)
    }

    /// Offers the answer of a step: it is kept if it is better than the best so far.
    pub fn offer(&mut self, answer: Best) -> Answered {
        /// A clear gain leaves at most this share of the worst condition.
        const CLEAR: f64 = 0.5;
        let certificate = &answer.solution.certificate;
        let goal = self.settings.goal();
        let gains = |share: f64| self.certificate().is_none_or(|best| certificate.gains_on(best, goal, share));
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

    fn last_answer(&self) -> Option<&Answered> {
        self.records.iter().rev().find_map(|record| match &record.ended {
            Ended::Answered(answered) if !record.improves() => Some(answered),
            _ => None,
        })
    }

    /// Returns `true` if the last method met a motion that no row stops, or a negative energy.
    pub fn is_unheld(&self) -> bool {
        self.last_answer().is_some_and(|answer| answer.is_unheld)
    }

    /// Returns `true` if the last method did not settle.
    pub fn is_unsettled(&self) -> bool {
        self.last_answer().is_some_and(|answer| !answer.is_settled)
    }

    /// Returns `true` if it did not settle for lack of sets.
    pub fn is_slow(&self) -> bool {
        self.is_unsettled() && !self.is_unheld()
    }

    pub fn last_tried(&self) -> Option<&Tried> {
        self.records.iter().rev().find_map(|record| record.tried.as_ref())
    }

    pub fn method(&self) -> Method {
        self.last_tried().map_or(self.settings.method, |tried| tried.method)
    }

    /// The steps of the last attempt.
    pub fn in_attempt(&self) -> impl DoubleEndedIterator<Item = &Record> {
        let last = self.records.last().map(|record| record.attempt);
        self.records.iter().filter(move |record| Some(record.attempt) == last)
    }

    /// Returns `true` if a last resort may replace the best answer, by the value by which it misses the goal.
    pub fn may_replace(&self) -> bool {
        let goal = self.settings.goal();
        let miss = self.certificate().map_or(f64::INFINITY, |best| best.decisive(goal.required()).1);
        self.method().allows_last_resort(if miss.is_nan() { f64::INFINITY } else { miss })
    }

    /// Returns `true` if the last step that was no question leaves the best answer to be improved.
    pub fn may_improve(&self, is_new: impl Fn(&Record) -> bool) -> bool {
        let asks = self.certificate().is_some_and(|best| best.asks_for_more(self.settings.goal()));
        let last = self.in_attempt().rfind(|record| record.step != Step::Existence);
        asks && last.is_some_and(is_new) && self.method().wants_best()
    }

    /// Returns `true` if sets of this method wander on a dense stiffness: the interior point follows, without a bound.
    pub fn wanders_by(&self, method: Method) -> bool {
        self.is_dense && method == Method::ActiveSet
    }

    /// Returns `true` if nothing was done but to eliminate equalities, which left forces out of balance at a dof.
    pub fn is_unbalanced(&self) -> bool {
        let required = self.settings.goal().required();
        self.is_eliminated && self.records.len() == 1 && self.certificate().is_some_and(|it| it.stationarity > required)
    }

    /// Estimated seconds of the sets of the last attempt so far, each with a factor of its own.
    pub fn spent(&self) -> f64 {
        let seconds = |record: &Record| match (&record.ended, record.tried) {
            (Ended::Answered(answered), Some(tried)) => answered.iterations as f64 * tried.set_seconds,
            _ => 0.0,
        };
        self.in_attempt().map(seconds).sum()
    }

    /// Returns `true` if the last attempt did not settle, and one more set would cost more than the other way.
    pub fn is_outrun(&self) -> bool {
        let (Some(first), Some(last)) = (self.in_attempt().next(), self.records.last()) else { return false };
        let is_unsettled = matches!(last.ended, Ended::Answered(Answered { is_settled: false, is_unheld: false, .. }));
        let next = last.tried.map_or(0.0, |tried| tried.set_seconds);
        is_unsettled && self.spent() + next > first.limits.most_seconds
    }

    /// Returns `true` if multigrid fits, and memory or time refused the attempt before, or its sets cost more.
    pub fn is_refused(&self) -> bool {
        let Some(seconds) = self.hierarchy_seconds else { return false };
        match self.records.last().map(|record| &record.ended) {
            Some(Ended::Refused(Error::OutOfTime { .. })) => self.settings.watch.allows(seconds),
            Some(Ended::Refused(_)) => true,
            _ => self.is_outrun(),
        }
    }

    /// The last refusal, if nothing else was found.
    pub fn into_refusal(self) -> Option<Error> {
        let refused = |record: Record| if let Ended::Refused(error) = record.ended { Some(error) } else { None };
        self.records.into_iter().filter_map(refused).last()
    }

    pub fn was_in_doubt(&self) -> bool {
        self.records.iter().any(|record| record.step == Step::Existence)
    }

    /// Returns `true` if nothing speaks against an answer.
    pub fn may_exist(&self) -> bool {
        self.records.iter().any(|record| matches!(record.ended, Ended::MayExist))
    }

    /// Returns `true` if it is open whether an answer exists, or whether it is the only one. An answer without a bound
    /// leaves it open if its conditions hold, or if the stiffness is known to be singular; the bound itself does not
    /// see dofs without stiffness.
    pub fn is_doubtful(&self) -> bool {
        let failed = |record: &Record| matches!(&record.ended, Ended::Failed(error) if error.leaves_existence_open());
        let Some(best) = &self.best else { return self.records.iter().any(failed) };
        let certificate = &best.solution.certificate;
        if certificate.has_bound() {
            return certificate.loose_dofs > 0;
        }
        let is_singular = best.tried.is_some_and(|tried| tried.is_singular);
        self.is_unheld() || is_singular || certificate.conditions_hold(self.settings.goal().tolerance)
    }

    /// The tolerance to which the conditions of an answer must hold if its rows are to tell whether it is the only one.
    pub fn sure_tolerance(&self) -> f64 {
        self.settings.goal().tolerance.min(SURE_CONDITIONS)
    }
}
