//! All decisions of a solve. [`Ladder::of`] says what will be tried, in order, and why, before anything is solved;
//! [`Ladder::next`] says what follows after what was found. `run` carries it out and decides nothing.
//!
//! ```text
//! elimination   pairs of rows that are equalities eliminated, the rest by a ladder of its own
//! pieces        uncoupled parts, each by a ladder of its own
//! with a factor method -> existence, if it met a free motion -> continuation, if unsettled -> dual, if unsettled
//!                 -> refinement and repair, while they gain -> dual, if it falls short -> refinement and repair
//!               the active set after a shortcut; the same on all dofs after a condensation
//! multigrid     MPRGP -> MPRGP to a smaller tolerance, while it settles
//! at the end    existence, if that is in doubt -> proximal steps, if there is an answer -> uniqueness
//! ```
//!
//! [`Method::Auto`] chooses between factor and multigrid by the estimates of `cost` (`choice`); the other one follows
//! if the first is refused or falls short. The layout of a factor (`layout`), and the method on it, are chosen once its
//! pattern is analysed.

mod attempt;
mod choice;
mod history;
mod ladder;
mod layout;

pub use attempt::{Attempt, PATIENCE};
pub use choice::is_bounded_by_factor;
pub use history::{Answered, Best, Ended, From, History, Means, Record, Step, Tried};
pub use ladder::{Door, Ladder};
pub use layout::Layout;

use std::fmt;

use attempt::{Arrangement, Rung};
use choice::Choice;

use crate::error::{Error, Result};
use crate::problem::ContactProblem;
use crate::settings::{Condense, Settings};
use crate::solution::Why;
use crate::transform::{RowSelection, Scaling};

impl Ladder {
    /// The ways that were compared before, and the decision; with the method that gave the best answer.
    pub fn why(&self, history: &History, best: &Best) -> Why {
        let Some((estimate, choice)) = &self.choice else {
            let chosen = self.settings.method.name().to_string();
            let reason = format!("by {chosen}: {}", self.attempts[self.first_with_data()].because);
            return Why { chosen, reason, considered: Vec::new() };
        };
        let why = estimate.why(choice);
        let then = match self.attempts[best.attempt].means {
            Means::Problem => None,
            Means::Factor => best.tried.as_ref().map(Tried::in_words),
            Means::Multigrid => self.without_factor(history).map(|reason| format!("in the end {reason}")),
        };
        let reason = then.map_or_else(|| why.reason.clone(), |then| format!("{}; {then}", why.reason));
        Why { reason, ..why }
    }

    /// The reason why no factor was taken, if the program decided that and the best answer has none; otherwise empty.
    pub fn reason(&self, history: &History, best: &Best) -> String {
        match &self.choice {
            Some((estimate, choice)) if self.attempts[best.attempt].means == Means::Multigrid => {
                self.without_factor(history).unwrap_or_else(|| estimate.why(choice).reason)
            }
            _ => String::new(),
        }
    }

    /// The ladder after the refusals of some data, which are not tried again.
    pub fn after_refusals(self, history: &History) -> Self {
        Ladder { refusal: self.without_factor(history), ..self }
    }

    /// The reason for multigrid after a factor was refused.
    fn without_factor(&self, history: &History) -> Option<String> {
        let (estimate, choice) = self.choice.as_ref()?;
        let refused = history.records.iter().find_map(|record| match &record.ended {
            Ended::Refused(Error::TooLarge { bytes, allowed, .. }) => Some(estimate.less_than_factor(*bytes, *allowed)),
            Ended::Refused(Error::OutOfTime { needed, time }) => Some(format!(
                "by multigrid: a factorisation would take about {needed:.1e} s, but {time:.1e} s are left"
            )),
            Ended::Answered(answered) if !answered.is_settled && matches!(choice, Choice::Factor { .. }) => {
                Some("by multigrid: sets with a factor each cost more, and did not settle".to_string())
            }
            _ => None,
        });
        refused.or_else(|| self.refusal.clone())
    }

    /// The error that neither factor nor multigrid has room, if the program chose and a factor was refused last.
    pub fn no_room(&self, history: &History) -> Option<Error> {
        let (estimate, _) = self.choice.as_ref()?;
        let last = history.records.iter().rev().find(|record| record.step == Step::Method)?;
        let Ended::Refused(Error::TooLarge { bytes: factor, allowed, .. }) = last.ended else { return None };
        let is_of_multigrid = |record: &&Record| record.means == Means::Multigrid;
        let ended =
            history.records.iter().rev().find(is_of_multigrid).map(|record| record.shortfall(history.settings.goal()));
        Some(Error::NoRoom { factor, multigrid: estimate.multigrid_bytes, allowed, ended })
    }

