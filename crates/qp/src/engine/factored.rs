//! The engine with a factor: everything that does not depend on load and gap is done once.

use std::sync::{Arc, OnceLock};

use super::interface::{Engine, Found, OnBoundary, Task, Walk};
use super::loading::{Load, Loading};
use super::reduction::{Norm, Reduction};
use super::step::ScaledStep;
use crate::certificate::{Bounding, EnergyNorm};
use crate::cost::{bytes, check_time, seconds};
use crate::error::Error;
use crate::linear::{Augmented, Equilibration, dot, ldexp};
use crate::method::{Ending, Outcome, ScaledProblem, active_set};
use crate::plan::{Means, Step, Tried};
use crate::problem::ContactProblem;
use crate::settings::ByFactor;
use crate::solution::{ContactSet, Iteration, Seconds, Solution};
use crate::transform::Condensation;
use crate::watch::Watch;

/// Factorisations for one step of a loop if K is not definite by itself.
const SINGULAR: f64 = 3.0;

/// A contact problem, scaled, condensed if that pays, factorised.
#[derive(Debug)]
pub(crate) struct Factored {
    pub(super) problem: ContactProblem,
    pub(super) reduction: Reduction,
    /// The smallest pivot of the scaled stiffness, if it is below [`LOST_PIVOT`](super::preparation::LOST_PIVOT).
    pub(super) lost_pivot: Option<f64>,
    pub(super) augmented: Augmented,
    /// Energy norm of the condensed stiffness, if it is definite, made at its first use.
    pub(super) condensed_norm: OnceLock<Option<EnergyNorm>>,
    /// The method, and whether the program chose it.
    pub(super) method: ByFactor,
    pub(super) is_chosen: bool,
    pub(super) multiplications: f64,
    /// As that of [`Tried`].
    pub(super) set_seconds: f64,
    /// Estimated seconds of the proof of the open and closed rows.
    pub(super) proof_seconds: f64,
    /// Estimated seconds of the factorisation that a bound takes if the stiffness is not definite by itself.
    pub(super) norm_seconds: f64,
    pub(super) seconds: Seconds,
}

/// The result of a method on the unknowns of the engine, with its load and gaps.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    pub loading: Arc<Loading>,
    pub problem: ContactProblem,
    pub unit: i32,
    pub outcome: Outcome,
    pub factor_seconds: f64,
}

/// A load in all its forms, and gaps of all rows.
pub(super) struct Loaded {
    pub loading: Arc<Loading>,
    pub gap: Vec<f64>,
}

impl Engine for Factored {
    fn serves(&self, means: &Means) -> bool {
        matches!(means, Means::Factor(_))
    }

    fn seconds(&self) -> Seconds {
        self.seconds
    }

    fn tried(&self, method: Option<ByFactor>) -> Tried {
        Tried {
            method: self.chosen(method).into(),
            condensed_dofs: self.is_condensed().then(|| self.condensed_dofs()),
            is_shortcut: self.is_chosen && self.method != ByFactor::ActiveSet,
            lost_pivot: self.lost_pivot,
            is_singular: self.lost_pivot.is_some(),
            multiplications: self.multiplications,
            set_seconds: self.set_seconds,
        }
    }

    fn make(&self, task: &Task) -> Result<Option<Found>, Error> {
        match (task.step, task.best) {
            (Step::Refinement, Some(best)) => Ok(self.refined_answer(task, best)),
            (Step::Repair, Some(best)) => Ok(self.repaired(task, best)),
            (Step::Refinement | Step::Repair, None) => Ok(None),
            _ => Ok(self.find(task)?.map(|reduced| self.whole(reduced))),
        }
    }

