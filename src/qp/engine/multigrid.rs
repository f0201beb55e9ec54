//! The method without a factorisation of the body: one multigrid hierarchy, MPRGP, the certificate.

use std::time::Instant;

use super::case::{Case, Engine};
use crate::error::Error;
use crate::qp::certificate::{Examined, WithEvidence};
use crate::qp::cost::{Kept, NEAR_CYCLES, check_memory, check_time, seconds};
use crate::qp::judged::{answer, judged};
use crate::qp::linear::multigrid::{Multigrid, NearNullSpace};
use crate::qp::method::mprgp::{Limits, Mprgp, takes_travels};
use crate::qp::method::{Solver, Start};
use crate::qp::plan::Tried;
use crate::qp::problem::{ContactProblem, check_gap};
use crate::qp::settings::{Method, Settings};
use crate::qp::transform::RowSelection;
#[cfg(feature = "cli")]
use crate::solution::Certificate;
use crate::solution::{Seconds, Solution};
use crate::watch::Watch;

/// The method ends at this share of the tolerance of the certificate, because the scales of the two differ.
const MARGIN: f64 = 0.1;

/// If the certificate is not met, the method continues to this share of the residual that it reached.
const NEXT: f64 = 0.01;

/// If an accuracy is given, the method first ends at this share of the accuracy: forces are less accurate than the energy.
const FIRST: f64 = 0.1;

/// If the bound exceeds the accuracy, the next attempt aims at this share of the accuracy.
const AIM: f64 = 0.3;

/// A start for another method ends at this relative imbalance of forces.
const NEAR: f64 = 1e-4;

/// A relative imbalance of forces below this is rounding.
const IMBALANCE_ROUNDING: f64 = 1e-15;

/// A contact problem with the multigrid hierarchy of its stiffness: built once, for all gaps, loads and starts.
///
/// Nothing is scaled: the hierarchy scales itself to order one, and MPRGP compares only relative quantities. The bound on the energy
/// error takes a few more cycles; it rests on a measured eigenvalue, as its certificates say.
#[derive(Debug)]
pub(super) struct Hierarchical {
    problem: ContactProblem,
    multigrid: Multigrid,
    seconds: f64,
}

