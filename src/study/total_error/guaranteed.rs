//! The total error with a guaranteed bound: a mesh refined where the elements contribute most to the bound, until it is small enough.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::goal::{Answering, Bound, Ended, MARKED, TotalErrorGoal, marked, shortage};
use crate::continuum::{Bracket, Judged, PlaneAnswer, PlaneProblem, Triangulation};
use crate::error::Error;
use crate::fem::assembly::internal_force;
use crate::qp::linear::dot;
use crate::qp::{Method, Settings, solve};
use crate::scene::{Answer, Model, Scene};
use crate::solution::Solution;
use crate::study::warnings::{check_motion, of_refined};
use crate::study::{AnswerWarning, Status};

/// The seconds of the next mesh over those of this one, approximately.
const GROWTH: f64 = 2.2;

/// One mesh of the search.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct TotalErrorLevel {
    /// Triangles.
    pub triangles: usize,
    /// Unknowns of the displacement.
    pub dofs: usize,
    /// Unknowns of the stress in balance.
    pub stress_dofs: usize,
    /// The bound on |u - v| / |v|.
    pub bound: f64,
    /// The bound on the error of the mean stress, over |v|.
    pub mean_stress_bound: f64,
    /// The contact force of the displacement, in force.
    pub contact_force: f64,
    /// The interval that contains the exact contact force, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_interval: Option<[f64; 2]>,
    /// Seconds since the start, including the interval of the force.
    pub seconds: f64,
    /// Seconds for the displacement on this mesh, and for the stress.
    pub displacement_seconds: f64,
    pub stress_seconds: f64,
}

/// The answer on a mesh, with its judgement.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct JudgedMesh {
    /// Its elements.
    pub element: &'static str,
    /// Its unknowns.
    pub dofs: usize,
    /// The bound on |u - w| / |w|, w its displacement.
    pub total_error: Bound,
    /// The error by recovered stresses: an estimate.
    pub estimated: f64,
}

impl JudgedMesh {
    /// The judgement of an answer of this norm, which is at most `distance` from the continuum.
    fn of(answer: &Answer, distance: f64, norm: f64) -> Result<Self, Error> {
        let model = answer.model();
        let bound = if distance == 0.0 { 0.0 } else { distance / norm };
        Ok(JudgedMesh {
            element: model.mesh().kind().name(),
            dofs: model.problem().dofs(),
            total_error: Bound { bound, guaranteed: true },
            estimated: answer.discretisation_error()?,
        })
    }
}

/// The body for which a bound holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Domain {
    /// The polygon of the first mesh.
    FirstPolygon,
    /// The polygon of the last mesh; its nodes on known circles lie on the circles.
    LastPolygon,
}

/// An answer with its guaranteed error against the continuum.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct TotalError {
    pub status: Status,
    pub goal: TotalErrorGoal,
    pub ended: Ended,
    /// The body for which the bounds hold.
    pub domain: Domain,
    /// |u - v| / |v| in the energy norm: u the exact displacement of that body, v the answer.
    pub total_error: Bound,
    /// |sigma - tau_m| / |v|: tau_m the mean of the stress of v and of the stress in balance.
    pub mean_stress_error: Bound,
    /// The interval that contains the exact potential energy: D(tau) and J(v), in force times length.
    pub potential_energy: [f64; 2],
    /// The sum of the contact forces of v.
    pub contact_force: f64,
    /// The part of the body that carries the force, as "per metre".
    pub force_basis: String,
    /// The interval that contains the exact contact force; `None` if obstacles come from several directions.
    pub force_interval: Option<[f64; 2]>,
    /// The largest relative defect found by the check of balance, signs and distances: rounding.
    pub defect: f64,
    /// The result on the scene's own mesh; `None` if that has no answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_mesh: Option<JudgedMesh>,
    /// The judgement of the answer on the last mesh; `None` without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_mesh: Option<JudgedMesh>,
    pub levels: Vec<TotalErrorLevel>,
    /// Warnings about the answer on the scene's own mesh that no finer mesh settles.
    pub warnings: Vec<AnswerWarning>,
    /// Triangles of the next mesh, if it was not made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_triangles: Option<usize>,
    pub seconds: f64,
    /// The displacement and the stresses.
    #[serde(skip)]
    pub answer: PlaneAnswer,
    /// The answer of `solve` on the last mesh, or the reason for which there is none: its rows are at nodes, those of the bound hold
    /// between them as well.
    #[serde(skip)]
    pub last: Result<Box<(Answer, Solution)>, String>,
    /// The meshes, from the first to the last.
    #[serde(skip)]
    pub meshes: Vec<Triangulation>,
}

