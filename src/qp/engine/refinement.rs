//! Refinement: with the available factor an answer is brought to the digits of doubles, or to the requested accuracy.
//!
//! With the factor K~, in single precision or in double precision with the digits that condensation and bending have left,
//! every step solves a contact problem for the residual,
//!
//! ```text
//! minimise 1/2 d' K~ d - (f - K u)' d   subject to   B d <= g - B u
//! ```
//!
//! condensed, by the same method, and adds d to u. The residual is computed with twice the working precision. If d is zero, the
//! conditions are those of the problem itself; until then the error shrinks by `|I - K~^-1 K|` from step to step. With a factor
//! in single precision that contraction is measured; it widens the bound of the certificate, which uses K~ only.

use std::sync::Arc;
use std::time::Instant;

use super::factored::Factored;
use super::found::{Found, Refined};
use super::loading::Loading;
use crate::error::Error;
use crate::qp::linear::dot;
use crate::qp::problem::ContactProblem;
use crate::qp::settings::Settings;
use crate::solution::{ContactSet, Solution};

/// Number of steps after which no more digits can be gained.
const MOST_STEPS: usize = 30;

/// Steps after an answer in double precision: each gains as many digits as the factor has left.
const MOST_CORRECTIONS: usize = 6;

/// A contraction above this makes the bound of the certificate worthless.
const LARGEST_CONTRACTION: f64 = 0.2;

/// Steps below this share of the displacement are rounding and do not show the contraction.
const LEAST_STEP: f64 = 1e-9;

/// A step below this share of the displacement no longer changes it.
const NOTHING: f64 = 4.0 * f64::EPSILON;

/// The target accuracy is this share of the requested one, because the contraction is an estimate.
const AIM: f64 = 0.1;

impl Factored {
    /// Refines the result of the method with the factor in single precision.
    ///
    /// # Errors
    /// [`Error::Numerical`] if the stiffness is too ill-conditioned for single precision, and those of the method.
    pub(super) fn refined(&self, first: Found, settings: &Settings) -> Result<Found, Error> {
        let (load, gap) = (first.loading.load.clone(), first.gap.clone());
        let mut rest = load.clone();
        let mut found = first;
        let mut refined = Refined { base: vec![0.0; self.problem.dofs()], contraction: 0.0, steps: 0 };
        let mut last_length = f64::INFINITY;
        loop {
            let step = self.expand(&found.loading, found.unit, &found.outcome.displacement);
            let displacement: Vec<f64> = refined.base.iter().zip(&step).map(|(u, d)| u + d).collect();
            // K~ d is the residual of the load and the contact force.
            let multiplier = self.expand_multiplier(&found.outcome.multiplier, found.unit);
            let contact = self.problem.contact().mul_transposed(&multiplier);
            let work: f64 = step.iter().zip(rest.iter().zip(&contact)).map(|(d, (r, c))| d * (r + c)).sum();
            let elastic = self.problem.stiffness().mul(&displacement);
            let (length, size) = (work.max(0.0).sqrt(), dot(&displacement, &elastic).max(0.0).sqrt());
            let ratio = if last_length > 0.0 { length / last_length } else { 0.0 };
            if last_length.is_finite() && last_length > LEAST_STEP * size {
                refined.contraction = refined.contraction.max(ratio);
            }
            if refined.contraction > LARGEST_CONTRACTION {
                let reason =
                    "the stiffness is too ill-conditioned for single precision; take double precision".to_string();
                return Err(Error::Numerical { step: "refinement of a factor in single precision", reason });
            }
            let good_enough = settings
                .accuracy
                .is_some_and(|accuracy| refined.steps > 0 && length * refined.contraction <= AIM * accuracy * size);
            let no_gain = refined.steps > 0 && (length <= NOTHING * size || ratio > 0.5);
            if good_enough || no_gain || settings.watch.is_over() || refined.steps == MOST_STEPS {
                return Ok(Found {
                    gap,
                    loading: Arc::new(found.loading.with_load(load)),
                    refined: Some(refined),
                    ..found
                });
            }
            rest = load.iter().zip(&elastic).map(|(f, k)| f - k).collect();
            let (history, iterations) = (found.outcome.history, found.outcome.iterations);
            let (set, seconds) = (self.expand_set(&found.outcome.contact_set), found.seconds);
            let problem = self.problem.with(load.clone(), gap.clone())?;
            found = self.step_from(&problem, &displacement, &multiplier, &set, settings)?;
            // A step that keeps the set adds nothing to the history.
            let kept = found
                .outcome
                .history
                .iter()
                .all(|entry| Some(&entry.contact_set) == history.last().map(|last| &last.contact_set));
            found.outcome.history = if kept { history } else { [history, found.outcome.history].concat() };
            found.outcome.iterations = iterations;
            found.seconds.factor += seconds.factor;
            found.seconds.solve += seconds.solve;
            refined.base = displacement;
            refined.steps += 1;
            last_length = length;
        }
    }

