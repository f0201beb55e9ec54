//! The ladder: all attempts for a problem, in order.

use std::borrow::Cow;
use std::sync::Arc;

use super::attempt::{
    Arrangement, Attempt, BY_ELIMINATION, From, IN_PIECES, Limits, Means, OF_EXISTENCE, WITH_FACTOR, WITH_MULTIGRID,
    When, WithFactor,
};
use super::choice::Choice;
use super::nearly_linear;
use crate::cost::{Estimate, starts_near};
use crate::error::Error;
use crate::linear::Analysis;
use crate::method::interior_point::InteriorPoint;
use crate::problem::ContactProblem;
use crate::settings::{ByFactor, Condense, Method, Settings};
use crate::transform::Pieces;

/// MPRGP ends at this share of the tolerance of the certificate, because the scales of the two differ.
const MARGIN: f64 = 0.1;

/// If an accuracy is given, MPRGP first ends at this share of the accuracy: forces are less accurate than the energy.
const FIRST: f64 = 0.1;

/// A piece has at least this number of unknowns, if all parts together have twice as many: smaller parts are solved
/// faster together.
const PIECE: usize = 2000;

/// What the caller of a ladder knows and keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known {
    /// Number of gaps or loads that share the prepared data.
    pub gaps: usize,
    /// `true` if the problem stays in one piece, because a start is given, or because its data are kept.
    pub is_whole: bool,
}

/// Everything that may be tried, in order.
#[derive(Clone, Debug)]
pub(crate) struct Ladder {
    pub attempts: Vec<Attempt>,
    /// The pieces of the first attempt, if the problem is solved in pieces.
    pub pieces: Option<Arc<Pieces>>,
    pub(super) settings: Settings,
    /// The comparison of factor and multigrid, if the program chooses.
    pub(super) choice: Option<(Estimate, Choice)>,
    /// `true` if the program chooses the method, and the stiffness has all entries.
    pub(super) is_dense: bool,
    /// The reason for multigrid if a factor was refused before.
    pub(super) refusal: Option<String>,
}

