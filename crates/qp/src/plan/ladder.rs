//! The ladder: all attempts for a problem, in order, and the step that follows after what was found.

use std::borrow::Cow;
use std::sync::Arc;

use super::attempt::{
    ALWAYS, Attempt, OF_EXISTENCE, REFUSED, SHORT, SHORT_OF_MULTIGRID, SHORT_OF_SHORTCUT, SHORT_OF_UNSETTLED,
    SHORT_ON_CONDENSED, WITH_FACTOR, WITH_MULTIGRID,
};
use super::choice::Choice;
use super::history::{Answered, Ended, From, History, Means, Record, Step};
use super::layout::check_rank;
use crate::cost::{Estimate, is_everywhere, starts_near};
use crate::error::Result;
use crate::linear::Analysis;
use crate::method::interior_point::InteriorPoint;
use crate::method::mprgp::Limits;
use crate::problem::ContactProblem;
use crate::settings::{Condense, Method, Settings};
use crate::solution::Seconds;
use crate::transform::Pieces;

/// MPRGP ends at this share of the tolerance of the certificate, because the scales of the two differ.
const MARGIN: f64 = 0.1;

/// If an accuracy is given, MPRGP first ends at this share of the accuracy: forces are less accurate than the energy.
const FIRST: f64 = 0.1;

/// Refinements of an answer, one after the other: each gains as many digits as the factor has left.
const MOST_REFINEMENTS: usize = 6;

/// Repairs of an answer, one after the other: the second removes the rounding of the first.
const MOST_REPAIRS: usize = 8;

/// If the certificate is not met, MPRGP continues to this share of the residual that it reached.
const NEXT: f64 = 0.01;

/// If the bound exceeds the accuracy, MPRGP next aims at this share of the accuracy.
const AIM: f64 = 0.3;

/// A relative imbalance of forces below this is rounding.
const IMBALANCE_ROUNDING: f64 = 1e-15;

/// A piece has at least this number of unknowns: smaller parts are solved faster together.
const PIECE: usize = 2000;

/// What is taken out of a problem before all attempts, so that the rest is solved by a ladder of its own.
#[derive(Clone, Debug)]
pub enum Door {
    Equalities,
    Pieces(Arc<Pieces>),
}

#[derive(Clone, Debug)]
pub struct Ladder {
    /// The first has no steps if there is a door.
    pub attempts: Vec<Attempt>,
    pub door: Option<Door>,
    pub settings: Settings,
    /// The comparison of factor and multigrid, if the program chooses.
    pub choice: Option<(Estimate, Choice)>,
    /// `true` if the program chooses the method, and the stiffness has all entries.
    pub is_dense: bool,
    /// The reason for multigrid if a factor was refused before.
    pub refusal: Option<String>,
}

impl Ladder {
    /// The ladder for `problem`, if this number of gaps or loads shares the prepared data. It is whole if a start is
    /// given, or data are kept.
    pub fn of(problem: &ContactProblem, gaps: usize, is_whole: bool, settings: &Settings) -> Result<Self> {
        let mut ladder = Ladder {
            attempts: Vec::with_capacity(8),
            door: None,
            settings: settings.clone(),
            choice: None,
            is_dense: settings.method == Method::Auto && Analysis::is_dense_for(problem.stiffness()),
            refusal: None,
        };
        check_rank(problem)?;
        let equalities = problem.equalities().len();
        if equalities > 0 {
            let because = format!("{equalities} pair{} of rows leave no room", if equalities == 1 { "" } else { "s" });
            ladder.add(Attempt { steps: &[], ..ladder.attempt(Means::Problem, because) });
            ladder.door = Some(Door::Equalities);
        } else if !is_whole && let Some(pieces) = pieces_of(problem, settings) {
            let because = format!("nothing couples its {} pieces", pieces.count());
            ladder.add(Attempt { steps: &[], ..ladder.attempt(Means::Problem, because) });
            ladder.door = Some(Door::Pieces(Arc::new(pieces)));
        }
        let from = |near: bool| if near && !is_whole { From::Cycles } else { From::Given };
        match settings.method {
            Method::Auto => {
                let estimate = Estimate::of(problem).for_accuracy(settings.accuracy).of_many(gaps);
                let choice = estimate.choose(settings.memory.unwrap_or(f64::INFINITY))?;
                ladder.by_choice(&choice, from(estimate.starts_near));
                ladder.choice = Some((estimate, choice));
            }
            Method::Mprgp => ladder.add(ladder.attempt(Means::Multigrid, REQUESTED)),
            method => {
                let is_everywhere = !is_whole && method == Method::ActiveSet && is_everywhere(problem);
                let start = from(is_everywhere && starts_near(problem));
                ladder.with_factor(Attempt { start, ..ladder.by_factor(method, REQUESTED) });
            }
        }
        // Its steps have their own conditions, also for an answer that meets the goal.
        ladder.attempts.push(Attempt { steps: OF_EXISTENCE, ..ladder.attempt(Means::Problem, "") });
        Ok(ladder)
    }