    fn bounding(&self, watch: &Watch) -> Bounding<'_> {
        let in_time = watch.allows(self.norm_seconds);
        match self.norm_within(watch) {
            Some(norm) => Bounding::Factor(norm),
            None if in_time => Bounding::OwnFactor,
            None => Bounding::Nothing,
        }
    }

    fn bytes(&self) -> f64 {
        let of_factor = |values: usize| bytes::of_factor(values as f64);
        match &self.reduction.condensation {
            Some(condensed) => of_factor(condensed.factor_entries()) + bytes::of_dense(self.condensed_dofs() as f64),
            None => match self.reduction.compliance() {
                Some(compliance) => compliance.bytes(),
                None => of_factor(self.augmented.matrix().map_or(0, |matrix| matrix.analysis().factor_entries())),
            },
        }
    }

    fn proof_seconds(&self) -> f64 {
        self.proof_seconds
    }

    fn on_boundary(self: Arc<Self>, task: &Task, is_bounded: bool) -> Result<Option<OnBoundary>, Error> {
        self.answer_on_boundary(task, is_bounded)
    }

    fn settled(&self, task: &Task) -> Result<Option<Vec<f64>>, Error> {
        let settled = self.find(task)?.filter(|found| found.outcome.is_settled());
        Ok(settled.map(|found| self.displacement(&found)))
    }

    fn response(&self, load: &Load) -> Option<Vec<f64>> {
        let norm = self.reduction.norm()?;
        let no_gap = vec![0.0; self.reduction.selection.kept.len()];
        let loading = load.swept(&self.reduction, &no_gap);
        let moved = match &self.reduction.condensation {
            Some(condensed) => condensed.free_displacement(&loading.sweep),
            None => norm.scaled_displacement(&loading.scaled(loading.unit)),
        };
        Some(self.expand(&loading, loading.unit, &moved))
    }

    fn walk(self: Arc<Self>, from: &Task, to: &[f64]) -> Result<Option<Walk>, Error> {
        self.walk_to(from, to)
    }

    fn held(&self, closed: &ContactSet, load: &[f64], gap: &[f64], _: &Watch) -> Result<Option<[Vec<f64>; 2]>, Error> {
        Ok(self.balanced(closed, load.to_vec(), gap))
    }

    fn factor_entries(&self) -> usize {
        self.reduction.condensation.as_ref().map_or(0, Condensation::factor_entries)
    }
}

impl Factored {
    /// Number of unknowns that the methods work on: the contact dofs if the problem is condensed, otherwise all.
    pub fn condensed_dofs(&self) -> usize {
        self.reduction.condensation.as_ref().map_or(self.problem.dofs(), |condensed| condensed.stiffness.dim())
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

    /// The result of a method, on the contact boundary if the problem is condensed; `None` if the step has no means
    /// here.
    pub(super) fn find(&self, task: &Task) -> Result<Option<Reduced>, Error> {
        self.check_gap(task.problem.gap())?;
        let gap = task.problem.gap().to_vec();
        let loading = task.load.swept(&self.reduction, &self.reduction.selection.gap(&gap));
        self.find_step(Loaded { loading, gap }, task)
    }

    /// The method of an attempt, which may leave it to the rules.
    fn chosen(&self, method: Option<ByFactor>) -> ByFactor {
        method.unwrap_or(self.method)
    }

    /// One run of a method, under a load at some gaps.
    pub(super) fn find_step(&self, Loaded { loading, gap }: Loaded, task: &Task) -> Result<Option<Reduced>, Error> {
        let Task { step, settings, .. } = *task;
        let method = self.chosen(task.method);
        let watch = self.watch_of_loop(method, &settings.watch)?;
        let (problem, unit) = self.scaled(&loading, &gap)?;
        let scaled = self.scaled_problem(&problem).watched(&watch);
        let start = task.start.contact_set.as_ref().map(|set| self.reduction.selection.restrict_set(set));
        let bound = |displacement: &[f64], multiplier: &[f64]| {
            let by = self.condensed_bounding(&problem, &settings.watch);
            let examined = problem.examine(&by, displacement, multiplier);
            let on_boundary = dot(displacement, &problem.stiffness().mul(displacement));
            let of_whole = self.share_of_boundary(&loading, unit, on_boundary);
            examined.map_or(f64::INFINITY, |examined| examined.certificate.energy_error_bound * of_whole)
        };
        let accuracy = settings.accuracy;
        let most_iterations = settings.max_iterations.min(task.limits.most_sets(self.set_seconds));
        let made = ScaledStep { scaled: &scaled, start, method, accuracy, most_iterations, bound: &bound };
        let outcome = made.outcome(step)?;
        let factor_seconds = scaled.factor_seconds();
        Ok(outcome.map(|outcome| Reduced { loading, problem, unit, outcome, factor_seconds }))
    }

    fn scaled_problem<'a>(&'a self, problem: &'a ContactProblem) -> ScaledProblem<'a> {
        let scaled = ScaledProblem::new(problem, &self.augmented, self.reduction.is_definite());
        scaled.with_compliance(self.reduction.compliance())
    }

    /// The means of a certificate of the problem that the methods work on.
    pub(super) fn condensed_bounding(&self, problem: &ContactProblem, watch: &Watch) -> Bounding<'static> {
        let norm = self.condensed_norm(problem).map(|norm| norm.watched(&watch.finishing()));
        norm.map_or(Bounding::OwnFactor, Bounding::Factor)
    }

