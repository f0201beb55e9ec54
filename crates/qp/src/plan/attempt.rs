//! The words of a plan: attempts, their steps, and the conditions of both.

use std::borrow::Cow;

pub(crate) use crate::method::mprgp::Limits;
use crate::settings::{ByFactor, Method};

/// Iterations of the active-set loop after which its start counts as poor.
pub(crate) const PATIENCE: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Means {
    Problem,
    Factor(WithFactor),
    /// A multigrid hierarchy of the stiffness, for MPRGP.
    Multigrid,
}

impl Means {
    /// The method; `None` if it is left to the rules, or if there is no method but one.
    pub fn method(self) -> Option<ByFactor> {
        if let Means::Factor(WithFactor { method, .. }) = self { method } else { None }
    }
}

/// A factor of the stiffness, and the method that works with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WithFactor {
    /// `None` if the rules choose it, once the pattern of the stiffness is analysed.
    pub method: Option<ByFactor>,
    /// The first of these that fits into memory and time is taken.
    pub arrangements: &'static [Arrangement],
}

impl WithFactor {
    /// The method and the arrangements by the rules.
    pub const BY_RULES: WithFactor = WithFactor { method: None, arrangements: &Arrangement::ALL };
}

/// The unknowns of a method with a factor, and the order of its elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrangement {
    /// The stiffness is condensed onto the contact dofs, if that pays.
    Condensed,
    /// All dofs, those of the rows last: the bound of the error takes less memory.
    RowsLast,
    /// All dofs in the order of the least work; one factor at a time if no more fit.
    AnyOrder,
}

impl Arrangement {
    pub const ALL: [Arrangement; 3] = [Arrangement::Condensed, Arrangement::RowsLast, Arrangement::AnyOrder];
    pub const ON_ALL_DOFS: [Arrangement; 2] = [Arrangement::RowsLast, Arrangement::AnyOrder];
}

/// What is done in an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// Each piece is solved by a ladder of its own.
    Pieces,
    /// The problem without its equalities is solved by a ladder of its own.
    Elimination,
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

/// What must have happened before an attempt, or a step of it, is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    Always,
    /// The attempt before was refused for lack of memory or time, or its sets cost more than the other way.
    Refused,
    /// The last method met a motion that no row stops, or a negative energy.
    Unheld,
    /// The last method did not settle.
    Unsettled,
    /// The same, and the program chose the method for a stiffness with all entries.
    UnsettledOnDense,
    /// The last step gave the best answer, and more may be gained.
    Improvable,
    /// No answer meets the goal.
    Short,
    /// The same, and multigrid was tried.
    ShortOfMultigrid,
    /// The same, and the last method did not settle.
    ShortOfUnsettled,
    /// The same, and the last attempt was a shortcut.
    ShortOfShortcut,
    /// The same, and the last attempt worked on fewer dofs than all.
    ShortOnCondensed,
    /// It is not known whether an answer exists.
    Doubtful,
    /// An answer exists, and none was found whose conditions hold.
    Exists,
    /// Existence was in doubt.
    WasDoubtful,
}

/// A step of an attempt, its condition and its reason.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rung {
    pub step: Step,
    pub when: When,
    pub because: &'static str,
}

const fn rung(step: Step, when: When, because: &'static str) -> Rung {
    Rung { step, when, because }
}

pub(super) const IN_PIECES: &[Rung] = &[rung(Step::Pieces, When::Always, "")];

pub(super) const BY_ELIMINATION: &[Rung] = &[rung(Step::Elimination, When::Always, "")];

const FREE_MOTION: Rung = rung(
    Step::Existence,
    When::Unheld,
    "a motion without energy that no row stops leaves open whether there is an answer",
);

pub(super) const WITH_FACTOR: &[Rung] = &[
    rung(Step::Method, When::Always, ""),
    FREE_MOTION,
    rung(
        Step::InteriorPoint,
        When::UnsettledOnDense,
        "sets of a nearly singular K wander, and a step costs little more",
    ),
    rung(Step::Continuation, When::Unsettled, "the start was poor, if a few iterations do not settle"),
    rung(Step::Dual, When::Unsettled, "it is slow, and ends for equal, dependent and nearly parallel rows too"),
    rung(Step::Refinement, When::Improvable, "the answer for its residual has the digits that the factor has left"),
    rung(Step::Repair, When::Improvable, "the repair of its bound gives an answer too"),
    rung(Step::Dual, When::Short, "it starts without a set"),
    rung(Step::Refinement, When::Improvable, "the same for the answer of the dual method"),
    rung(Step::Repair, When::Improvable, "the same for the answer of the dual method"),
];

pub(super) const WITH_MULTIGRID: &[Rung] = &[rung(Step::Method, When::Always, ""), FREE_MOTION];

pub(super) const OF_EXISTENCE: &[Rung] = &[
    rung(Step::Existence, When::Doubtful, "without a bound it is open whether there is an answer"),
    rung(Step::Proximal, When::Exists, "the stiffness is singular"),
    rung(Step::Uniqueness, When::WasDoubtful, "the answer may not be the only one"),
];

/// The start of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum From {
    /// The start that the caller gave, or none.
    Given,
    /// The start that the caller gave, or the set that a few cycles of multigrid find: contact is everywhere, and a
    /// front of closed rows moves by one row of nodes with every set.
    Cycles,
    /// The best answer of the attempts so far.
    Best,
    Nothing,
}

/// One attempt: its means, its start, its limits, its condition, its reason, and the steps that may follow with the
/// same means.
#[derive(Clone, Debug)]
pub(crate) struct Attempt {
    pub means: Means,
    pub start: From,
    pub limits: Limits,
    pub when: When,
    pub because: Cow<'static, str>,
    pub steps: &'static [Rung],
}

impl Attempt {
    /// The method as it is named before its data are prepared.
    pub fn method(&self) -> Method {
        match self.means {
            Means::Problem => Method::Auto,
            Means::Factor(with) => with.method.map_or(Method::Auto, Method::from),
            Means::Multigrid => Method::Mprgp,
        }
    }
}

/// The method of an attempt, once its data are prepared, with its number of unknowns if they are fewer than all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tried {
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
    /// A method on all dofs that is no shortcut, without a factor.
    pub fn on_all_dofs(method: Method) -> Self {
        let (condensed_dofs, lost_pivot, [multiplications, set_seconds]) = (None, None, [0.0; 2]);
        let [is_shortcut, is_singular] = [false; 2];
        Tried { method, condensed_dofs, is_shortcut, lost_pivot, is_singular, multiplications, set_seconds }
    }

    /// The method and its unknowns in words, if the rules chose it.
    pub(super) fn in_words(&self) -> String {
        let on = match self.condensed_dofs {
            Some(dofs) => format!("condensed to {dofs} dofs"),
            None => "on all dofs".to_string(),
        };
        let (method, multiplications) = (self.method.name(), self.multiplications);
        format!("of such methods {method}, {on}, for {multiplications:.1e} multiplications of a factor")
    }
}

/// The place of a step in a ladder: its attempt, and its number there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub attempt: usize,
    pub rung: usize,
}

/// The next step, with the limits that the steps before leave for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Next {
    pub place: Place,
    pub start: From,
    pub limits: Limits,
}