    /// The same ladder under settings that change nothing but its limits; `None` if they change more.
    pub fn under(&self, settings: &Settings) -> Option<Self> {
        let of = |settings: &Settings| (settings.method, settings.condense, settings.memory);
        if of(settings) != of(&self.settings) {
            return None;
        }
        let mut ladder = Ladder { settings: settings.clone(), ..self.clone() };
        for attempt in &mut ladder.attempts {
            let Limits { tolerance, most_cycles, .. } = limits(settings);
            attempt.limits = Limits { tolerance, most_cycles, ..attempt.limits };
        }
        Some(ladder)
    }

    /// The same for a regular problem that the question of existence raises: only a free motion asks again.
    pub fn without_existence(mut self) -> Self {
        self.attempts.pop();
        self
    }

    /// The attempts of a choice between factor and multigrid.
    fn by_choice(&mut self, choice: &Choice, start: From) {
        let after = |ladder: &Self, method| {
            let because = "a factor may give the answer that the iteration does not";
            Attempt { start, when: SHORT_OF_MULTIGRID, ..ladder.by_factor(method, because) }
        };
        // The way stands before the colon.
        let because = |reason: &str| reason.split_once(": ").map_or(reason, |(_, because)| because).to_string();
        match choice {
            Choice::Factor { reason, most_seconds } => {
                let mut first = Attempt { start, ..self.by_factor(Method::Auto, because(reason)) };
                first.limits.most_seconds = *most_seconds;
                self.with_factor(first);
                let refused = self.attempt(Means::Multigrid, "it takes less memory, and begins sooner");
                self.add(Attempt { when: REFUSED, start: From::Best, ..refused });
                // The refusal was of a faster method, which takes more memory than one factor at a time.
                self.with_factor(after(self, Method::ActiveSet));
            }
            Choice::Multigrid { reason, most_cycles } => {
                let mut multigrid = self.attempt(Means::Multigrid, because(reason));
                multigrid.limits.worth = *most_cycles;
                self.add(multigrid);
                self.with_factor(after(self, Method::Auto));
            }
        }
    }

    /// The first attempt that needs more than the problem.
    pub fn first_with_data(&self) -> usize {
        self.attempts.iter().position(|attempt| attempt.means != Means::Problem).unwrap_or(0)
    }

    /// Adds an attempt; none but the first is made if an answer meets the goal.
    fn add(&mut self, attempt: Attempt) {
        let has_condition = self.attempts.is_empty() || !attempt.when.words.is_empty();
        let when = if has_condition { attempt.when } else { SHORT };
        self.attempts.push(Attempt { when, ..attempt });
    }

    /// An attempt by these means, from the start that was given.
    fn attempt(&self, means: Means, because: impl Into<Cow<'static, str>>) -> Attempt {
        let steps = if means == Means::Multigrid { WITH_MULTIGRID } else { WITH_FACTOR };
        let method = if means == Means::Multigrid { Method::Mprgp } else { Method::Auto };
        let (condense, start, when, limits) = (self.settings.condense, From::Given, ALWAYS, limits(&self.settings));
        Attempt { means, method, condense, start, limits, when, because: because.into(), steps }
    }

    /// An attempt with a factor, by this method.
    fn by_factor(&self, method: Method, because: impl Into<Cow<'static, str>>) -> Attempt {
        Attempt { method, ..self.attempt(Means::Factor, because) }
    }

