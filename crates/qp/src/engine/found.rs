//! The steps on a factor: a load is swept, the problem scaled, solved by a method, and what it finds expanded again.

use std::sync::Arc;

use super::factored::{Factored, Load, Loading, Norm};
use crate::certificate::{self, Bounding, EnergyNorm, Examination};
use crate::error::{Error, LinearError, Result};
use crate::linear::watch::Watch;
use crate::linear::{dot, ldexp};
use crate::method::interior_point::{self, InteriorPoint};
use crate::method::mprgp::Limits;
use crate::method::parametric::{Event, ParametricLcp, Piece};
use crate::method::penalty::{self, AccuracyGoal, Penalty};
use crate::method::{Ending, Outcome, ScaledProblem, Start, active_set, dual_active_set};
use crate::plan::{PATIENCE, Step};
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{Certificate, ContactSet, Iteration, Solution};

pub struct Task<'a> {
    pub step: Step,
    /// The problem under some load, at some gaps.
    pub problem: &'a ContactProblem,
    pub load: &'a Load,
    pub start: &'a Start,
    pub limits: Limits,
    /// Accuracy, limits and a running clock, with the method of the attempt.
    pub settings: &'a Settings,
    /// The best answer of the steps before this one; `None` without one.
    pub best: Option<&'a Solution>,
}

/// The outcome of a step, by a method from a set if one is known; `None` if the step has no means here.
fn outcome(
    step: Step,
    scaled: &ScaledProblem,
    (method, start): (Method, Option<ContactSet>),
    most_iterations: usize,
    goal: Option<AccuracyGoal>,
) -> Result<Option<Outcome>> {
    match step {
        Step::Method => by_method(scaled, (method, start), most_iterations, goal).map(Some),
        Step::InteriorPoint => {
            let found = by_method(scaled, (Method::qp(), None), most_iterations, None)?;
            Ok(Some(named(found, "-interior-point")))
        }
        Step::Continuation => continued(scaled, start, most_iterations).map(Some),
        Step::Dual => dual_active_set::solve(scaled),
        _ => Ok(None),
    }
}

fn by_method(
    scaled: &ScaledProblem,
    (method, start): (Method, Option<ContactSet>),
    most_iterations: usize,
    goal: Option<AccuracyGoal>,
) -> Result<Outcome> {
    let Some(cold) = scaled.start()? else { return Ok(Outcome::at_rest(scaled.problem, Ending::Unheld)) };
    let by_sets = |start: ContactSet| active_set::solve(scaled, start, most_iterations.min(PATIENCE));
    match (method, start) {
        (Method::Qp(InteriorPoint { polish: true, .. }), Some(start)) => Ok(named(by_sets(start)?, "-warm")),
        (Method::Qp(InteriorPoint { polish, tolerance }), _) => {
            let found = interior_point::solve(scaled, tolerance)?;
            match polish {
                // The multipliers become those of a linear solve.
                true => Ok(Outcome { iterations: found.iterations, ..by_sets(found.contact_set)? }),
                false => Ok(found),
            }
        }
        (Method::Penalty(ladder), start) => {
            penalty::solve(scaled, ladder, start.unwrap_or(cold), most_iterations, goal)
        }
        (_, start) => by_sets(start.unwrap_or(cold)),
    }
}

/// The active-set loop, started again from the set that the penalty ladder reaches.
///
/// On fine meshes a contact zone that starts too wide shrinks by one row an iteration. A penalty that grows from the
/// stiffness to its best value reaches the zone in few iterations on every mesh. Along a chain of m rows the ladder
/// takes nearly `3 sqrt(m)` sets; one that takes more wanders, and ends where it is.
///
/// # Source
/// K. Ito and K. Kunisch, *Semi-smooth Newton methods for variational inequalities of the first kind*, ESAIM: M2AN 37
/// (2003) 41-62.
fn continued(scaled: &ScaledProblem, start: Option<ContactSet>, most_iterations: usize) -> Result<Outcome> {
    let ladder = Penalty { penetration_threshold: 0.0, ..Penalty::default() };
    let start = start.unwrap_or_else(|| ContactSet::open(scaled.problem.rows()));
    let most_on_ladder = most_iterations.min(PATIENCE.max(3 * scaled.problem.rows().isqrt()));
    let approach = penalty::solve(scaled, ladder, start, most_on_ladder, None)?;
    if scaled.watch.is_over() {
        return Ok(Outcome { ending: Ending::Unsettled, variant: "-unsettled", ..approach });
    }
    let most_iterations = most_iterations.saturating_sub(approach.iterations).max(1);
    let second = active_set::solve(scaled, approach.contact_set.clone(), most_iterations)?;
    Ok(named(second, "-continuation").after(approach))
}