impl Hierarchical {
    /// Builds the hierarchy from the near-null space of `problem`, or from constants if it has none.
    ///
    /// # Errors
    /// Those of [`Multigrid::new`], also for a dof without stiffness that is no travel; before that [`Error::Interrupted`], [`Error::TooLarge`] and [`Error::OutOfTime`].
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        let Settings { watch, threads, .. } = settings;
        if watch.acknowledge() {
            return Err(Error::Interrupted);
        }
        if !takes_travels(problem) {
            let dof = problem.without_stiffness().first().copied().unwrap_or_default();
            return Err(Error::NotConvex { evidence: format!("diagonal entry {dof} is 0e0, indices from 0") });
        }
        check_memory(problem, Kept::Multigrid, settings)?;
        seconds::learn(watch);
        let entries = problem.stiffness().lower().entries();
        let estimate = seconds::hierarchy(problem.dofs() as f64, entries as f64);
        check_time(watch, estimate + seconds::certificate(problem))?;
        watch.step("multigrid hierarchy", 0);
        let clock = Instant::now();
        let multigrid = watch.timed(estimate, || match problem.near_null() {
            Some(near_null) => Multigrid::new(problem.stiffness(), near_null, *threads),
            None => Multigrid::new(problem.stiffness(), &NearNullSpace::constants(problem.stiffness())?, *threads),
        })?;
        Ok(Hierarchical { problem: problem.clone(), multigrid, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The certificate of what was found for `problem`, with the bound that the time allows.
    fn examine(&self, problem: &ContactProblem, u: &[f64], lambda: &[f64], watch: &Watch) -> Result<Examined, Error> {
        watch.step("certificate", 0);
        problem.examine_by_cycles(&self.multigrid, &watch.finishing(), u, lambda)
    }
}

/// The certificate of an answer from elsewhere, with the bound of the cycles. The bound is missing if the stiffness has no hierarchy,
/// because a dof has no stiffness or a direction has negative energy.
///
/// # Errors
/// As [`Hierarchical::new`] and [`ContactProblem::certify`].
#[cfg(feature = "cli")]
pub(in crate::qp) fn certify_by_multigrid(
    problem: &ContactProblem,
    (displacement, multiplier): (&[f64], &[f64]),
    settings: &Settings,
) -> Result<Certificate, Error> {
    match Hierarchical::new(problem, settings) {
        Ok(Hierarchical { multigrid, .. }) => {
            settings.watch.step("certificate", 0);
            let examined = problem.examine_by_cycles(&multigrid, &settings.watch, displacement, multiplier)?;
            Ok(examined.certificate)
        }
        Err(Error::NotConvex { .. }) => problem.certify_in(None, displacement, multiplier),
        Err(error) => Err(error),
    }
}

impl Engine for Hierarchical {
    fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    fn serves(&self, method: Method) -> bool {
        matches!(method, Method::Mprgp | Method::Auto)
    }

    fn seconds(&self) -> Seconds {
        Seconds { factor: self.seconds, solve: self.seconds, ..Seconds::default() }
    }

    fn tried(&self, _: &Settings) -> Tried {
        Tried::on_all_dofs(Method::Mprgp)
    }

    /// The whole answer, certified.
    ///
    /// # Errors
    /// * [`Error::Length`] and [`Error::NotFinite`] for gaps that do not fit,
    /// * [`Error::Infeasible`] for contact rows that contradict each other,
    /// * [`Error::Numerical`] for rows that no rotation turns into bounds,
    /// * [`Error::Unbounded`] and [`Error::UnderHeld`] for a mode that nothing stops, if the method finds one,
    /// * [`Error::NotConvex`] for a direction of negative energy,
    /// * [`Error::NotCertified`] with the best answer, if the method stagnates above the tolerance.
    fn solve(&self, case: &Case) -> Result<Solution, Error> {
        let Case { gap, start, settings, .. } = *case;
        // Once the loop ends, its answer is still to be certified.
        let watch = &settings.watch.keeping(seconds::certificate(&self.problem));
        let clock = Instant::now();
        check_gap(gap, self.problem.rows())?;
        RowSelection::of(self.problem.contact(), gap)?;
        let problem = self.problem.with(case.load.force().to_vec(), gap.to_vec())?;
        let goal = settings.goal();
        let mut tolerance = settings.accuracy.map_or(MARGIN * goal.tolerance, |accuracy| FIRST * accuracy);
        let (mut most_cycles, worth) = (settings.max_iterations, settings.worth_cycles);
        let multigrid = &self.multigrid;
        let solve = |tolerance, most_cycles, start| {
            Mprgp { problem: &problem, multigrid, limits: Limits { tolerance, most_cycles, worth, watch } }.solve(start)
        };
        let mut found = solve(tolerance, most_cycles, start.clone())?;
        let mut judging = 0.0;
        let Examined { certificate, evidence, .. } = loop {
            let before = Instant::now();
            let examine =
                |displacement: &[f64]| self.examine(&problem, displacement, &found.multiplier, &settings.watch);
            let examined = examine(&found.displacement)?;
            let (displacement, examined) = problem.resting(found.displacement.clone(), examined, examine)?;
            found.displacement = displacement;
            judging += before.elapsed().as_secs_f64();
            let certificate = &examined.certificate;
            most_cycles = settings.max_iterations.saturating_sub(found.iterations);
            let bound = certificate.energy_error_bound;
            tolerance *= match settings.accuracy {
                Some(accuracy) if bound.is_finite() && bound > 0.0 => (AIM * accuracy / bound).clamp(NEXT, AIM),
                _ => NEXT,
            };
            let met = goal.is_met_by(certificate);
            if met || !found.settled || tolerance < IMBALANCE_ROUNDING || most_cycles == 0 || watch.is_over() {
                break examined;
            }
            let mut next = solve(tolerance, most_cycles, Start::near(found.displacement))?;
            next.iterations += found.iterations;
            found.history.append(&mut next.history);
            next.history = found.history;
            found = next;
        };
        let before_proof = Instant::now();
        let may_prove = settings.prove && !settings.watch.is_over();
        let (displacement, multiplier) = (&found.displacement, &found.multiplier);
        let answered = WithEvidence { displacement, multiplier, evidence };
        let prove = || problem.prove_by_cycles(multigrid, &settings.watch, answered);
        let proven = if may_prove { prove() } else { None };
        let proof = if may_prove { before_proof.elapsed().as_secs_f64() } else { 0.0 };
        let seconds = Seconds { factor: 0.0, certificate: judging, proof, solve: clock.elapsed().as_secs_f64() };
        let solution = Solution { seconds, proven, ..answer(found, Method::Mprgp.name(), certificate) };
        judged(solution, goal)
    }

    /// A contact set near that of the answer; `None` if the method meets a difficulty that another method must treat.
    fn near(&self, settings: &Settings) -> Option<Start> {
        let most_cycles = NEAR_CYCLES as usize;
        let limits = Limits { tolerance: NEAR, most_cycles, worth: usize::MAX, watch: &settings.watch };
        let found =
            Mprgp { problem: &self.problem, multigrid: &self.multigrid, limits }.solve(Start::default()).ok()?;
        Some(found.contact_set.into())
    }

    fn hierarchy(&self) -> Option<&Multigrid> {
        Some(&self.multigrid)
    }
}
