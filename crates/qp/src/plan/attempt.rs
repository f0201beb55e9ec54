//! The words of a plan: attempts, their steps, and the conditions of both.

use std::borrow::Cow;

use super::history::{Ended, From, History, Means, Record, Step};
use crate::method::interior_point::InteriorPoint;
use crate::method::mprgp::Limits;
use crate::settings::{Condense, Method, Settings};
use crate::solution::Certificate;

/// Iterations of the active-set loop after which its start counts as poor.
pub const PATIENCE: usize = 16;

/// The unknowns of a method with a factor, and the order of its elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// The stiffness is condensed onto the contact dofs, if that pays.
    Condensed,
    /// All dofs, those of the rows last: the bound of the error takes less memory.
    RowsLast,
    /// All dofs in the order of the least work; one factor at a time if no more fit.
    AnyOrder,
}

impl Arrangement {
    /// The arrangements under a rule: the first of these that fits into memory and time is taken.
    pub fn under(condense: Condense) -> &'static [Arrangement] {
        match condense {
            Condense::Auto => &[Arrangement::Condensed, Arrangement::RowsLast, Arrangement::AnyOrder],
            Condense::Never => &[Arrangement::RowsLast, Arrangement::AnyOrder],
        }
    }
}

/// What must have happened before an attempt, or a step of it, is made; with the same in words.
#[derive(Clone, Copy, Debug)]
pub struct When {
    pub words: &'static str,
    pub holds: fn(&History) -> bool,
}

const fn when(words: &'static str, holds: fn(&History) -> bool) -> When {
    When { words, holds }
}

pub const ALWAYS: When = when("", |_| true);

/// An attempt after others; an elimination has no refinement of its own.
pub const SHORT: When = when("if the answer falls short", |past| past.falls_short() || past.is_unbalanced());

pub const REFUSED: When =
    when("if memory or time do not allow the attempt before, or its sets cost too much", History::is_refused);

pub const SHORT_OF_MULTIGRID: When = when("if multigrid falls short", |past| {
    past.falls_short() && past.records.iter().any(|record| record.means == Means::Multigrid)
});

pub const SHORT_OF_UNSETTLED: When =
    when("if the method does not settle and its answer falls short", |past| past.falls_short() && past.is_unsettled());

pub const SHORT_OF_SHORTCUT: When = when("if a faster method falls short", |past| {
    past.falls_short() && past.last_tried().is_some_and(|tried| tried.is_shortcut)
});

/// An answer whose conditions hold, with a bound within rounding, can only miss an accuracy beyond that.
pub const SHORT_ON_CONDENSED: When = when("if the answer on condensed dofs falls short", |past| {
    let is_condensed = past.last_tried().is_some_and(|tried| tried.condensed_dofs.is_some());
    let is_exact =
        |best: &Certificate| best.conditions_hold(past.settings.goal().tolerance) && best.energy_error_excess == 0.0;
    past.falls_short() && is_condensed && past.may_replace() && !past.certificate().is_some_and(is_exact)
});

/// A step of an attempt, its condition and its reason.
#[derive(Clone, Copy, Debug)]
pub struct Rung {
    pub step: Step,
    pub when: When,
    pub because: &'static str,
}

const fn rung(step: Step, when: When, because: &'static str) -> Rung {
    Rung { step, when, because }
}

const FREE_MOTION: Rung = rung(
    Step::Existence,
    when("if the method meets a motion that nothing stops", |past| {
        past.falls_short() && past.is_unheld() && !past.was_in_doubt()
    }),
    "a motion without energy that no row stops leaves open whether there is an answer",
);

const REFINABLE: When = when("if the answer falls short", |past| past.may_improve(Record::is_best));

/// A repair follows a refinement also if that gained nothing.
const REPAIRABLE: When = when("if the answer falls short", |past| {
    past.may_improve(|record| match record.ended {
        Ended::Answered(_) | Ended::Empty if record.step == Step::Refinement => true,
        _ => record.is_best(),
    })
});

pub const WITH_FACTOR: &[Rung] = &[
    rung(Step::Method, ALWAYS, ""),
    FREE_MOTION,
    rung(
        Step::InteriorPoint,
        when("if no set is settled, and the stiffness is dense", |past| {
            past.falls_short() && past.is_slow() && past.wanders_by(past.method())
        }),
        "sets of a nearly singular K wander, and a step costs little more",
    ),
    rung(
        Step::Continuation,
        when("if no set is settled", |past| {
            let is_by_sets = match past.method() {
                Method::Qp(InteriorPoint { polish, .. }) => polish,
                method => matches!(method, Method::Auto | Method::ActiveSet),
            };
            let has_patience = past.settings.max_iterations > PATIENCE;
            past.falls_short() && past.is_slow() && is_by_sets && has_patience
        }),
        "the start was poor, if a few iterations do not settle",
    ),
    rung(
        Step::Dual,
        when("if no set is settled", |past| {
            past.falls_short() && past.is_unsettled() && past.method().allows_last_resort(f64::INFINITY)
        }),
        "it is slow, and ends for equal, dependent and nearly parallel rows too",
    ),
    rung(Step::Refinement, REFINABLE, "the answer for its residual has the digits that the factor has left"),
    rung(Step::Repair, REPAIRABLE, "the repair of its bound gives an answer too"),
    rung(
        Step::Dual,
        when("if the answer falls short", |past| {
            let was_made = past.in_attempt().any(|record| record.step == Step::Dual);
            past.falls_short() && past.may_replace() && !was_made
        }),
        "it starts without a set",
    ),
    rung(Step::Refinement, REFINABLE, "the same for the answer of the dual method"),
    rung(Step::Repair, REPAIRABLE, "the same for the answer of the dual method"),
];

pub const WITH_MULTIGRID: &[Rung] = &[rung(Step::Method, ALWAYS, ""), FREE_MOTION];

pub const OF_EXISTENCE: &[Rung] = &[
    rung(
        Step::Existence,
        when("if an answer has no bound", |past| !past.was_in_doubt() && past.is_doubtful()),
        "without a bound it is open whether there is an answer",
    ),
    rung(
        Step::Proximal,
        when("if there is an answer, and none was found", |past| {
            let holds = |best: &Certificate| best.conditions_hold(past.sure_tolerance());
            past.may_exist() && !past.certificate().is_some_and(holds) && past.may_replace()
        }),
        "the stiffness is singular",
    ),
    rung(
        Step::Uniqueness,
        when("if that was open", |past| {
            let is_sure = |best: &Certificate| best.has_bound() && best.loose_dofs == 0;
            past.may_exist() && !past.certificate().is_some_and(is_sure)
        }),
        "the answer may not be the only one",
    ),
];

/// One attempt, with its condition, its reason, and the steps that may follow with the same means.
#[derive(Clone, Debug)]
pub struct Attempt {
    pub means: Means,
    /// [`Method::Auto`] if the rules choose it, once the pattern of the stiffness is analysed.
    pub method: Method,
    pub condense: Condense,
    pub start: From,
    pub limits: Limits,
    pub when: When,
    pub because: Cow<'static, str>,
    pub steps: &'static [Rung],
}

impl Attempt {
    /// The settings of a solve, with the method of the attempt.
    pub fn settings(&self, settings: &Settings) -> Settings {
        Settings { method: self.method, condense: self.condense, ..settings.clone() }
    }
}