/// A function that is called with what was found, after each mesh but the last.
pub(crate) type Keep<'a> = &'a dyn Fn(&TotalError);

/// Refines the mesh of a plane problem until its total error is small enough, or time or memory end.
///
/// # Errors
/// Those of [`crate::solve`] on the first mesh; [`Error::Scene`] for a bound of the force with obstacles from several directions.
pub(super) fn total_error(
    scene: &Scene,
    problem: &PlaneProblem,
    mesh: Triangulation,
    model: &Arc<Model>,
    goal: TotalErrorGoal,
    settings: &Settings,
    keep: Keep,
) -> Result<TotalError, Error> {
    if goal.force_error.is_some() && !problem.has_one_direction() {
        let message =
            "the contact force has a guaranteed interval only if all obstacles lie in one direction from the body";
        return Err(Error::Scene { path: "obstacles".into(), message: message.into() });
    }
    // A stress in balance requires a linear solve with a settled contact set; other methods do not give one.
    let method = if settings.method == Method::Auto { Method::ActiveSet } else { settings.method };
    let search =
        Search { problem, model, goal, settings: Settings { method, ..settings.clone() }, keep, clock: Instant::now() };
    let found = search.run(mesh)?;
    settings.watch.step("answer", 0);
    let last = on_last_mesh(scene, model, &found, settings);
    let last_mesh = last.as_ref().ok().map(|last| last.1);
    let seconds = search.clock.elapsed().as_secs_f64();
    Ok(TotalError {
        last: last.map(|last| Box::new(last.0)).map_err(|error| error.to_string()),
        last_mesh,
        seconds,
        ..found
    })
}

/// The answer to the scene on the last mesh, and its distance from the continuum: that of the displacement of the bound, plus the one from
/// that displacement.
fn on_last_mesh(
    scene: &Scene,
    first: &Model,
    found: &TotalError,
    settings: &Settings,
) -> Result<((Answer, Solution), JudgedMesh), Error> {
    let model = Arc::new(scene.on_last_mesh(first, &found.answer)?);
    let solution = solve(model.problem(), settings)?;
    let answer = Answer::of(model.clone(), &solution)?;
    let size = |displacement: &[f64]| -> Result<f64, Error> {
        Ok(dot(displacement, &internal_force(model.body(), displacement)?).max(0.0).sqrt())
    };
    let of_bound = found.answer.displacement.as_flattened();
    let away: Vec<f64> = answer.displacement().iter().zip(of_bound).map(|(own, other)| own - other).collect();
    let distance = found.total_error.bound * size(of_bound)? + size(&away)?;
    let judged = JudgedMesh::of(&answer, distance, size(answer.displacement())?)?;
    Ok(((answer, solution), judged))
}

/// The data that stay the same from mesh to mesh.
struct Search<'a> {
    problem: &'a PlaneProblem,
    model: &'a Arc<Model>,
    goal: TotalErrorGoal,
    settings: Settings,
    keep: Keep<'a>,
    clock: Instant,
}

