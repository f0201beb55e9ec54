//! The whole answer of the engine with a factor: expanded, certified, refined, and found again if it falls short.

use std::time::Instant;

use super::factored::Factored;
use super::found::Found;
use super::run::last_resort;
use crate::error::Error;
use crate::qp::certificate::{EnergyNorm, Examined, WithEvidence};
use crate::qp::judged::{answer, judged};
use crate::qp::method::{Outcome, ScaledProblem};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::Settings;
use crate::solution::{ContactSet, Iteration, Seconds, Solution};
use crate::watch::Watch;

/// Largest number of repairs of an answer: the second removes the rounding of the first.
const MOST_REPAIRS: usize = 8;

impl Factored {
    /// The whole answer, certified, and what was found for it; a second attempt is made if `found` falls short.
    pub(super) fn best(&self, found: Found, settings: &Settings) -> Result<(Found, Solution), Error> {
        let goal = settings.goal();
        let solution = self.whole(&found, settings)?;
        let mut best = (found, solution);
        if !goal.is_met_by(&best.1.certificate) {
            let (_, miss, _) = best.1.certificate.decisive(goal.required());
            let other = self.second_attempt(&best.0, settings)?;
            if let Some(other) = other.filter(|_| self.resolved(settings).allows_last_resort(miss)) {
                let solution = self.whole(&other, settings)?;
                if solution.certificate.improves_on(&best.1.certificate, 1.0) {
                    best = (other, solution);
                }
            }
        }
        let (found, solution) = best;
        Ok((found, judged(solution, goal)?))
    }

    /// The answer of the last resort, if `found` is not that already.
    ///
    /// # Errors
    /// [`Error::Infeasible`] for contact rows that contradict each other.
    fn second_attempt(&self, found: &Found, settings: &Settings) -> Result<Option<Found>, Error> {
        let clock = Instant::now();
        // For an answer that was cut short, the reason is known.
        if found.outcome.is_last_resort() || settings.watch.is_over() {
            return Ok(None);
        }
        let task =
            ScaledProblem::new(&found.problem, &self.augmented, self.reduction.definiteness()).watched(&settings.watch);
        let outcome = last_resort(&task, found.outcome.clone())
            .map_err(|error| self.expand_error(error, &found.loading.load, &found.gap))?;
        let seconds = Seconds { solve: found.seconds.solve + clock.elapsed().as_secs_f64(), ..found.seconds };
        Ok(outcome.is_last_resort().then(|| Found { outcome, seconds, ..found.clone() }))
    }

    /// The energy norm for a certificate; a factor in single precision is widened by its contraction.
    fn norm_of(&self, found: &Found, settings: &Settings) -> Option<EnergyNorm> {
        let norm = self.norm_within(&settings.watch.finishing())?;
        Some(match &found.refined {
            Some(refined) => norm.off_by(refined.contraction.max(norm.contraction(self.problem.stiffness()))),
            None => norm,
        })
    }

