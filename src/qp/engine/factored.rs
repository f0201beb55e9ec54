//! The engine with a factor: everything that does not depend on load and gap is done once.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::boundary::BoundarySolution;
use super::case::{Case, Engine, FactorSize};
use super::found::Found;
use super::loading::{Load, Loading};
use super::reduction::Reduction;
use super::run::run;
use super::walk::Walk;
use crate::error::Error;
use crate::qp::certificate::EnergyNorm;
use crate::qp::cost::{check_time, seconds};
use crate::qp::linear::{AugmentedMatrix, Equilibration, dot, ldexp};
use crate::qp::method::{ScaledProblem, active_set};
use crate::qp::plan::{Tried, Way};
use crate::qp::problem::{ContactProblem, check_gap};
use crate::qp::settings::{Method, Settings};
use crate::qp::transform::Condensation;
use crate::solution::{ContactSet, Seconds, Solution};
use crate::watch::Watch;

/// Factorisations for one step of a loop if K is not definite by itself.
const SINGULAR: f64 = 3.0;

/// A contact problem, scaled, condensed if that pays, factorised.
#[derive(Debug)]
pub(super) struct Factored {
    pub(super) problem: ContactProblem,
    pub(super) reduction: Reduction,
    /// The smallest pivot of the scaled stiffness, if it is below [`LOST_PIVOT`](super::preparation::LOST_PIVOT).
    pub(super) lost_pivot: Option<f64>,
    pub(super) augmented: AugmentedMatrix,
    /// Energy norm of the condensed stiffness, if it is definite, made at its first use.
    pub(super) condensed_norm: OnceLock<Option<EnergyNorm>>,
    /// The choice of method and means, if it was left to the program.
    pub(super) way: Option<Way>,
    pub(super) multiplications: f64,
    /// Estimated seconds of the proof of the open and closed rows.
    pub(super) proof_seconds: f64,
    /// Estimated seconds of the factorisation that a bound takes if the stiffness is not definite by itself.
    pub(super) norm_seconds: f64,
    pub(super) seconds: Seconds,
}

impl Engine for Factored {
    fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    fn serves(&self, method: Method) -> bool {
        method != Method::Mprgp
    }

    fn seconds(&self) -> Seconds {
        self.seconds
    }

    fn tried(&self, settings: &Settings) -> Tried {
        Tried {
            method: self.resolved(settings).method,
            condensed_dofs: self.is_condensed().then(|| self.condensed_dofs()),
            is_shortcut: self.is_single() || self.way.is_some_and(|way| way != Way::ActiveSet),
        }
    }

    fn solve(&self, case: &Case) -> Result<Solution, Error> {
        self.best(self.find(case)?, case.settings).map(|best| best.1)
    }

    fn boundary(self: Arc<Self>, case: &Case) -> Result<BoundarySolution, Error> {
        self.boundary_at(case)
    }

    fn settled(&self, case: &Case) -> Result<Option<Vec<f64>>, Error> {
        let found = self.find(case)?;
        Ok(found.outcome.settled.then(|| self.displacement(&found)))
    }

    fn response(&self, load: &Load) -> Option<Vec<f64>> {
        let norm = self.reduction.norm()?;
        let no_gap = vec![0.0; self.reduction.selection.kept().len()];
        let loading = load.swept(&self.reduction, &no_gap);
        let moved = match &self.reduction.condensation {
            Some(condensed) => condensed.free_displacement(&loading.sweep),
            None => norm.scaled_displacement(&loading.scaled(loading.unit)),
        };
        Some(self.expand(&loading, loading.unit, &moved))
    }

    fn walk(self: Arc<Self>, from: &Case, to: &[f64]) -> Result<Walk, Error> {
        self.walk_to(from, to)
    }

    fn factor(&self) -> Option<FactorSize> {
        Some(FactorSize {
            unknowns: self.condensed_dofs(),
            entries: self.reduction.condensation.as_ref().map_or(0, Condensation::factor_entries),
            multiplications: self.multiplications,
            is_single: self.is_single(),
        })
    }
}

impl Factored {
    /// Number of unknowns that the methods work on.
    pub fn condensed_dofs(&self) -> usize {
        self.reduction.condensation.as_ref().map_or(self.problem.dofs(), |condensed| condensed.stiffness().dim())
    }

