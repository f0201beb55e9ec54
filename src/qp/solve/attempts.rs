//! One way after another until an answer is certified: which are tried, and what is told of those that were.

use std::time::Instant;

use super::estimate::{Choice, Estimate};
use super::{Condense, Method, Precision, Prepared, Settings, claims, iterative};
use crate::error::Error;
use crate::qp::problem::ContactProblem;
use crate::solution::{Attempt, Certificate, ContactSet, Seconds, Solution};

/// Solves a contact problem; `Ok` means that the answer is certified to `settings.tolerance`.
///
/// # Errors
/// * [`Error::Setting`] for a setting outside its range,
/// * [`Error::Infeasible`] for contact rows that contradict each other,
/// * [`Error::Unbounded`] for a load that drives a motion which nothing stops,
/// * [`Error::UnderHeld`] for a motion that nothing resists: the answer would not be unique,
/// * [`Error::NotConvex`] for a stiffness with a negative eigenvalue,
/// * [`Error::NotCertified`] with the best answer, where it does not meet the tolerance,
/// * [`Error::NoRoom`] where no way within `settings.memory` leads to a certified answer, [`Error::TooLarge`] where the one
///   that was named does not fit,
/// * [`Error::Interrupted`] where the watch was asked to stop before there was an answer,
/// * [`Error::Numerical`] where memory does not suffice.
pub fn solve(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    let settings = &settings.started()?;
    claims::rechecked(problem, settings, method_ending(problem, settings))
}

/// How the ways that are tried end by themselves.
///
/// # Errors
/// As [`solve`]; a claim about the problem is not rechecked.
pub(super) fn method_ending(problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
    let settings = &settings.started()?;
    let mut attempts = Attempts { clock: Instant::now(), made: Vec::new(), factor_seconds: 0.0 };
    let found = match settings.method {
        Method::Auto => attempts.choose(problem, settings),
        Method::Mprgp => iterative::solve(problem, settings),
        _ => attempts.with_factor(problem, settings),
    };
    let found = match found {
        Err(Error::OutOfTime { needed, time }) => Err(nothing_found(problem, needed, time)?),
        found => found,
    };
    match found {
        Ok(solution) => Ok(attempts.told(solution)),
        Err(Error::NotCertified { solution, condition, value, tolerance }) => {
            let solution = Box::new(attempts.told(*solution));
            Err(Error::NotCertified { solution, condition, value, tolerance })
        }
        Err(error) => Err(error),
    }
}

/// What was tried so far.
struct Attempts {
    clock: Instant,
    made: Vec<Attempt>,
    /// Seconds of the factorisations in it.
    factor_seconds: f64,
}

impl Attempts {
    /// The answer on the way that memory, time and size suggest; where it leads nowhere, on the other one.
    fn choose(&mut self, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
        let estimate = Estimate::of(problem);
        let (allowed, watch) = (settings.memory.unwrap_or(f64::INFINITY), &settings.watch);
        let mut refused = None;
        let reason = match estimate.choose(allowed)? {
            Choice::Factor => match self.with_factor(problem, settings) {
                Err(Error::TooLarge { bytes, .. }) => {
                    refused = Some(bytes);
                    estimate.without_factor(bytes, allowed)?
                }
                Err(error @ Error::OutOfTime { needed, time }) => {
                    if estimate.multigrid_bytes > allowed || !watch.allows(estimate.hierarchy_seconds) {
                        return Err(error);
                    }
                    format!("by multigrid: a factorisation would take about {needed:.1e} s, {time:.1e} s are left")
                }
                decided => return decided,
            },
            Choice::Speed { reason } | Choice::Room { reason } => reason,
        };
        let clock = Instant::now();
        let fell_short = match by_multigrid(problem, settings, reason) {
            Err(error @ (Error::NotCertified { .. } | Error::Numerical { .. } | Error::NotConvex { .. }))
                if !watch.is_over() =>
            {
                error
            }
            decided => return decided,
        };
        let seconds = clock.elapsed().as_secs_f64();
        let (multigrid, ended) = (estimate.multigrid_bytes, Some(ending(&fell_short)));
        let no_room = |factor| Err(Error::NoRoom { factor, multigrid, allowed, ended });
        if let Some(bytes) = refused {
            return no_room(bytes);
        }
        // What the iteration cannot take, the direct path may.
        let clock = Instant::now();
        match self.with_factor(problem, settings) {
            Err(Error::TooLarge { bytes, .. }) => no_room(bytes),
            Err(error @ (Error::OutOfTime { .. } | Error::Interrupted)) => {
                self.add(Way::on_all_dofs(Method::ActiveSet), clock.elapsed().as_secs_f64(), &error);
                Err(fell_short)
            }
            decided => {
                self.add(Way::on_all_dofs(Method::Mprgp), seconds, &fell_short);
                decided
            }
        }
    }