    /// The whole answer with its certificate.
    fn whole(&self, found: &Found, settings: &Settings) -> Result<Solution, Error> {
        let clock = Instant::now();
        settings.watch.step("certificate", 0);
        let displacement = self.displacement(found);
        let method = self.resolved(settings).method;
        let Found { loading, gap, unit, outcome, seconds, refined, .. } = found;
        let before_certificate = Instant::now();
        let norm = self.norm_of(found, settings);
        let multiplier = self.expand_multiplier(&outcome.multiplier, *unit);
        let problem = self.problem.with(loading.load.clone(), gap.clone())?;
        let (displacement, examined) = self.examined(&problem, norm.as_ref(), (displacement, &multiplier), settings)?;
        let Examined { certificate, evidence, .. } = examined;
        let judging = before_certificate.elapsed().as_secs_f64();
        // A factor that was made for the certificate alone is freed to make room for those of a refinement.
        let norm = norm.filter(|_| self.reduction.is_norm_at_hand());
        let expand_iteration = |step: &Iteration| Iteration {
            contact_set: self.reduction.selection.expand_set(&step.contact_set),
            penalty: step.penalty,
        };
        let whole = Outcome {
            displacement,
            multiplier,
            contact_set: self.reduction.selection.expand_set(&outcome.contact_set),
            history: outcome.history.iter().map(expand_iteration).collect(),
            ..*outcome
        };
        let refinements = refined.as_ref().map(|refined| refined.steps);
        let mut solution = Solution {
            refinements,
            lost_pivot: self.lost_pivot,
            condensed_dofs: self.condensed_dofs(),
            seconds: Seconds { certificate: judging, solve: seconds.solve + clock.elapsed().as_secs_f64(), ..*seconds },
            ..answer(whole, method.name(), certificate)
        };
        if self.resolved(settings).wants_best() {
            solution = self.corrected(solution, &problem, settings)?;
            if let Some(norm) = norm.as_ref().filter(|_| !self.is_single()) {
                solution = self.repaired(solution, norm, &problem, settings)?;
            }
        }
        let may_prove = settings.prove && !settings.watch.acknowledge() && settings.watch.allows(self.proof_seconds);
        // A proof takes about the memory of one more factor.
        if let Some(norm) = norm.as_ref().filter(|_| may_prove) {
            let clock = Instant::now();
            // A refined answer has another residual.
            let evidence = evidence.filter(|_| solution.refinements == refinements);
            let (displacement, multiplier) = (&solution.displacement, &solution.multiplier);
            solution.proven = problem.prove_in(norm, WithEvidence { displacement, multiplier, evidence });
            let seconds = clock.elapsed().as_secs_f64();
            solution.seconds.proof += seconds;
            solution.seconds.solve += seconds;
        }
        Ok(solution)
    }

    /// The certificate of an answer to `problem`, this one under some load and gaps: in `norm`, or with the bound that the time
    /// allows. If the best answer is wanted, parts that may rest are put at rest.
    pub(super) fn examined(
        &self,
        problem: &ContactProblem,
        norm: Option<&EnergyNorm>,
        (displacement, multiplier): (Vec<f64>, &[f64]),
        settings: &Settings,
    ) -> Result<(Vec<f64>, Examined), Error> {
        let in_time = settings.watch.finishing().allows(self.norm_seconds);
        let examine = |displacement: &[f64]| match norm {
            None if in_time => problem.examine(displacement, multiplier),
            norm => problem.examine_in(norm, displacement, multiplier),
        };
        let examined = examine(&displacement)?;
        match self.resolved(settings).wants_best() {
            true => problem.resting(displacement, examined, examine),
            false => Ok((displacement, examined)),
        }
    }

    /// The energy norm of a stiffness that is definite by itself, with bounds that end when `watch` says so; `None` also if
    /// there is no time to make it.
    pub(super) fn norm_within(&self, watch: &Watch) -> Option<EnergyNorm> {
        let in_time = self.reduction.is_norm_at_hand() || watch.allows(self.norm_seconds);
        if in_time { self.reduction.norm().map(|norm| norm.watched(watch)) } else { None }
    }

    /// A solution that falls short, improved by the repair of its own bound as long as that brings it closer to its goal. This
    /// helps if rows hold many dofs, or no dof except for rounding, and if forces cancel almost all of each other: then a step
    /// of the method has nothing left to improve.
    ///
    /// # Errors
    /// Those of the certificate.
    fn repaired(
        &self,
        mut solution: Solution,
        norm: &EnergyNorm,
        problem: &ContactProblem,
        settings: &Settings,
    ) -> Result<Solution, Error> {
        for _ in 0..MOST_REPAIRS {
            if !solution.certificate.asks_for_more(settings.goal()) || settings.watch.is_over() {
                break;
            }
            let clock = Instant::now();
            let Some((displacement, multiplier)) = problem.repaired(norm, &solution.displacement, &solution.multiplier)
            else {
                break;
            };
            let (displacement, examined) = self.examined(problem, Some(norm), (displacement, &multiplier), settings)?;
            let certificate = examined.certificate;
            if !certificate.gains_on(&solution.certificate, settings.goal(), 1.0) {
                break;
            }
            let contact_set: ContactSet = multiplier.iter().map(|&force| force < 0.0).collect();
            let seconds = Seconds { solve: solution.seconds.solve + clock.elapsed().as_secs_f64(), ..solution.seconds };
            let refinements = Some(solution.refinements.unwrap_or(0) + 1);
            solution =
                Solution { displacement, multiplier, certificate, contact_set, seconds, refinements, ..solution };
        }
        Ok(solution)
    }
}