    /// What was found in terms of the whole problem.
    fn whole(&self, found: Reduced) -> Found {
        let displacement = self.displacement(&found);
        let Reduced { unit, outcome, factor_seconds, .. } = found;
        let history = outcome.history.into_iter();
        let ending = match outcome.ending {
            Ending::Infeasible { rows, weights } => self.expand_contradiction(&rows, &weights),
            ending => ending,
        };
        let outcome = Outcome {
            displacement,
            multiplier: self.expand_multiplier(&outcome.multiplier, unit),
            contact_set: self.expand_set(&outcome.contact_set),
            history: history
                .map(|step| Iteration { contact_set: self.expand_set(&step.contact_set), ..step })
                .collect(),
            ending,
            ..outcome
        };
        Found { outcome, factor_seconds }
    }

    /// The rows of the whole problem that contradict each other, with their weights.
    fn expand_contradiction(&self, rows: &[usize], weights: &[f64]) -> Ending {
        let mut scaled = vec![0.0; self.reduction.selection.kept.len()];
        rows.iter().zip(weights).for_each(|(&row, &weight)| scaled[row] = weight);
        // Rows are scaled like multipliers; the unit of weights is free.
        let all = self.expand_multiplier(&scaled, self.reduction.scaling.equilibration.factor);
        let rows: Vec<usize> = rows.iter().map(|&row| self.reduction.selection.kept[row]).collect();
        let weights = rows.iter().map(|&row| all[row]).collect();
        Ending::Infeasible { rows, weights }
    }

    /// The best answer, changed by the repair that its bound computes. This helps if rows hold many dofs, or no dof
    /// except for rounding, and if forces cancel almost all of each other: then a step of a method has nothing left to
    /// improve. `None` without a factor at hand.
    fn repaired(&self, task: &Task, best: &Solution) -> Option<Found> {
        let norm = match &self.reduction.norm {
            Norm::Kept(norm) => norm.watched(&task.settings.watch.finishing()),
            _ => return None,
        };
        let (displacement, multiplier) = task.problem.repaired(&norm, &best.displacement, &best.multiplier)?;
        let contact_set = multiplier.iter().map(|&force| force < 0.0).collect();
        let at_rest = Outcome::at_rest(task.problem, Ending::Settled);
        Some(Found { outcome: Outcome { displacement, multiplier, contact_set, ..at_rest }, factor_seconds: 0.0 })
    }

    /// The energy norm of a stiffness that is definite by itself, with bounds that end when `watch` says so; `None`
    /// also if there is no time to make it.
    fn norm_within(&self, watch: &Watch) -> Option<EnergyNorm> {
        let in_time = self.reduction.is_norm_at_hand() || watch.allows(self.norm_seconds);
        if in_time { self.reduction.norm().map(|norm| norm.watched(watch)) } else { None }
    }