impl Search<'_> {
    fn run(&self, first: Triangulation) -> Result<TotalError, Error> {
        let mut found: Option<TotalError> = None;
        let (mut next, mut own, mut touching) = (first, None, None);
        let mut answering = Answering::new();
        loop {
            let mesh = next;
            self.settings.watch.step("mesh", found.as_ref().map_or(0, |found| found.levels.len()));
            let last = found.as_ref().and_then(|found| found.levels.last());
            let settings = self.keeping(last.map_or(0.0, |last| last.displacement_seconds));
            let bracket = match Bracket::new(self.problem, &mesh, touching.as_deref(), &settings) {
                Ok(bracket) => bracket,
                Err(error) => return self.cut_short(found, error, mesh.triangles.len()),
            };
            let level = self.level(&bracket)?;
            let before = found.as_ref().and_then(|found| found.levels.last()).map_or(0.0, |last| last.seconds);
            let is_late = !self.settings.watch.allows(GROWTH * (level.seconds - before + level.displacement_seconds));
            let (is_first, is_met) = (found.is_none(), self.is_met(&level));
            let mut now = self.with_level(found, &bracket, level);
            // An obstacle that just touches presses less from mesh to mesh.
            let components = now.answer.displacement.iter().flatten();
            check_motion(self.model, components.fold(0.0, |largest: f64, part| largest.max(part.abs())))?;
            if let Some((answer, warnings)) = if is_first { self.own_answer()? } else { None } {
                (own, now.warnings) = (Some(answer), warnings);
            }
            // The answer on the scene's own mesh belongs to the polygon of the first mesh.
            if is_first || !self.problem.has_circles() && (is_met || is_late) {
                let judged_by = |own: &Answer| {
                    let Judged { bound, norm, .. } = judged(own, &bracket);
                    JudgedMesh::of(own, bound, norm)
                };
                now.own_mesh = own.as_ref().map(judged_by).transpose()?;
            }
            now.seconds = self.clock.elapsed().as_secs_f64();
            if is_met {
                now.meshes.push(mesh);
                return Ok(TotalError { status: Status::Certified, ended: Ended::Goal, ..now });
            }
            // The force converges at its own rate.
            let goal = if self.goal.force_error.is_some() { 0.0 } else { self.goal.total_error };
            let share = answering.share(bracket.bound(), goal);
            next = self.problem.refined(&mesh, &marked(&bracket.shares, share));
            touching = Some(next.carried(bracket.touching()));
            now.next_triangles = Some(next.triangles.len());
            now.meshes.push(mesh);
            if is_late {
                return Ok(now);
            }
            (self.keep)(&now);
            found = Some(now);
        }
    }

    /// The settings with a deadline that leaves the time for the answer on the last mesh, which takes as long as its displacement.
    fn keeping(&self, displacement_seconds: f64) -> Settings {
        Settings { watch: self.settings.watch.keeping(GROWTH * displacement_seconds), ..self.settings.clone() }
    }

    /// The result before an error for lack of memory or time; any other error.
    fn cut_short(&self, found: Option<TotalError>, error: Error, triangles: usize) -> Result<TotalError, Error> {
        let (Some(found), Some(ended)) = (found, shortage(&error)) else { return Err(error) };
        let seconds = self.clock.elapsed().as_secs_f64();
        Ok(TotalError { ended, next_triangles: Some(triangles), seconds, ..found })
    }

    /// The result after one more mesh, as if the time ended with it, without the mesh itself.
    fn with_level(&self, found: Option<TotalError>, bracket: &Bracket, level: TotalErrorLevel) -> TotalError {
        let (own_mesh, mut levels, meshes, warnings) =
            found.map_or_else(Default::default, |found| (found.own_mesh, found.levels, found.meshes, found.warnings));
        levels.push(level.clone());
        TotalError {
            status: Status::NotCertified,
            goal: self.goal,
            ended: Ended::Time,
            domain: if self.problem.has_circles() { Domain::LastPolygon } else { Domain::FirstPolygon },
            total_error: Bound { bound: level.bound, guaranteed: true },
            mean_stress_error: Bound { bound: level.mean_stress_bound, guaranteed: true },
            potential_energy: [bracket.energy_of_stress(), bracket.energy_of_displacement()],
            contact_force: level.contact_force,
            force_basis: self.model.basis_of_forces(),
            force_interval: level.force_interval,
            warnings,
            defect: bracket.defect,
            next_triangles: None,
            own_mesh,
            last_mesh: None,
            last: Err("it is not computed yet".into()),
            seconds: level.seconds,
            levels,
            answer: bracket.answer(),
            meshes,
        }
    }

    /// The answer on the scene's own mesh and its warnings; `None` without an answer.
    ///
    /// # Errors
    /// Those of [`of_refined`].
    fn own_answer(&self) -> Result<Option<(Answer, Vec<AnswerWarning>)>, Error> {
        let Ok(solution) = solve(self.model.problem(), &self.settings) else { return Ok(None) };
        let Ok(answer) = Answer::of(self.model.clone(), &solution) else { return Ok(None) };
        let warnings = of_refined(&answer, &solution)?;
        Ok(Some((answer, warnings)))
    }

    /// The numbers of a mesh; the interval of the force if it is requested, or if nothing else is.
    fn level(&self, bracket: &Bracket) -> Result<TotalErrorLevel, Error> {
        let is_near = bracket.bound() <= self.goal.total_error || self.goal.force_error.is_some();
        let is_last = is_near || self.settings.watch.time_left().is_some();
        let force_interval = if is_last { bracket.force_interval()? } else { None };
        Ok(TotalErrorLevel {
            triangles: bracket.mesh.triangles.len(),
            dofs: bracket.primal.unknowns.free,
            stress_dofs: bracket.dual.unknowns.free,
            bound: bracket.bound(),
            mean_stress_bound: bracket.bound_of_mean(),
            contact_force: bracket.force(),
            force_interval,
            seconds: self.clock.elapsed().as_secs_f64(),
            displacement_seconds: bracket.primal.seconds,
            stress_seconds: bracket.dual.seconds,
        })
    }

    fn is_met(&self, level: &TotalErrorLevel) -> bool {
        let force_met = self.goal.force_error.is_none_or(|wanted| half_width(level).is_some_and(|half| half <= wanted));
        level.bound <= self.goal.total_error && force_met
    }
}