impl Ladder {
    /// The ladder for `problem`.
    pub fn of(problem: &ContactProblem, known: Known, settings: &Settings) -> Result<Self, Error> {
        let mut ladder = Ladder {
            attempts: Vec::with_capacity(8),
            pieces: None,
            settings: settings.clone(),
            choice: None,
            is_dense: settings.method == Method::Auto && Analysis::is_dense_for(problem.stiffness()),
            refusal: None,
        };
        nearly_linear::check(problem)?;
        let equalities = problem.equalities().len();
        if equalities > 0 {
            let because = format!("{equalities} pair{} of rows leave no room", if equalities == 1 { "" } else { "s" });
            ladder.add(Attempt { steps: BY_ELIMINATION, ..ladder.attempt(Means::Problem, because) });
        } else if !known.is_whole
            && let Some(pieces) = pieces_of(problem, settings)
        {
            let because = format!("nothing couples its {} pieces", pieces.count());
            ladder.add(Attempt { steps: IN_PIECES, ..ladder.attempt(Means::Problem, because) });
            ladder.pieces = Some(Arc::new(pieces));
        }
        let near = !known.is_whole && starts_by_multigrid(problem, settings);
        let start = if near { From::Cycles } else { From::Given };
        let by_name =
            |ladder: &Self, method| Attempt { start, ..ladder.attempt(ladder.factor(Some(method)), REQUESTED) };
        match settings.method {
            Method::Auto => {
                let estimate = Estimate::of(problem).for_accuracy(settings.accuracy).of_many(known.gaps);
                let choice = estimate.choose(settings.memory.unwrap_or(f64::INFINITY))?;
                ladder.by_choice(&choice, start);
                ladder.choice = Some((estimate, choice));
            }
            Method::Mprgp => ladder.add(ladder.attempt(Means::Multigrid, REQUESTED)),
            Method::ActiveSet => ladder.with_factor(by_name(&ladder, ByFactor::ActiveSet)),
            Method::Qp(options) => ladder.with_factor(by_name(&ladder, ByFactor::Qp(options))),
            Method::Penalty(options) => ladder.with_factor(by_name(&ladder, ByFactor::Penalty(options))),
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

    /// The same for a problem that the question of existence gives rise to: only a motion that no row stops raises it
    /// again, and the stiffness of such a problem is regular.
    pub fn without_existence(mut self) -> Self {
        self.attempts.retain(|attempt| attempt.steps[0].step != OF_EXISTENCE[0].step);
        self
    }

    /// The attempts of a choice between factor and multigrid.
    fn by_choice(&mut self, choice: &Choice, start: From) {
        let after = |ladder: &Self, method| {
            let because = "a factor may give the answer that the iteration does not";
            Attempt { start, when: When::ShortOfMultigrid, ..ladder.attempt(ladder.factor(method), because) }
        };
        // The way stands before the colon.
        let because = |reason: &str| reason.split_once(": ").map_or(reason, |(_, because)| because).to_string();
        match choice {
            Choice::Factor { reason, most_seconds } => {
                let mut first = Attempt { start, ..self.attempt(self.factor(None), because(reason)) };
                first.limits.most_seconds = *most_seconds;
                self.with_factor(first);
                let refused = self.attempt(Means::Multigrid, "it takes less memory, and begins sooner");
                self.add(Attempt { when: When::Refused, start: From::Best, ..refused });
                // The refusal was of a faster method, which takes more memory than one factor at a time.
                self.with_factor(after(self, Some(ByFactor::ActiveSet)));
            }
            Choice::Multigrid { reason, most_cycles } => {
                let mut multigrid = self.attempt(Means::Multigrid, because(reason));
                multigrid.limits.worth = *most_cycles;
                self.add(multigrid);
                self.with_factor(after(self, None));
            }
        }
    }

    /// The first attempt that needs more than the problem.
    pub fn first_with_data(&self) -> usize {
        self.attempts.iter().position(|attempt| attempt.means != Means::Problem).unwrap_or(0)
    }

    /// Adds an attempt; none but the first is made if an answer meets the goal.
    fn add(&mut self, attempt: Attempt) {
        let when = if attempt.when == When::Always && !self.attempts.is_empty() { When::Short } else { attempt.when };
        self.attempts.push(Attempt { when, ..attempt });
    }

    /// A factor under the settings as they were given, with this method or that of the rules.
    fn factor(&self, method: Option<ByFactor>) -> Means {
        let arrangements: &[Arrangement] = match self.settings.condense {
            Condense::Auto => &Arrangement::ALL,
            Condense::Never => &Arrangement::ON_ALL_DOFS,
        };
        Means::Factor(WithFactor { method, arrangements })
    }

    /// An attempt by these means, from the start that was given.
    fn attempt(&self, means: Means, because: impl Into<Cow<'static, str>>) -> Attempt {
        let steps = if means == Means::Multigrid { WITH_MULTIGRID } else { WITH_FACTOR };
        let (start, when, limits) = (From::Given, When::Always, limits(&self.settings));
        Attempt { means, start, limits, when, because: because.into(), steps }
    }

    /// Adds the attempts with a factor: the `first`; after a shortcut the active set; after a condensation on all dofs.
    fn with_factor(&mut self, first: Attempt) {
        let means = first.means;
        self.add(first);
        let Means::Factor(with) = means else { return };
        if matches!(with.method, Some(ByFactor::Qp(InteriorPoint { polish: false, .. }))) {
            let because = "the interior-point method did not reach its tolerance";
            let polished = self.attempt(self.factor(Some(ByFactor::Qp(InteriorPoint::DEFAULT))), because);
            self.add(Attempt { when: When::ShortOfUnsettled, ..polished });
        }
        let method = Some(with.method.unwrap_or(ByFactor::ActiveSet));
        let exact = WithFactor { method, ..with };
        if with.method.is_none() {
            let because = "the active set leaves out no digit";
            let exact = self.attempt(Means::Factor(exact), because);
            self.add(Attempt { when: When::ShortOfShortcut, start: From::Nothing, ..exact });
        }
        if with.arrangements.contains(&Arrangement::Condensed) {
            let because = "condensing loses digits if the contact boundary feels little of the stiffness of the body";
            let whole = WithFactor { arrangements: &Arrangement::ON_ALL_DOFS, ..exact };
            let whole = self.attempt(Means::Factor(whole), because);
            self.add(Attempt { when: When::ShortOnCondensed, start: From::Best, ..whole });
        }
    }
}

const REQUESTED: &str = "it was requested";

/// The first limits of MPRGP.
fn limits(settings: &Settings) -> Limits {
    let tolerance = settings.accuracy.map_or(MARGIN * settings.goal().tolerance, |accuracy| FIRST * accuracy);
    Limits { most_cycles: settings.max_iterations, ..Limits::to(tolerance) }
}

/// Returns `true` if the direct path starts from a few cycles of multigrid.
fn starts_by_multigrid(problem: &ContactProblem, settings: &Settings) -> bool {
    matches!(settings.method, Method::Auto | Method::ActiveSet) && starts_near(problem)
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