    /// Adds the attempts with a factor: the `first`; after a shortcut the active set; after a condensation on all dofs.
    fn with_factor(&mut self, first: Attempt) {
        let method = first.method;
        self.add(first);
        if matches!(method, Method::Qp(InteriorPoint { polish: false, .. })) {
            let polished = self.by_factor(Method::qp(), "the interior-point method did not reach its tolerance");
            self.add(Attempt { when: SHORT_OF_UNSETTLED, ..polished });
        }
        if method == Method::Auto {
            let exact = self.by_factor(Method::ActiveSet, "the active set leaves out no digit");
            self.add(Attempt { when: SHORT_OF_SHORTCUT, start: From::Nothing, ..exact });
        }
        if self.settings.condense == Condense::Auto {
            let because = "condensing loses digits if the contact boundary feels little of the stiffness of the body";
            let method = if method == Method::Auto { Method::ActiveSet } else { method };
            let (condense, when) = (Condense::Never, SHORT_ON_CONDENSED);
            self.add(Attempt { condense, when, start: From::Best, ..self.by_factor(method, because) });
        }
    }

    /// Nothing was tried yet, under these settings.
    pub fn history(&self, settings: &Settings) -> History {
        let fits = |bytes: f64| bytes.is_finite() && bytes <= self.settings.memory.unwrap_or(f64::INFINITY);
        let levels = self.choice.as_ref().filter(|(estimate, _)| fits(estimate.multigrid_bytes));
        let hierarchy_seconds = levels.map(|(estimate, _)| estimate.hierarchy_seconds);
        // Most runs end with their first step.
        let (settings, is_dense, records) = (settings.clone(), self.is_dense, Vec::with_capacity(1));
        let (first, is_eliminated) = (self.first_with_data(), matches!(self.door, Some(Door::Equalities)));
        History { settings, is_dense, hierarchy_seconds, is_eliminated, first, records, best: None }
    }

    /// The next step; `None` if nothing is to be gained or left, an error is decided, or the watch is over.
    pub fn next(&self, history: &History) -> Option<Record> {
        let Some(last) = history.records.last() else { return Some(self.step_at(history.first, 0)) };
        if matches!(last.ended, Ended::Decided(_) | Ended::Prepared) || history.settings.watch.is_over() {
            return None;
        }
        if let Some(limits) = self.again(last, history) {
            return Some(Record { start: From::Best, limits, ..self.step_at(last.attempt, last.rung) });
        }
        let has_ended = matches!((&last.ended, last.step), (Ended::Refused(_) | Ended::Failed(_), Step::Method));
        // A method that fails leaves its data to the next steps.
        let is_prepared = (!has_ended || last.tried.is_some()) && !history.is_outrun();
        let rest = if is_prepared { self.attempts[last.attempt].steps.len() } else { 0 };
        let here = (last.rung + 1..rest).map(|rung| (last.attempt, rung));
        let later = (last.attempt + 1..self.attempts.len())
            .filter(|&attempt| (self.attempts[attempt].when.holds)(history))
            .flat_map(|attempt| (0..self.attempts[attempt].steps.len()).map(move |rung| (attempt, rung)));
        let is_due = |&(attempt, rung): &(usize, usize)| (self.attempts[attempt].steps[rung].when.holds)(history);
        let (attempt, rung) = here.chain(later).find(is_due)?;
        let mut next = self.step_at(attempt, rung);
        if rung > 0 {
            next.start = From::Best;
            next.limits.most_seconds -= history.spent();
        }
        Some(next)
    }

    /// A step of an attempt that begins; at the door it is that of the first.
    pub fn step_at(&self, attempt: usize, rung: usize) -> Record {
        let Attempt { means, start, limits, steps, .. } = self.attempts[attempt];
        let step = steps.get(rung).map_or(Step::Method, |rung| rung.step);
        let (tried, ended, stages, answer) = (None, Ended::Empty, Seconds::default(), None);
        Record { attempt, rung, means, step, start, limits, tried, ended, seconds: 0.0, stages, answer }
    }