    fn first_factor(&self) -> Option<(usize, &Attempt)> {
        self.attempts.iter().enumerate().find(|(_, attempt)| attempt.means == Means::Factor)
    }

    /// The ladder in words, with the layout of the first factor; only the pattern of the stiffness is analysed.
    pub fn in_words(&self, problem: &ContactProblem, settings: &Settings) -> Result<String> {
        let words = self.to_string();
        let Some((first, attempt)) = self.first_factor() else { return Ok(words) };
        let selection = RowSelection::of(problem);
        let scaling = Scaling::of(problem.stiffness(), &selection.contact(problem.contact()))?;
        let layout = match Layout::within(problem, &scaling, &attempt.settings(settings)) {
            Ok(layout) => layout.in_words(),
            Err(error) => error.to_string(),
        };
        Ok(format!("{words}The factor of {}: {layout}.\n", first + 1))
    }
}

impl Step {
    fn in_words(self) -> &'static str {
        match self {
            Step::Method => "the method",
            Step::InteriorPoint => "the active set again, from the set that the interior point reaches",
            Step::Continuation => "the active set again, from the set that a penalty ladder reaches",
            Step::Dual => "the dual active-set method",
            Step::Refinement => "refinement, as long as it gains",
            Step::Repair => "repair, as long as it gains",
            Step::Existence => "look whether the problem has an answer, from the problem alone",
            Step::Proximal => "steps with K + rho E in place of K",
            Step::Uniqueness => "look whether the answer is the only one",
        }
    }
}

impl Arrangement {
    fn in_words(self) -> &'static str {
        match self {
            Arrangement::Condensed => "condensed to the contact dofs, if that pays",
            Arrangement::RowsLast => "all dofs, those of the rows last",
            Arrangement::AnyOrder => "all dofs in the order of least work, one factor at a time if no more fit",
        }
    }
}

impl Attempt {
    fn in_words(&self, door: Option<&Door>) -> String {
        let method = self.method.name();
        match self.means {
            Means::Problem => {
                let words = match door.filter(|_| self.steps.is_empty()) {
                    Some(Door::Equalities) => "the equalities eliminated, and the rest by a plan of its own",
                    Some(Door::Pieces(_)) => "each piece by a plan of its own",
                    None => "existence and uniqueness of the answer",
                };
                return words.to_string();
            }
            Means::Multigrid => return format!("{method} with a multigrid hierarchy"),
            Means::Factor => {}
        }
        let on = match self.condense {
            Condense::Auto => "condensed to the contact dofs if that pays",
            Condense::Never => "on all dofs",
        };
        let start = match self.start {
            From::Given | From::Nothing => "",
            From::Cycles => ", from the set that a few cycles of multigrid find",
            From::Best => ", from the best set so far",
        };
        format!("{method} with a factor, {on}{start}")
    }
}

/// Two lines for each attempt, with its condition and its reason; equal steps are listed once.
impl fmt::Display for Ladder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut listed: Vec<(&[Rung], usize)> = Vec::new();
        for (place, attempt) in self.attempts.iter().enumerate() {
            let (number, condition) = (place + 1, attempt.when.words);
            let comma = if condition.is_empty() { "" } else { ", " };
            writeln!(f, "{number}. {}{comma}{condition}", attempt.in_words(self.door.as_ref()))?;
            if !attempt.because.is_empty() {
                writeln!(f, "   because {}", attempt.because)?;
            }
            if let Some((_, first)) = listed.iter().find(|listed| std::ptr::eq(listed.0, attempt.steps)) {
                writeln!(f, "   then the steps of {first}")?;
                continue;
            }
            listed.push((attempt.steps, number));
            for rung in attempt.steps.iter().filter(|rung| !rung.when.words.is_empty()) {
                writeln!(f, "   - {}: {} ({})", rung.when.words, rung.step.in_words(), rung.because)?;
            }
        }
        match self.first_factor() {
            Some((_, attempt)) => {
                let arrangements = Arrangement::under(attempt.condense).iter();
                let words: Vec<&str> = arrangements.map(|arrangement| arrangement.in_words()).collect();
                writeln!(f, "A factor has the first of these forms that memory and time allow: {}.", words.join("; "))
            }
            None => Ok(()),
        }
    }
}