/// An outcome with this variant, if it has settled.
fn named(outcome: Outcome, variant: &'static str) -> Outcome {
    Outcome { variant: if outcome.is_settled() { variant } else { outcome.variant }, ..outcome }
}

/// The result of a method on the unknowns of the engine, with its load and gaps.
#[derive(Clone, Debug)]
pub struct Reduced {
    loading: Arc<Loading>,
    problem: ContactProblem,
    pub unit: i32,
    pub outcome: Outcome,
    factor_seconds: f64,
}

/// The stretches of a path, the events at which rows touch and release, and the exponent of the unit of both.
type Walk = (Vec<Piece>, Vec<Event>, i32);

/// The result of a method, on the boundary if the problem is condensed; `None` if the step has no means here.
pub fn find(engine: &Factored, task: &Task) -> Result<Option<Reduced>> {
    check_gap(engine, task.problem.gap())?;
    let gap = task.problem.gap();
    find_under(engine, task.load.swept(engine, &engine.selection.gap(gap)), gap, task)
}

fn find_under(engine: &Factored, loading: Arc<Loading>, gap: &[f64], task: &Task) -> Result<Option<Reduced>> {
    let Task { settings, .. } = *task;
    let method = engine.chosen(settings.method);
    let watch = engine.watch_of_loop(method, &settings.watch)?;
    let (problem, unit) = scaled(engine, &loading, gap)?;
    let scaled = scaled_problem(engine, &problem, watch);
    let start = task.start.contact_set.as_ref().map(|set| engine.selection.restrict_set(set));
    let bound = |displacement: &[f64], multiplier: &[f64]| {
        let by = engine.condensed_bounding(&problem, &settings.watch);
        let examined = Examination::of(&problem, [displacement, multiplier], &by).and_then(|of| of.certificate());
        let on_boundary = dot(displacement, &problem.stiffness().mul(displacement));
        let of_whole = loading.share_of_boundary(engine, unit, on_boundary);
        examined.map_or(f64::INFINITY, |examined| examined.certificate.energy_error_bound * of_whole)
    };
    let most_iterations = settings.max_iterations.min(task.limits.most_sets(engine.tried.set_seconds));
    let goal = settings.accuracy.map(|accuracy| (accuracy, &bound as _));
    let outcome = outcome(task.step, &scaled, (method, start), most_iterations, goal)?;
    let factor_seconds = scaled.factor_seconds.get();
    Ok(outcome.map(|outcome| Reduced { loading, problem, unit, outcome, factor_seconds }))
}

fn scaled_problem<'a>(engine: &'a Factored, problem: &'a ContactProblem, watch: Watch) -> ScaledProblem<'a> {
    let (augmented, is_definite, compliance) = (&engine.augmented, engine.is_definite(), engine.compliance());
    let (swept_load, factor_seconds) = Default::default();
    ScaledProblem { problem, is_definite, augmented, compliance, swept_load, factor_seconds, watch }
}

/// The problem that the methods work on, and the exponent of its reference displacement.
fn scaled(engine: &Factored, loading: &Loading, gap: &[f64]) -> Result<(ContactProblem, i32)> {
    let gap = engine.selection.gap(gap);
    let unit = loading.unit_with(engine, &gap);
    let (stiffness, contact) = match &engine.condensation {
        Some(condensed) => (&condensed.stiffness, &condensed.contact),
        None => (engine.scaling.stiffness(), &engine.scaling.contact),
    };
    let (load, gap) = (loading.scaled(unit), engine.scaling.gap(&gap, unit));
    Ok((ContactProblem::computed(stiffness.clone(), load, contact.clone(), gap)?, unit))
}

/// Rows that were without obstacle when the problem was prepared, and only these, must still be so.
fn check_gap(engine: &Factored, gap: &[f64]) -> Result<()> {
    let changes = |(gap, before): (&f64, &f64)| gap.is_finite() != before.is_finite();
    match gap.iter().zip(engine.problem.gap()).position(changes) {
        None => Ok(()),
        Some(row) => {
            let allowed = "infinite in the same rows as when the problem was prepared";
            Err(LinearError::NotFinite { name: "gap vector", at: format!("entry {row}"), value: gap[row], allowed }
                .into())
        }
    }
}