    /// Returns `true` if the methods work on the contact dofs alone.
    pub(super) fn is_condensed(&self) -> bool {
        self.reduction.condensation.is_some()
    }

    pub(super) fn expand_multiplier(&self, multiplier: &[f64], unit: i32) -> Vec<f64> {
        self.reduction.selection.expand_multiplier(&self.reduction.scaling.expand_multiplier(multiplier, unit))
    }

    pub(super) fn expand_set(&self, set: &ContactSet) -> ContactSet {
        self.reduction.selection.expand_set(set)
    }

    /// Runs the method, on the contact boundary if the problem is condensed.
    pub fn find(&self, case: &Case) -> Result<Found, Error> {
        let settings = &self.resolved(case.settings);
        self.check_gap(case.gap)?;
        let loading = case.load.swept(&self.reduction, &self.reduction.selection.gap(case.gap));
        let found = self.find_step(loading, case.gap.to_vec(), case.start.contact_set.as_ref(), settings)?;
        if self.is_single() { self.refined(found, settings) } else { Ok(found) }
    }

    /// The settings with the chosen method, if they leave the choice.
    pub(super) fn resolved(&self, settings: &Settings) -> Settings {
        match settings.method {
            Method::Auto => self.way.unwrap_or(Way::ActiveSet).settings(settings),
            _ => settings.clone(),
        }
    }

    /// One run of the method.
    pub(super) fn find_step(
        &self,
        loading: Arc<Loading>,
        gap: Vec<f64>,
        start: Option<&ContactSet>,
        settings: &Settings,
    ) -> Result<Found, Error> {
        let clock = Instant::now();
        let watch = self.watch_of_loop(settings)?;
        let (problem, unit) = self.scaled(&loading, &gap)?;
        let task = ScaledProblem::new(&problem, &self.augmented, self.reduction.definiteness()).watched(&watch);
        let start = start.map(|set| self.reduction.selection.restrict_set(set));
        let bound = |displacement: &[f64], multiplier: &[f64]| {
            let certificate = match self.condensed_norm(&problem) {
                Some(norm) => {
                    let norm = norm.watched(&settings.watch.finishing());
                    problem.certify_in(Some(&norm), displacement, multiplier)
                }
                None => problem.certify(displacement, multiplier),
            };
            let of_whole = self.share_of_boundary(&loading, unit, &problem, displacement);
            certificate.map_or(f64::INFINITY, |certificate| certificate.energy_error_bound * of_whole)
        };
        let outcome =
            run(&task, start, settings, &bound).map_err(|error| self.expand_error(error, &loading.load, &gap))?;
        let seconds =
            Seconds { factor: task.factor_seconds(), solve: clock.elapsed().as_secs_f64(), ..Seconds::default() };
        Ok(Found { loading, gap, problem, unit, outcome, seconds, refined: None })
    }

    /// A watch that is over as soon as there is no time left for one more factorisation of a loop and for the certificate.
    ///
    /// # Errors
    /// [`Error::OutOfTime`] if there is no time for the first factorisation.
    fn watch_of_loop(&self, settings: &Settings) -> Result<Watch, Error> {
        if settings.watch.time_left().is_none() {
            return Ok(settings.watch.clone());
        }
        let analysis = self.augmented.analysis();
        // If K is not definite, the start and the test of uniqueness factorise too.
        let factors = if self.reduction.is_definite() { 1.0 } else { SINGULAR };
        let of_loop = factors * seconds::factorisation(analysis);
        let (first, each) = match settings.method {
            Method::Qp(_) => (2.0 * seconds::interior_point(analysis), seconds::interior_point(analysis).max(of_loop)),
            _ => (of_loop, of_loop),
        };
        check_time(&settings.watch, first)?;
        Ok(settings.watch.keeping(each + seconds::certificate(&self.problem)))
    }

    /// The energy norm of the problem that the methods work on.
    pub(super) fn condensed_norm(&self, problem: &ContactProblem) -> Option<EnergyNorm> {
        if !self.is_condensed() || !self.reduction.is_definite() {
            return self.reduction.norm().map(|norm| norm.equilibrated());
        }
        let of_boundary = || {
            let unscaled = Equilibration::none(problem.dofs());
            let factor = self.augmented.factor(self.augmented.matrix(|_| 0.0, 0.0)).ok()?;
            Some(EnergyNorm::new(factor, unscaled, (0..problem.dofs()).collect()))
        };
        self.condensed_norm.get_or_init(of_boundary).clone()
    }