    /// The answer with a factor; where a shortcut falls short, by the active set in double precision, and where a condensed
    /// problem does, on all dofs.
    fn with_factor(&mut self, problem: &ContactProblem, settings: &Settings) -> Result<Solution, Error> {
        self.with_factor_from(None, problem, settings)
    }

    /// The same, the active-set steps starting from `start` where it is given.
    fn with_factor_from(
        &mut self,
        start: Option<&ContactSet>,
        problem: &ContactProblem,
        settings: &Settings,
    ) -> Result<Solution, Error> {
        let clock = Instant::now();
        let prepared = Prepared::with_settings(problem, settings)?;
        let preparation = prepared.seconds();
        let with_preparation = |mut solution: Solution| {
            solution.seconds.factor += preparation.factor;
            solution.seconds.solve += preparation.solve;
            solution
        };
        let fell_short = match prepared.solve_gap(problem.gap().to_vec(), start, settings) {
            Ok(solution) => return Ok(with_preparation(solution)),
            Err(Error::NotCertified { solution, condition, value, tolerance }) => {
                let solution = Box::new(with_preparation(*solution));
                Error::NotCertified { solution, condition, value, tolerance }
            }
            Err(error @ Error::Numerical { .. }) => error,
            Err(error) => return Err(error),
        };
        let Some((safer, start)) = safer(&prepared, settings, &fell_short) else { return Err(fell_short) };
        let way = Way::of(&prepared, settings);
        drop(prepared);
        let seconds = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        match self.with_factor_from(start.as_ref(), problem, &safer) {
            // Where it is cut short, what was tried first may have come further.
            Err(error) if is_better(&fell_short, &error) => {
                let way = Way::on_all_dofs(safer.method);
                self.add(way, clock.elapsed().as_secs_f64(), &error);
                Err(fell_short)
            }
            solved => {
                self.add(way, seconds, &fell_short);
                solved
            }
        }
    }

    /// Notes an attempt on some way that took so many seconds and ended with `error`.
    fn add(&mut self, way: Way, seconds: f64, error: &Error) {
        let mut method = way.method.name().to_string();
        if let Error::NotCertified { solution, .. } = error {
            self.factor_seconds += solution.seconds.factor;
            method.clone_from(&solution.method);
        }
        let reason = match way.condensed_dofs {
            Some(dofs) => format!("on {dofs} condensed dofs {}", ending(error)),
            None => ending(error),
        };
        self.made.push(Attempt { method, seconds, reason });
    }

    /// The answer with what was tried beside it, and the time of all.
    fn told(self, mut solution: Solution) -> Solution {
        solution.seconds.factor += self.factor_seconds;
        solution.seconds.solve = self.clock.elapsed().as_secs_f64();
        Solution { attempts: self.made, ..solution }
    }
}

/// What was tried: a method, and the unknowns that it worked on where they were fewer than all.
struct Way {
    method: Method,
    condensed_dofs: Option<usize>,
}

impl Way {
    fn of(prepared: &Prepared, settings: &Settings) -> Self {
        let condensed_dofs = prepared.is_condensed().then(|| prepared.condensed_dofs());
        Way { method: prepared.resolved(settings).method, condensed_dofs }
    }