pub fn displacement(engine: &Factored, found: &Reduced) -> Vec<f64> {
    found.loading.expand(engine, found.unit, &found.outcome.displacement)
}

pub fn whole(engine: &Factored, found: Reduced) -> (Outcome, f64) {
    let displacement = displacement(engine, &found);
    let Reduced { unit, outcome, factor_seconds, .. } = found;
    let history = outcome.history.into_iter();
    let ending = match outcome.ending {
        Ending::Infeasible { rows, weights } => expand_contradiction(engine, &rows, &weights),
        ending => ending,
    };
    let outcome = Outcome {
        displacement,
        multiplier: engine.expand_multiplier(&outcome.multiplier, unit),
        contact_set: engine.selection.expand_set(&outcome.contact_set),
        history: history
            .map(|step| Iteration { contact_set: engine.selection.expand_set(&step.contact_set), ..step })
            .collect(),
        ending,
        ..outcome
    };
    (outcome, factor_seconds)
}

/// The rows of the whole problem that contradict each other, with their weights.
fn expand_contradiction(engine: &Factored, rows: &[usize], weights: &[f64]) -> Ending {
    let mut scaled = vec![0.0; engine.selection.kept.len()];
    rows.iter().zip(weights).for_each(|(&row, &weight)| scaled[row] = weight);
    // Rows are scaled like multipliers; the unit of weights is free.
    let all = engine.expand_multiplier(&scaled, engine.scaling.equilibration.factor);
    let rows: Vec<usize> = rows.iter().map(|&row| engine.selection.kept[row]).collect();
    let weights = rows.iter().map(|&row| all[row]).collect();
    Ending::Infeasible { rows, weights }
}

/// The best answer, changed by the repair that its bound computes. This helps if rows hold many dofs, or no dof
/// except for rounding, and if forces cancel almost all of each other: then a step of a method has nothing left to
/// improve. `None` without a factor at hand.
pub fn repaired(engine: &Factored, task: &Task, best: &Solution) -> Option<(Outcome, f64)> {
    let Norm::Kept(norm) = &engine.norm else { return None };
    let norm = norm.watched(&task.settings.watch.finishing());
    let (displacement, multiplier) = certificate::repaired(task.problem, &norm, &best.displacement, &best.multiplier)?;
    let contact_set = multiplier.iter().map(|&force| force < 0.0).collect();
    let at_rest = Outcome::at_rest(task.problem, Ending::Settled);
    Some((Outcome { displacement, multiplier, contact_set, ..at_rest }, 0.0))
}

/// The step d from an answer (u, lambda): the answer for its residual, from its set, with the whole multiplier.
fn step_from(engine: &Factored, task: &Task, answer: &Solution) -> Result<Option<Reduced>> {
    let Solution { displacement: u, multiplier, contact_set, .. } = answer;
    // The contact force is balanced on its own dofs; only the imbalance is swept.
    let imbalance = task.problem.accurate_residual(u, multiplier);
    let contact = task.problem.contact().mul_transposed(multiplier);
    let released: Vec<f64> = contact.iter().map(|force| -force).collect();
    let gap: Vec<f64> = task.problem.accurate_violation(u).iter().map(|violation| -violation).collect();
    let selected = engine.selection.gap(&gap);
    let loading = match engine.condensation {
        Some(_) => Loading::of(engine, &imbalance, &selected).with_contact_force(engine, &released),
        None => {
            let rest: Vec<f64> = imbalance.iter().zip(&released).map(|(r, b)| r + b).collect();
            Loading::of(engine, &rest, &selected)
        }
    };
    find_under(engine, Arc::new(loading), &gap, &Task { step: Step::Method, start: &contact_set.into(), ..*task })
}

/// The best answer, refined by one step. `None` if its residual has no answer: it may still be good enough.
///
/// With the factor K~, of the digits that condensation and bending leave, a step solves the problem for the residual,
///
/// ```text
/// minimise 1/2 d' K~ d - (f - K u)' d   subject to   B d <= g - B u
/// ```
///
/// condensed, by the same method, and adds d to u. The residual is computed with twice the working precision. If d is
/// zero, the conditions are those of the problem itself; until then the error shrinks by `|I - K~^-1 K|` from step to
/// step.
pub fn refined(engine: &Factored, task: &Task, best: &Solution) -> Option<(Outcome, f64)> {
    task.settings.watch.step("refinement", 0);
    let Ok(Some(step)) = step_from(engine, task, best) else { return None };
    let moved = displacement(engine, &step);
    let outcome = Outcome {
        displacement: best.displacement.iter().zip(&moved).map(|(u, d)| u + d).collect(),
        multiplier: engine.expand_multiplier(&step.outcome.multiplier, step.unit),
        contact_set: engine.selection.expand_set(&step.outcome.contact_set),
        ..Outcome::at_rest(task.problem, Ending::Settled)
    };
    Some((outcome, step.factor_seconds))
}