    /// The step d: the answer to the contact problem for the residual of an answer (u, lambda) to `problem`, started from its
    /// contact set, together with the whole multiplier.
    fn step_from(
        &self,
        problem: &ContactProblem,
        displacement: &[f64],
        multiplier: &[f64],
        set: &ContactSet,
        settings: &Settings,
    ) -> Result<Found, Error> {
        // The contact force is balanced on its own dofs; only the imbalance is swept.
        let imbalance = problem.accurate_residual(displacement, multiplier);
        let contact = problem.contact().mul_transposed(multiplier);
        let released: Vec<f64> = contact.iter().map(|force| -force).collect();
        let left: Vec<f64> = problem.accurate_violation(displacement).iter().map(|violation| -violation).collect();
        let loading = match self.reduction.condensation {
            Some(_) => Loading::of(&self.reduction, imbalance, &self.reduction.selection.gap(&left))
                .with_contact_force(&self.reduction, &released),
            None => {
                let rest = imbalance.iter().zip(&released).map(|(r, b)| r + b).collect();
                Loading::of(&self.reduction, rest, &self.reduction.selection.gap(&left))
            }
        };
        self.find_step(Arc::new(loading), left, Some(set), settings)
    }

    /// A solution that falls short, refined as long as that brings it closer to its goal.
    ///
    /// # Errors
    /// Those of the certificate.
    pub(super) fn corrected(
        &self,
        mut solution: Solution,
        problem: &ContactProblem,
        settings: &Settings,
    ) -> Result<Solution, Error> {
        // Another step must reduce the worst condition to this share.
        const GAIN: f64 = 0.5;
        for _ in 0..MOST_CORRECTIONS {
            if !solution.certificate.asks_for_more(settings.goal()) || settings.watch.is_over() {
                break;
            }
            let clock = Instant::now();
            settings.watch.step("refinement", 0);
            let (displacement, multiplier) = (&solution.displacement, &solution.multiplier);
            // If there is no answer for the residual, the solution may still be good enough.
            let Ok(step) = self.step_from(problem, displacement, multiplier, &solution.contact_set, settings) else {
                break;
            };
            let moved = self.expand(&step.loading, step.unit, &step.outcome.displacement);
            let displacement: Vec<f64> = displacement.iter().zip(&moved).map(|(u, d)| u + d).collect();
            let multiplier = self.expand_multiplier(&step.outcome.multiplier, step.unit);
            let norm = self.norm_within(&settings.watch.finishing());
            let (displacement, examined) =
                self.examined(problem, norm.as_ref(), (displacement, &multiplier), settings)?;
            let certificate = examined.certificate;
            if !certificate.gains_on(&solution.certificate, settings.goal(), GAIN) {
                break;
            }
            solution.contact_set = self.expand_set(&step.outcome.contact_set);
            (solution.displacement, solution.multiplier, solution.certificate) =
                (displacement, multiplier, certificate);
            solution.refinements = Some(solution.refinements.unwrap_or(0) + 1);
            solution.seconds.solve += clock.elapsed().as_secs_f64();
            solution.seconds.factor += step.seconds.factor;
        }
        Ok(solution)
    }
}
