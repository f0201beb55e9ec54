//! The ladder: all attempts for a problem, in order.

use std::borrow::Cow;
use std::sync::Arc;

use super::attempt::{Attempt, Basis, From, IN_PIECES, Limits, OF_EXISTENCE, WITH_FACTOR, WITH_MULTIGRID, When};
use super::choice::Choice;
use super::pieces::pieces_of;
use crate::error::Error;
use crate::qp::cost::{Estimate, starts_near};
use crate::qp::method::interior_point::InteriorPoint;
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{Condense, Method, Precision, Settings};
use crate::qp::transform::Pieces;

/// MPRGP ends at this share of the tolerance of the certificate, because the scales of the two differ.
const MARGIN: f64 = 0.1;

/// If an accuracy is given, MPRGP first ends at this share of the accuracy: forces are less accurate than the energy.
const FIRST: f64 = 0.1;

/// What the caller of a ladder knows and keeps.
#[derive(Clone, Copy, Debug)]
pub(in crate::qp) struct Known {
    /// Number of gaps or loads that share the prepared data.
    pub gaps: usize,
    /// `true` if the problem stays in one piece, because a start is given, or because its data are kept.
    pub is_whole: bool,
}

/// Everything that may be tried, in order.
#[derive(Clone, Debug)]
pub(in crate::qp) struct Ladder {
    pub attempts: Vec<Attempt>,
    /// The pieces of the first attempt, if the problem is solved in pieces.
    pub pieces: Option<Arc<Pieces>>,
    pub(super) settings: Settings,
    /// The comparison of factor and multigrid, if the program chooses.
    pub(super) choice: Option<(Estimate, Choice)>,
    /// The reason for multigrid if a factor was refused before.
    pub(super) refusal: Option<String>,
}

impl Ladder {
    /// The ladder for `problem`.
    ///
    /// # Errors
    /// [`Error::NoRoom`] if neither a factor nor multigrid fits into the memory.
    pub fn of(problem: &ContactProblem, known: Known, settings: &Settings) -> Result<Self, Error> {
        let mut ladder = Ladder {
            attempts: Vec::with_capacity(8),
            pieces: None,
            settings: settings.clone(),
            choice: None,
            refusal: None,
        };
        if !known.is_whole
            && let Some(pieces) = pieces_of(problem, settings)
        {
            let because = format!("nothing couples its {} pieces", pieces.count());
            ladder.add(Attempt { steps: IN_PIECES, ..ladder.attempt(Basis::Problem, because) });
            ladder.pieces = Some(Arc::new(pieces));
        }
        let near = !known.is_whole && starts_by_multigrid(problem, settings);
        let start = if near { From::Cycles } else { From::Given };
        match settings.method {
            Method::Auto => {
                let estimate = Estimate::of(problem).of_many(known.gaps);
                let choice = estimate.choose(settings.memory.unwrap_or(f64::INFINITY))?;
                ladder.by_choice(&choice, start);
                ladder.choice = Some((estimate, choice));
            }
            Method::Mprgp => ladder.with_multigrid(ladder.attempt(Basis::Multigrid, REQUESTED)),
            _ => ladder.with_factor(Attempt { start, ..ladder.attempt(Basis::Factor, REQUESTED) }),
        }
        // Its steps have their own conditions, also for an answer that meets the goal.
        ladder.attempts.push(Attempt { steps: OF_EXISTENCE, ..ladder.attempt(Basis::Problem, "") });
        Ok(ladder)
    }

    /// The same ladder under settings that change nothing but its limits; `None` if they change more.
    pub fn under(&self, settings: &Settings) -> Option<Self> {
        let of = |settings: &Settings| (settings.method, settings.precision, settings.condense, settings.memory);
        if of(settings) != of(&self.settings) {
            return None;
        }
        let mut ladder = Ladder { settings: settings.clone(), ..self.clone() };
        for attempt in &mut ladder.attempts {
            attempt.limits = Limits { worth: attempt.limits.worth, ..limits(settings) };
        }
        Some(ladder)
    }

    /// The first attempt that works on these data.
    pub fn first_on(&self, basis: Basis) -> Option<usize> {
        self.attempts.iter().position(|attempt| attempt.basis == basis)
    }