/// Displacement and multiplier under `load` (length n) with the rows of `closed` held at `gap` (one entry per row),
/// pushing or pulling, and all others free; `None` if they do not hold the body, or contradict each other.
pub fn balanced(engine: &Factored, closed: &ContactSet, load: &[f64], gap: &[f64]) -> Option<[Vec<f64>; 2]> {
    let loading = Loading::of(engine, load, &engine.selection.gap(gap));
    let (problem, unit) = scaled(engine, &loading, gap).ok()?;
    let task = scaled_problem(engine, &problem, Watch::default());
    let held = active_set::with_contact_set(&task, &engine.selection.restrict_set(closed)).ok()??;
    Some([loading.expand(engine, unit, &held.displacement), engine.expand_multiplier(&held.multiplier, unit)])
}

/// The displacement without a certificate; `None` if the method did not settle on a set.
pub fn settled(engine: &Factored, task: &Task) -> Result<Option<Vec<f64>>> {
    let settled = find(engine, task)?.filter(|found| found.outcome.is_settled());
    Ok(settled.map(|found| displacement(engine, &found)))
}

/// The displacement that a load causes if no row is closed; `None` without a factor of a definite stiffness.
pub fn response(engine: &Factored, load: &Load) -> Option<Vec<f64>> {
    let norm = engine.norm()?;
    let loading = load.swept(engine, &vec![0.0; engine.selection.kept.len()]);
    let moved = match &engine.condensation {
        Some(condensed) => condensed.free_displacement(&loading.sweep),
        None => norm.equilibrated().displacement(&loading.scaled(loading.unit)),
    };
    Some(loading.expand(engine, loading.unit, &moved))
}

/// The result of the method with the certificate of the condensed problem; `None` if that does not meet the goal.
pub fn on_boundary(engine: &Factored, task: &Task, is_bounded: bool) -> Result<Option<(Reduced, Certificate)>> {
    let settings = task.settings;
    let Some(found) = find(engine, task)? else { return Ok(None) };
    let Reduced { problem, outcome, .. } = &found;
    let by = if is_bounded { engine.condensed_bounding(problem, &settings.watch) } else { Bounding::Nothing };
    let answer = [&*outcome.displacement, &outcome.multiplier];
    let certificate = Examination::of(problem, answer, &by)?.certificate()?.certificate;
    let is_met = match is_bounded {
        true => settings.goal().is_met_by(&certificate),
        false => certificate.conditions_hold(settings.goal().tolerance),
    };
    Ok(is_met.then_some((found, certificate)))
}

/// The exact way from the answer of a task to that at the gaps `to`; `None` if no answer meets its goal.
pub fn walk(engine: &Factored, from: &Task, to: &[f64]) -> Result<Option<Walk>> {
    let contact = engine.selection.contact(engine.problem.contact());
    let norm = engine.norm().map(|norm| norm.keeping(&contact));
    let (Some(condensed), Some(compliance)) = (&engine.condensation, norm.as_ref().and_then(EnergyNorm::compliance))
    else {
        return Err(Error::NotCondensed { step: "the exact path" });
    };
    check_gap(engine, to)?;
    let Some((found, _)) = on_boundary(engine, from, true)? else { return Ok(None) };
    let Reduced { loading, unit, problem, outcome, .. } = &found;
    let free = condensed.contact.mul(&condensed.free_displacement(&loading.sweep));
    let at_end = engine.scaling.gap(&engine.selection.gap(to), *unit);
    let constant = free.iter().zip(problem.gap()).map(|(&free, gap)| ldexp(free, loading.unit - unit) - gap).collect();
    let slope = problem.gap().iter().zip(&at_end).map(|(first, last)| first - last).collect();
    let path = ParametricLcp { matrix: compliance.matrix(), constant, slope };
    let (pieces, mut events) = path.walk(&outcome.contact_set, &from.settings.watch)?;
    events.iter_mut().for_each(|event| event.row = engine.selection.kept[event.row]);
    Ok(Some((pieces, events, *unit)))
}