    /// The limits of the last step if it is made again.
    fn again(&self, last: &Record, history: &History) -> Option<Limits> {
        let Ended::Answered(answered) = &last.ended else { return None };
        let is_same = |record: &&Record| (record.attempt, record.rung) == (last.attempt, last.rung);
        let in_a_row = history.records.iter().rev().take_while(is_same).count();
        let asks = history.certificate()?.asks_for_more(history.settings.goal());
        match last.step {
            Step::Refinement => (answered.gains && asks && in_a_row < MOST_REFINEMENTS).then_some(last.limits),
            Step::Repair => (answered.is_best && asks && in_a_row < MOST_REPAIRS).then_some(last.limits),
            Step::Method if last.means == Means::Multigrid => tighter(last, answered, history),
            _ => None,
        }
    }
}

const REQUESTED: &str = "it was requested";

/// The limits with which MPRGP goes on from a settled answer that falls short.
fn tighter(last: &Record, answered: &Answered, history: &History) -> Option<Limits> {
    let bound = history.certificate()?.energy_error_bound;
    let share = match history.settings.accuracy {
        Some(accuracy) if bound.is_finite() && bound > 0.0 => (AIM * accuracy / bound).clamp(NEXT, AIM),
        _ => NEXT,
    };
    let tolerance = last.limits.tolerance * share;
    let most_cycles = history.settings.max_iterations.saturating_sub(answered.iterations);
    let goes_on = answered.is_settled && !history.is_certified() && tolerance >= IMBALANCE_ROUNDING && most_cycles > 0;
    goes_on.then_some(Limits { tolerance, most_cycles, ..last.limits })
}

/// The first limits of MPRGP.
fn limits(settings: &Settings) -> Limits {
    let tolerance = settings.accuracy.map_or(MARGIN * settings.goal().tolerance, |accuracy| FIRST * accuracy);
    Limits { most_cycles: settings.max_iterations, ..Limits::to(tolerance) }
}

/// The pieces to solve separately; `None` if the problem is solved as one.
fn pieces_of(problem: &ContactProblem, settings: &Settings) -> Option<Pieces> {
    let is_free = matches!(settings.method, Method::Auto | Method::ActiveSet);
    let parts = problem.parts();
    if !is_free || parts.count() == 1 || problem.dofs() < 2 * PIECE || !parts.are_apart(problem.stiffness()) {
        return None;
    }
    let (mut of_part, mut count, mut dofs) = (Vec::with_capacity(parts.count()), 0, 0);
    let mut left = problem.dofs();
    for of_this in parts.sums(|_| 1.0) {
        of_part.push(count);
        (dofs, left) = (dofs + of_this as usize, left - of_this as usize);
        if dofs >= PIECE && left >= PIECE {
            (count, dofs) = (count + 1, 0);
        }
    }
    (count > 0).then(|| Pieces::of(problem, &of_part, count + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chains of springs, of these lengths.
    fn chains(lengths: &[usize]) -> ContactProblem {
        let mut entries = Vec::new();
        let mut first = 0;
        for length in lengths {
            entries.extend((first..first + length).map(|dof| (dof, dof, 2.0)));
            entries.extend((first + 1..first + length).map(|dof| (dof, dof - 1, -1.0)));
            first += length;
        }
        ContactProblem::of_entries(&entries, &vec![1.0; first], &[(0, 0, 1.0)], &[1.0])
    }

    #[test]
    fn small_parts_make_a_piece_together_and_no_part_is_cut() {
        let count = |lengths: &[usize], method| {
            let pieces = pieces_of(&chains(lengths), &Settings::with_method(method));
            pieces.map_or(1, |pieces| pieces.count())
        };
        assert_eq!(count(&[PIECE, PIECE, 1], Method::Auto), 2, "the last is too small for itself");
        assert_eq!(count(&[10 * PIECE], Method::Auto), 1);
        assert_eq!(count(&[3 * PIECE, 10], Method::Auto), 1);
        assert_eq!(count(&[10; 1000], Method::ActiveSet), 10_000 / PIECE);
        assert_eq!(count(&[PIECE, PIECE], Method::Mprgp), 1, "a hierarchy keeps parts apart by itself");
    }
}