    fn on_all_dofs(method: Method) -> Self {
        Way { method, condensed_dofs: None }
    }
}

/// Settings that may reach what `prepared` fell short of, and where they start: a shortcut is left first, then the
/// condensation, which loses digits where the contact boundary feels little of the stiffness of the body.
fn safer(prepared: &Prepared, settings: &Settings, fell_short: &Error) -> Option<(Settings, Option<ContactSet>)> {
    if settings.watch.is_over() {
        return None;
    }
    let method = if settings.method == Method::Auto { Method::ActiveSet } else { settings.method };
    let safe = Settings { method, precision: Precision::Double, ..settings.clone() };
    if prepared.is_a_shortcut() {
        return Some((safe, None));
    }
    let (miss, start) = match fell_short {
        // What rounding of the displacement explains is no loss of the condensation.
        Error::NotCertified { solution, .. } if is_exact(&solution.certificate, settings) => return None,
        Error::NotCertified { solution, value, .. } if !value.is_nan() => (*value, Some(solution.contact_set.clone())),
        _ => (f64::INFINITY, None),
    };
    // What is asked for as it is, as a small penalty, falls short on all dofs too.
    let may_gain = prepared.is_condensed() && safe.condense == Condense::Auto && safe.allows_last_resort(miss);
    may_gain.then(|| (Settings { condense: Condense::Never, ..safe }, start))
}

/// Does an answer hold all that its displacement can, and fall short of an accuracy beyond that?
fn is_exact(certificate: &Certificate, settings: &Settings) -> bool {
    certificate.conditions_hold(settings.tolerance) && certificate.energy_error_excess == 0.0
}

/// Is what an attempt `before` left better than the `error` of the safer one?
fn is_better(before: &Error, error: &Error) -> bool {
    match (before, error) {
        (Error::NotCertified { solution: before, .. }, Error::NotCertified { solution, .. }) => {
            before.certificate.energy_error_bound < solution.certificate.energy_error_bound
        }
        (Error::NotCertified { .. }, Error::Interrupted | Error::OutOfTime { .. } | Error::Numerical { .. }) => true,
        _ => false,
    }
}

/// How an attempt ended, in a few words.
fn ending(error: &Error) -> String {
    match error {
        Error::NotCertified { condition, value, tolerance, .. } => {
            format!("{condition} is {value:.1e}, above {tolerance:.1e}")
        }
        error => error.to_string(),
    }
}

/// The answer without a factor, and why there is none.
///
/// # Errors
/// As [`Iterative::solve_gap`](super::Iterative::solve_gap).
fn by_multigrid(problem: &ContactProblem, settings: &Settings, reason: String) -> Result<Solution, Error> {
    let reason = Some(reason);
    match iterative::solve(problem, settings) {
        Err(Error::NotCertified { solution, condition, value, tolerance }) => {
            let solution = Box::new(Solution { reason, ..*solution });
            Err(Error::NotCertified { solution, condition, value, tolerance })
        }
        found => found.map(|solution| Solution { reason, ..solution }),
    }
}

/// The answer before anything is found: no displacement and no force, and how far that is off.
///
/// # Errors
/// Those of the certificate.
pub(super) fn nothing_found(problem: &ContactProblem, needed: f64, time: f64) -> Result<Error, Error> {
    let (displacement, multiplier) = (vec![0.0; problem.dofs()], vec![0.0; problem.rows()]);
    let certificate = problem.certify_in(None, &displacement, &multiplier)?;
    let solution = Solution {
        displacement,
        multiplier,
        contact_set: ContactSet::open(problem.rows()),
        method: "none".to_string(),
        iterations: 0,
        history: Vec::new(),
        certificate,
        proven: None,
        refinements: None,
        lost_pivot: None,
        reason: None,
        attempts: Vec::new(),
        condensed_dofs: problem.dofs(),
        seconds: Seconds::default(),
    };
    let condition = "the time of one factorisation (s)";
    Ok(Error::NotCertified { solution: Box::new(solution), condition, value: needed, tolerance: time })
}