    /// A watch that is over as soon as there is no time left for one more factorisation of a loop and for the
    /// certificate.
    fn watch_of_loop(&self, method: ByFactor, watch: &Watch) -> Result<Watch, Error> {
        if watch.time_left().is_none() {
            return Ok(watch.clone());
        }
        let analysis = self.augmented.matrix()?.analysis();
        // If K is not definite, the start and the test of uniqueness factorise too.
        let factors = if self.reduction.is_definite() { 1.0 } else { SINGULAR };
        let of_loop = factors * seconds::factorisation(analysis);
        let (first, each) = match method {
            ByFactor::Qp(_) => {
                (2.0 * seconds::interior_point(analysis), seconds::interior_point(analysis).max(of_loop))
            }
            _ => (of_loop, of_loop),
        };
        check_time(watch, first)?;
        Ok(watch.keeping(each + seconds::certificate(&self.problem)))
    }

    /// The energy norm of the problem that the methods work on.
    pub(super) fn condensed_norm(&self, problem: &ContactProblem) -> Option<EnergyNorm> {
        if !self.is_condensed() || !self.reduction.is_definite() {
            return self.reduction.norm().map(|norm| norm.equilibrated());
        }
        let of_boundary = || {
            let unscaled = Equilibration::none(problem.dofs());
            let factor = {
                let augmented = self.augmented.matrix().ok()?;
                augmented.factor(augmented.matrix(|_| 0.0, 0.0)).ok()?
            };
            Some(EnergyNorm::new(factor, unscaled, (0..problem.dofs()).collect()))
        };
        self.condensed_norm.get_or_init(of_boundary).clone()
    }

    /// The ratio of the energy norm of a displacement of the condensed problem, of the square `on_boundary`, to that of
    /// the whole body.
    fn share_of_boundary(&self, loading: &Loading, unit: i32, on_boundary: f64) -> f64 {
        let Some(condensed) = &self.reduction.condensation else { return 1.0 };
        let interior = ldexp(condensed.interior_energy(&loading.sweep), 2 * (loading.unit - unit));
        if interior > 0.0 { (on_boundary / (on_boundary + interior)).max(0.0).sqrt() } else { 1.0 }
    }

    /// Displacement and multiplier under `load` (length n) with the rows of `closed` held at `gap` (one entry per row),
    /// pushing or pulling, and all others free; `None` if they do not hold the body, or contradict each other.
    pub(crate) fn balanced(&self, closed: &ContactSet, load: Vec<f64>, gap: &[f64]) -> Option<[Vec<f64>; 2]> {
        let loading = Loading::of(&self.reduction, &load, &self.reduction.selection.gap(gap));
        let (problem, unit) = self.scaled(&loading, gap).ok()?;
        let task = self.scaled_problem(&problem);
        let held = active_set::with_contact_set(&task, &self.reduction.selection.restrict_set(closed)).ok()??;
        Some([self.expand(&loading, unit, &held.displacement), self.expand_multiplier(&held.multiplier, unit)])
    }

    /// The displacement of the whole body.
    pub(super) fn displacement(&self, found: &Reduced) -> Vec<f64> {
        self.expand(&found.loading, found.unit, &found.outcome.displacement)
    }

    /// Rows that were without obstacle when the problem was prepared, and only these, must still be so.
    pub(super) fn check_gap(&self, gap: &[f64]) -> Result<(), Error> {
        let changes = |(gap, before): (&f64, &f64)| gap.is_finite() != before.is_finite();
        match gap.iter().zip(self.problem.gap()).position(changes) {
            None => Ok(()),
            Some(row) => {
                let allowed = "infinite in the same rows as when the problem was prepared";
                Err(Error::NotFinite { name: "gap vector", at: format!("entry {row}"), value: gap[row], allowed })
            }
        }
    }

    /// The problem that the methods work on, and the exponent of its reference displacement.
    fn scaled(&self, loading: &Loading, gap: &[f64]) -> Result<(ContactProblem, i32), Error> {
        let gap = self.reduction.selection.gap(gap);
        let unit = loading.unit_with(&self.reduction, &gap);
        let (stiffness, contact) = match &self.reduction.condensation {
            Some(condensed) => (&condensed.stiffness, &condensed.contact),
            None => (self.reduction.scaling.stiffness(), &self.reduction.scaling.contact),
        };
        let (load, gap) = (loading.scaled(unit), self.reduction.scaling.gap(&gap, unit));
        Ok((ContactProblem::computed(stiffness.clone(), load, contact.clone(), gap)?, unit))
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