    /// The attempts of a choice between factor and multigrid.
    fn by_choice(&mut self, choice: &Choice, start: From) {
        let after = |ladder: &Self, method| {
            let because = "a factor may give the answer that the iteration does not";
            Attempt { method, start, when: When::ShortOfMultigrid, ..ladder.attempt(Basis::Factor, because) }
        };
        // The way stands before the colon.
        let because = |reason: &str| reason.split_once(": ").map_or(reason, |(_, because)| because).to_string();
        match choice {
            Choice::Factor { reason } => {
                self.with_factor(Attempt { start, ..self.attempt(Basis::Factor, because(reason)) });
                let refused = self.attempt(Basis::Multigrid, "it takes less memory, and begins sooner");
                self.with_multigrid(Attempt { when: When::Refused, ..refused });
                // The refusal was of a faster method, which takes more memory than one factor at a time.
                self.with_factor(after(self, Method::ActiveSet));
            }
            Choice::Speed { reason, most_cycles } => {
                let mut multigrid = self.attempt(Basis::Multigrid, because(reason));
                multigrid.limits.worth = *most_cycles;
                self.with_multigrid(multigrid);
                self.with_factor(after(self, Method::Auto));
            }
            Choice::Room { reason } => {
                self.with_multigrid(self.attempt(Basis::Multigrid, because(reason)));
                self.with_factor(after(self, Method::Auto));
            }
        }
    }

    /// Adds an attempt; none but the first is made if an answer meets the goal.
    fn add(&mut self, attempt: Attempt) {
        let when = if attempt.when == When::Always && !self.attempts.is_empty() { When::Short } else { attempt.when };
        self.attempts.push(Attempt { when, ..attempt });
    }

    /// An attempt with the settings as they were given.
    fn attempt(&self, basis: Basis, because: impl Into<Cow<'static, str>>) -> Attempt {
        let Settings { method, precision, condense, .. } = self.settings;
        let limits = limits(&self.settings);
        let (start, when, because, steps) = (From::Given, When::Always, because.into(), WITH_FACTOR);
        Attempt { basis, method, precision, condense, start, limits, when, because, steps }
    }

    /// Adds the attempt without a factor.
    fn with_multigrid(&mut self, first: Attempt) {
        self.add(Attempt { method: Method::Mprgp, steps: WITH_MULTIGRID, ..first });
    }

    /// Adds the attempts with a factor: the `first`; after a shortcut in double precision; after a condensation on all dofs.
    fn with_factor(&mut self, first: Attempt) {
        let Attempt { method, condense, precision, .. } = first;
        self.add(first);
        let exact = if method == Method::Auto { Method::ActiveSet } else { method };
        let double = |ladder: &Self, when, because: &'static str| {
            let (method, precision) = (exact, Precision::Double);
            Attempt { method, precision, when, ..ladder.attempt(Basis::Factor, because) }
        };
        if matches!(method, Method::Qp(InteriorPoint { polish: false, .. })) {
            let because = "the interior-point method did not reach its tolerance";
            let attempt = Attempt { when: When::ShortOfUnsettled, ..self.attempt(Basis::Factor, because) };
            self.add(Attempt { method: Method::qp(), ..attempt });
        }
        if method == Method::Auto || precision == Precision::Mixed {
            let because = "the rules prefer speed; the active set in double precision leaves out no digit";
            let attempt = double(self, When::ShortOfShortcut, because);
            self.add(Attempt { start: From::Nothing, ..attempt });
        }
        if condense == Condense::Auto {
            let because = "condensing loses digits if the contact boundary feels little of the stiffness of the body";
            let attempt = double(self, When::ShortOnCondensed, because);
            self.add(Attempt { condense: Condense::Never, start: From::Best, ..attempt });
        }
    }
}

const REQUESTED: &str = "it was requested";

/// The first limits of MPRGP.
fn limits(settings: &Settings) -> Limits {
    let tolerance = settings.accuracy.map_or(MARGIN * settings.goal().tolerance, |accuracy| FIRST * accuracy);
    Limits { tolerance, most_cycles: settings.max_iterations, worth: usize::MAX }
}

/// Returns `true` if the direct path starts from a few cycles of multigrid.
fn starts_by_multigrid(problem: &ContactProblem, settings: &Settings) -> bool {
    matches!(settings.method, Method::Auto | Method::ActiveSet) && starts_near(problem)
}