    /// The ratio of the energy norm of a displacement of the condensed problem to that of the whole body.
    fn share_of_boundary(&self, loading: &Loading, unit: i32, problem: &ContactProblem, displacement: &[f64]) -> f64 {
        let Some(condensed) = &self.reduction.condensation else { return 1.0 };
        let on_boundary = dot(displacement, &problem.stiffness().mul(displacement));
        let interior = ldexp(condensed.interior_energy(&loading.sweep), 2 * (loading.unit - unit));
        if interior > 0.0 { (on_boundary / (on_boundary + interior)).max(0.0).sqrt() } else { 1.0 }
    }

    /// Displacement and multiplier with the rows of `closed` held at their gaps.
    pub(in crate::qp) fn with_contact_set(&self, closed: &ContactSet) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let gap = self.reduction.selection.gap(self.problem.gap());
        let loading = Loading::of(&self.reduction, self.problem.load().to_vec(), &gap);
        let (problem, unit) = self.scaled(&loading, self.problem.gap())?;
        let task = ScaledProblem::new(&problem, &self.augmented, self.reduction.definiteness());
        let held = active_set::with_contact_set(&task, &self.reduction.selection.restrict_set(closed))
            .map_err(|error| self.expand_error(error, self.problem.load(), self.problem.gap()))?;
        Ok((self.expand(&loading, unit, &held.displacement), self.expand_multiplier(&held.multiplier, unit)))
    }

    /// The displacement of the whole body.
    pub(super) fn displacement(&self, found: &Found) -> Vec<f64> {
        let mut displacement = self.expand(&found.loading, found.unit, &found.outcome.displacement);
        if let Some(refined) = &found.refined {
            displacement.iter_mut().zip(&refined.base).for_each(|(step, base)| *step += base);
        }
        displacement
    }

    /// Returns `true` if the factor is in single precision.
    pub fn is_single(&self) -> bool {
        self.reduction.is_definite() && self.reduction.condensation.as_ref().is_some_and(Condensation::is_single)
    }

    /// Rows that were left out when the problem was prepared, and only these, must still be without obstacle.
    pub(super) fn check_gap(&self, gap: &[f64]) -> Result<(), Error> {
        check_gap(gap, self.problem.rows())?;
        if self.reduction.selection.under(gap)?.kept() == self.reduction.selection.kept() {
            return Ok(());
        }
        let (row, &value) = (gap.iter().enumerate())
            .find(|(row, gap)| gap.is_finite() != self.problem.gap()[*row].is_finite())
            .unwrap_or((0, &f64::NAN));
        let allowed = "infinite in the same rows as when the problem was prepared";
        Err(Error::NotFinite { name: "gap vector", at: format!("entry {row}"), value, allowed })
    }

    /// The problem that the methods work on, and the exponent of its reference displacement.
    fn scaled(&self, loading: &Loading, gap: &[f64]) -> Result<(ContactProblem, i32), Error> {
        let gap = self.reduction.selection.gap(gap);
        let unit = loading.unit_with(&gap);
        let (stiffness, contact) = match &self.reduction.condensation {
            Some(condensed) => (condensed.stiffness(), condensed.contact()),
            None => (self.reduction.scaling.stiffness(), self.reduction.scaling.contact()),
        };
        let (load, gap) = (loading.scaled(unit), self.reduction.scaling.gap(&gap, unit));
        Ok((ContactProblem::new(stiffness.clone(), load, contact.clone(), gap)?, unit))
    }

    /// The displacement of the whole body, in its own unit.
    pub(super) fn expand(&self, loading: &Loading, unit: i32, displacement: &[f64]) -> Vec<f64> {
        match &self.reduction.condensation {
            Some(condensed) => {
                // In the unit of the sweep.
                let moved: Vec<f64> = displacement.iter().map(|&v| ldexp(v, unit - loading.unit)).collect();
                self.reduction.scaling.expand_displacement(&condensed.expand(&loading.sweep, &moved), loading.unit)
            }
            None => self.reduction.scaling.expand_displacement(displacement, unit),
        }
    }
}
