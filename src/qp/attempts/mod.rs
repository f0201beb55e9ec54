//! Tries one way after another until an answer is certified, and reports the ways that were tried.

mod pieces;

use std::time::Instant;

use super::cost::Estimate;
use super::engine::Prepared;
use super::judged::{in_time, judged, with_solution};
use super::plan::{Choice, Tried, by_name, pieces_of, safer, starts_by_multigrid};
use super::problem::ContactProblem;
use super::settings::{Method, Settings};
use crate::error::Error;
use crate::qp::method::Start;
use crate::solution::{Attempt, Seconds, Solution, Why};

/// As [`solved`], from a `start` for the whole problem, which is then solved in one piece.
///
/// # Errors
/// As [`solved`].
#[cfg(feature = "cli")]
pub(super) fn solved_from(start: Start, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    let settings = &settings.started()?;
    if start.is_unknown() { solved(problem, settings) } else { in_one_piece_from(start, problem, settings) }
}

/// The ending of the ways that are tried, without a recheck.
///
/// # Errors
/// As [`solve`](super::solve()); a claim about the problem is not rechecked.
pub(super) fn solved(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    let settings = &settings.started()?;
    let Some(pieces) = pieces_of(problem, settings) else { return in_one_piece(problem, settings) };
    let clock = Instant::now();
    // A mode that nothing stops is rechecked like any other; every other ending of a piece is reported in terms of the whole.
    let fell_short = match pieces::solved(problem, &pieces, settings, in_one_piece) {
        Ok(solution) => match judged(solution, settings.goal()) {
            Err(error) if !settings.watch.is_over() => error,
            decided => return decided,
        },
        Err(error @ (Error::Unbounded { .. } | Error::UnderHeld { .. } | Error::Interrupted)) => return Err(error),
        Err(error) => error,
    };
    let attempt = Attempt {
        method: format!("{} pieces", pieces.count()),
        seconds: clock.elapsed().as_secs_f64(),
        reason: ending(&fell_short),
    };
    with_solution(in_one_piece(problem, settings), |mut solution| {
        solution.seconds.solve = clock.elapsed().as_secs_f64();
        solution.attempts.insert(0, attempt);
        solution
    })
}

/// The same, for all parts together.
fn in_one_piece(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    in_one_piece_from(Start::default(), problem, settings)
}

/// The same from a start.
fn in_one_piece_from(start: Start, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    let mut attempts = Attempts { clock: Instant::now(), start, made: Vec::new(), factor_seconds: 0.0 };
    let found = match settings.method {
        Method::Auto => attempts.choose(problem, settings),
        Method::Mprgp => attempts.by_multigrid(problem, settings),
        _ => attempts.with_factor(problem, settings),
    };
    let found = match settings.method {
        Method::Auto => found,
        method => with_solution(found, |solution| Solution { why: Some(by_name(method)), ..solution }),
    };
    with_solution(in_time(problem, settings, found), |solution| attempts.with_attempts(solution))
}

/// The attempts so far.
struct Attempts {
    clock: Instant,
    /// The start that was given.
    start: Start,
    made: Vec<Attempt>,
    /// Seconds of the factorisations in the attempts.
    factor_seconds: f64,
}

impl Attempts {
    /// The answer on the way that memory, time and size suggest; if it leads nowhere, on the other one.
    fn choose(&mut self, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
        let estimate = Estimate::of(problem);
        let choice = estimate.choose(settings.memory.unwrap_or(f64::INFINITY))?;
        let why = estimate.why(&choice);
        with_solution(self.chosen(problem, settings, &estimate, choice), |solution| {
            let reason = match (&solution.why, &solution.reason) {
                // The choice among the methods with a factor has its own reason.
                (Some(of_way), _) => format!("{}; {}", why.reason, of_way.reason),
                (None, Some(other)) if *other != why.reason => format!("{}; in the end {other}", why.reason),
                _ => why.reason.clone(),
            };
            Solution { why: Some(Why { reason, ..why }), ..solution }
        })
    }