/// Judges an answer by a bracket on pieces of its elements.
fn judged(answer: &Answer, bracket: &Bracket) -> Judged {
    bracket.judged(|element| {
        let strain = answer.model().body().strain_in(answer.displacement(), element);
        move |[x, y]| {
            let [xx, yy, _, xy, ..] = strain([x, y, 0.0]);
            [xx, yy, xy]
        }
    })
}

/// Half the width of the interval of the force, over the force; `None` without an interval.
pub(crate) fn half_width(level: &TotalErrorLevel) -> Option<f64> {
    let [low, high] = level.force_interval?;
    Some(if high > low { (high - low) / 2.0 / level.contact_force.abs() } else { 0.0 })
}

/// The data of one mesh for a study of the guarantee.
#[derive(Clone, Debug)]
pub struct Examined {
    /// D(tau) and J(v): the exact energy lies between them.
    pub energies: [f64; 2],
    /// The bound on |u - v|.
    pub bound: f64,
    /// |v|.
    pub norm: f64,
    /// The force of v.
    pub force: f64,
    /// The interval of the force.
    pub force_interval: Option<[f64; 2]>,
    /// The answer w on the scene's own mesh: an upper bound of |u - w|, then |v - w| and |w|.
    pub own: [f64; 3],
    /// Unknowns of v.
    pub dofs: usize,
}

/// Brackets on the mesh of a scene and on `levels` finer ones, for a study of the guarantee.
///
/// # Errors
/// Those of the total error.
pub fn examined(scene: &Scene, levels: usize) -> Result<Vec<Examined>, Error> {
    let model = Arc::new(scene.build()?);
    let (problem, mut mesh) = scene.plane_problem(&model)?;
    let settings = Settings::with_method(Method::ActiveSet);
    let own = Answer::of(model.clone(), &solve(model.problem(), &settings)?)?;
    let mut found = Vec::with_capacity(levels + 1);
    for level in 0..=levels {
        let bracket = Bracket::new(&problem, &mesh, None, &settings)?;
        let judged = judged(&own, &bracket);
        found.push(Examined {
            energies: [bracket.energy_of_stress(), bracket.energy_of_displacement()],
            bound: (2.0 * bracket.distance().max(0.0)).sqrt(),
            norm: bracket.energy.sqrt(),
            force: bracket.force(),
            force_interval: bracket.force_interval()?,
            own: [judged.bound, judged.from_displacement, judged.norm],
            dofs: bracket.primal.unknowns.free,
        });
        if level < levels {
            mesh = mesh.refined(&marked(&bracket.shares, MARKED), |_, middle| middle);
        }
    }
    Ok(found)
}