    /// The answer on the way of `choice`; if it leads nowhere, on the other one.
    fn chosen(
        &mut self,
        problem: &ContactProblem,
        settings: &Settings,
        estimate: &Estimate,
        choice: Choice,
    ) -> Result<Solution, Error> {
        let (allowed, watch) = (settings.memory.unwrap_or(f64::INFINITY), &settings.watch);
        let (mut refused, mut worth_cycles) = (None, usize::MAX);
        let reason = match choice {
            Choice::Factor { .. } => match self.with_factor(problem, settings) {
                Err(Error::TooLarge { bytes, .. }) => {
                    refused = Some(bytes);
                    estimate.without_factor(bytes, allowed)?
                }
                Err(error @ Error::OutOfTime { needed, time }) => {
                    if !estimate.multigrid_bytes.is_finite()
                        || estimate.multigrid_bytes > allowed
                        || !watch.allows(estimate.hierarchy_seconds)
                    {
                        return Err(error);
                    }
                    format!("by multigrid: a factorisation would take about {needed:.1e} s, but {time:.1e} s are left")
                }
                decided => return decided,
            },
            Choice::Speed { reason, most_cycles } => {
                worth_cycles = most_cycles;
                reason
            }
            Choice::Room { reason } => reason,
        };
        let clock = Instant::now();
        let expected = Settings { worth_cycles, ..settings.clone() };
        let answered = with_solution(self.by_multigrid(problem, &expected), |solution| Solution {
            reason: Some(reason),
            ..solution
        });
        let fell_short = match answered {
            Err(error @ (Error::NotCertified { .. } | Error::Numerical { .. } | Error::NotConvex { .. }))
                if !watch.is_over() =>
            {
                error
            }
            decided => return decided,
        };
        let seconds = clock.elapsed().as_secs_f64();
        // The direct path may find the answer that the iteration cannot; if it was refused before, with one factor at a time.
        let direct = match refused {
            Some(_) => Settings { method: Method::ActiveSet, ..settings.clone() },
            None => settings.clone(),
        };
        let (multigrid, ended) = (estimate.multigrid_bytes, Some(ending(&fell_short)));
        match self.after_multigrid(problem, &direct, (fell_short, seconds)) {
            Err(Error::TooLarge { bytes: factor, .. }) => Err(Error::NoRoom { factor, multigrid, allowed, ended }),
            decided => decided,
        }
    }

    /// The answer on the direct path, after `seconds` of an iteration that ended with `fell_short`.
    fn after_multigrid(
        &mut self,
        problem: &ContactProblem,
        direct: &Settings,
        (fell_short, seconds): (Error, f64),
    ) -> Result<Solution, Error> {
        let clock = Instant::now();
        match self.with_factor(problem, direct) {
            Err(error @ Error::TooLarge { .. }) => Err(error),
            Err(error @ (Error::OutOfTime { .. } | Error::Interrupted)) => {
                self.add(Tried::on_all_dofs(Method::ActiveSet), clock.elapsed().as_secs_f64(), &error);
                Err(fell_short)
            }
            decided => {
                self.add(Tried::on_all_dofs(Method::Mprgp), seconds, &fell_short);
                decided
            }
        }
    }

    /// The answer with a factor. If a shortcut falls short, the active set in double precision follows; if a condensed problem
    /// does, all dofs follow.
    fn with_factor(&mut self, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
        let start = if self.start.is_unknown() { start(problem, settings) } else { self.start.clone() };
        self.with_factor_from(start, problem, settings)
    }

    /// The same, with active-set steps that start from `start`.
    fn with_factor_from(
        &mut self,
        start: Start,
        problem: &ContactProblem,
        settings: &Settings,
    ) -> Result<Solution, Error> {
        let clock = Instant::now();
        let prepared = Prepared::by_method(problem, settings)?.starting_from(start);
        let ending = with_solution(solved_with(&prepared, problem), |solution| match settings.method {
            Method::Auto => Solution { why: Some(of_way(&prepared)), ..solution },
            _ => solution,
        });
        let fell_short = match ending {
            Err(error @ (Error::NotCertified { .. } | Error::Numerical { .. })) => error,
            decided => return decided,
        };
        let tried = prepared.tried();
        let Some((safer, start)) = safer(&tried, settings, &fell_short) else { return Err(fell_short) };
        drop(prepared);
        let seconds = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        match self.with_factor_from(start, problem, &safer) {
            // If it is cut short, the first attempt may have come further.
            Err(error) if is_better(&fell_short, &error) => {
                let tried = Tried::on_all_dofs(safer.method);
                self.add(tried, clock.elapsed().as_secs_f64(), &error);
                Err(fell_short)
            }
            solved => {
                self.add(tried, seconds, &fell_short);
                solved
            }
        }
    }

    /// The answer without a factor.
    ///
    /// # Errors
    /// As [`Prepared::by_method`] and [`Prepared::solve`].
    fn by_multigrid(&self, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
        let settings = Settings { method: Method::Mprgp, ..settings.clone() };
        let prepared = Prepared::by_method(problem, &settings)?.starting_from(self.start.clone());
        solved_with(&prepared, problem)
    }

    /// Records an attempt on some way that took this number of seconds and ended with `error`.
    fn add(&mut self, tried: Tried, seconds: f64, error: &Error) {
        let mut method = tried.method.name().to_string();
        if let Error::NotCertified { solution, .. } = error {
            self.factor_seconds += solution.seconds.factor;
            method.clone_from(&solution.method);
        }
        let reason = match tried.condensed_dofs {
            Some(dofs) => format!("on {dofs} condensed dofs {}", ending(error)),
            None => ending(error),
        };
        self.made.push(Attempt { method, seconds, reason });
    }

    /// The answer with the other attempts, and the time of all.
    fn with_attempts(self, mut solution: Solution) -> Solution {
        solution.seconds.factor += self.factor_seconds;
        solution.seconds.solve = self.clock.elapsed().as_secs_f64();
        Solution { attempts: self.made, ..solution }
    }
}

/// The chosen method with a factor, and the reason.
fn of_way(prepared: &Prepared) -> Why {
    let tried = prepared.tried();
    let reason = tried.in_words(prepared.multiplications());
    Why { chosen: tried.method.name().to_string(), reason, considered: Vec::new() }
}

/// The start of the direct path. If contact is everywhere, it is the set that a few cycles of a hierarchy find, since a front
/// of closed rows moves by one row of nodes with every set.
fn start(problem: &ContactProblem, settings: &Settings) -> Start {
    if !starts_by_multigrid(problem, settings) {
        return Start::default();
    }
    let settings = Settings { method: Method::Mprgp, ..settings.clone() };
    Prepared::by_method(problem, &settings).ok().and_then(|prepared| prepared.near()).unwrap_or_default()
}

/// Returns `true` if the result of an attempt `before` is better than the `error` of the safer one.
fn is_better(before: &Error, error: &Error) -> bool {
    match (before, error) {
        (Error::NotCertified { solution: before, .. }, Error::NotCertified { solution, .. }) => {
            before.certificate.energy_error_bound < solution.certificate.energy_error_bound
        }
        (Error::NotCertified { .. }, Error::Interrupted | Error::OutOfTime { .. } | Error::Numerical { .. }) => true,
        _ => false,
    }
}

/// The ending of an attempt, in a few words.
fn ending(error: &Error) -> String {
    match error {
        Error::NotCertified { condition, value, .. } if value.is_infinite() => format!("no {condition} is known"),
        Error::NotCertified { condition, value, tolerance, .. } => {
            format!("{condition} is {value:.1e}, above {tolerance:.1e}")
        }
        error => error.to_string(),
    }
}

/// The answer at the gaps of `problem`; its time includes that of the preparation.
fn solved_with(prepared: &Prepared, problem: &ContactProblem) -> Result<Solution, Error> {
    let Seconds { factor, solve, .. } = prepared.seconds();
    with_solution(prepared.solve(problem.gap()), |mut solution| {
        solution.seconds.factor += factor;
        solution.seconds.solve += solve;
        solution
    })
}
