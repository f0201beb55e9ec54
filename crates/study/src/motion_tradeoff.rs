//! The cost of accuracy in a motion: every scheme at several steps, timed, against the same mesh at a far smaller step;
//! estimated errors from half the step and half the cells.

use std::time::Instant;

use super::motion::MotionSummary;
use super::tradeoff::{Tradeoff, relative};
use serde::Serialize;
use signorini_mechanics::Error;
use signorini_mechanics::motion::{Integrator, SchemeSpec};
use signorini_mechanics::scene::input::schema::AnalysisSpec;
use signorini_mechanics::scene::{Dynamics, Model, Scene};
use signorini_qp as qp;
use signorini_qp::Settings;

/// Times at which displacements are compared.
const SAMPLES: usize = 20;

/// Numbers of steps of an implicit scheme, and of the reference, over a quarter of those of the scene.
const QUARTERS: [usize; 4] = [1, 2, 4, 8];
const REFERENCE: usize = 32;

/// Numbers of steps of the explicit scheme over the smallest stable number.
const EXPLICIT: [usize; 2] = [1, 2];

/// One scheme at one length of its step, with its seconds and its errors against a reference of smaller steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionPoint {
    /// Name of the scheme in scenes, as `fox-goodwin`.
    pub scheme: &'static str,
    /// Length of each step, in time.
    pub step: f64,
    /// Number of steps of the scheme at this length of the step.
    pub steps: usize,
    /// Seconds from the assembled problem to the last step.
    pub seconds: f64,
    /// Root mean square error of the displacement at the sampled times, relative to the motion of the reference.
    pub displacement_error: f64,
    /// Relative error of the impulse; zero if both impulses are zero.
    pub impulse_error: f64,
    /// Energy at the end minus that at the start, over the largest kinetic and strain energy.
    pub energy_change: f64,
    /// Deepest penetration of a row in the whole motion, in length.
    pub penetration: f64,
    /// `true` if the point is on the Pareto front: no other point is both faster and more accurate.
    pub best: bool,
}

/// A motion computed by every scheme at several steps, each compared with a reference of smaller steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionTradeoff {
    /// Number of unknown displacements n.
    pub dofs: usize,
    /// Length of each step of the reference, in time, which uses the scheme `fox-goodwin`.
    pub reference_step: f64,
    /// One entry for each scheme and length of a step, scheme by scheme.
    pub points: Vec<MotionPoint>,
}

impl MotionTradeoff {
    /// Runs a scene with a motion by every scheme at several steps.
    ///
    /// A run that fails has an infinite error. If the watch of `settings` is asked to stop, the result holds the points
    /// of the completed runs.
    ///
    /// # Errors
    /// As [`Scene::build`] and [`Scene::dynamics`]; [`Error::Scene`] for a scene without a motion;
    /// [`qp::Error::Interrupted`] if no run was completed.
    pub fn of(scene: &Scene, settings: &Settings) -> Result<Self, Error> {
        let model = scene.build()?;
        let own = scene.dynamics(&model)?.ok_or_else(still)?;
        // The samples coincide with steps.
        let quarter = own.steps.div_ceil(4 * SAMPLES).max(1);
        let of = |scheme, steps: usize| with(scene, &model, scheme, Some(steps));
        let reference = run(of(SchemeSpec::default(), SAMPLES * quarter * REFERENCE)?, settings)?;
        let (mut runs, impulse) = (Vec::new(), reference.summary.contact.impulse);
        let follows = |scheme: &SchemeSpec| own.obstacles.is_empty() || scheme.with(None).about().follows_obstacles;
        for scheme in SchemeSpec::ALL.into_iter().filter(follows) {
            let counts: Vec<usize> = if scheme.is_explicit() {
                let fewest = with(scene, &model, scheme, None)?.steps.div_ceil(SAMPLES);
                EXPLICIT.iter().map(|times| SAMPLES * fewest * times).collect()
            } else {
                QUARTERS.iter().map(|quarters| SAMPLES * quarter * quarters).collect()
            };
            runs.extend(counts.into_iter().map(|steps| (scheme, steps)));
        }
        let mut points = Vec::new();
        for (index, &(scheme, steps)) in runs.iter().enumerate() {
            settings.watch.part("run", index + 1, runs.len());
            let dynamics = of(scheme, steps)?;
            let (name, step) = (dynamics.scheme.name(), dynamics.step);
            let found = match run(dynamics, settings) {
                Err(_) if settings.watch.acknowledge() => break,
                found => found.unwrap_or_default(),
            };
            points.push(MotionPoint {
                scheme: name,
                step,
                steps,
                seconds: found.seconds,
                displacement_error: found.error(&reference),
                impulse_error: relative(found.summary.contact.impulse - impulse, impulse),
                energy_change: found.summary.energy_change(),
                penetration: found.summary.penetration_max,
                best: false,
            });
        }
        if points.is_empty() {
            return Err(qp::Error::Interrupted.into());
        }
        let costs: Vec<[f64; 2]> = points.iter().map(|point| [point.seconds, point.displacement_error]).collect();
        points.iter_mut().zip(Tradeoff::on_front(&costs)).for_each(|(point, best)| point.best = best);
        let steps = SAMPLES * quarter * REFERENCE;
        let duration = own.step * own.steps as f64;
        Ok(MotionTradeoff { dofs: model.problem().dofs(), reference_step: duration / steps as f64, points })
    }
}

#[derive(Default)]
struct SampledMotion {
    seconds: f64,
    samples: Vec<Vec<f64>>,
    first: Vec<f64>,
    summary: MotionSummary,
}

impl SampledMotion {
    fn error(&self, reference: &SampledMotion) -> f64 {
        if self.samples.len() != reference.samples.len() {
            return f64::INFINITY;
        }
        let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let away: f64 = self.samples.iter().zip(&reference.samples).map(|(a, b)| square(a, b)).sum();
        let way: f64 = reference.samples.iter().map(|sample| square(sample, &reference.first)).sum();
        relative(away.sqrt(), way.sqrt())
    }
}

fn run(dynamics: Dynamics, settings: &Settings) -> Result<SampledMotion, Error> {
    let clock = Instant::now();
    let Dynamics { problem, scheme, step, steps, windows, .. } = dynamics;
    let first = problem.displacement().to_vec();
    let mut integrator = Integrator::new(problem, scheme, step, settings)?;
    let mut summary = MotionSummary::starting(&integrator.observe(), 0, windows, step);
    let mut samples = Vec::with_capacity(SAMPLES);
    for number in 1..=steps {
        integrator.advance()?;
        summary.add(&integrator.observe(), &[]);
        if number % (steps / SAMPLES).max(1) == 0 {
            samples.push(integrator.state().displacement.clone());
        }
    }
    Ok(SampledMotion { seconds: clock.elapsed().as_secs_f64(), samples, first, summary })
}

/// The motion of the scene by a scheme with its own form of the mass, in this number of steps or in the default number.
fn with(scene: &Scene, model: &Model, scheme: SchemeSpec, steps: Option<usize>) -> Result<Dynamics, Error> {
    let mut scene = scene.clone();
    let mut step = None;
    if let Some(AnalysisSpec::Dynamic(spec)) = &mut scene.analysis {
        step = steps.map(|steps| spec.duration / steps as f64);
        (spec.mass, spec.courant, spec.step) = (None, None, step);
        **spec = spec.clone().with_scheme(scheme);
    }
    let mut found = scene.dynamics(model)?.ok_or_else(still)?;
    // The default scheme has a step of its own in bars.
    (found.step, found.steps) = (step.unwrap_or(found.step), steps.unwrap_or(found.steps));
    Ok(found)
}

fn still() -> Error {
    Error::Scene { path: "analysis".into(), message: "the scene does not move".into() }
}

/// A peak that changes by more than this share on the finer mesh is not resolved.
const RESOLVED: f64 = 0.1;

/// Estimated errors of the numbers of a motion: how far they move with half the step, and with half the step and half
/// the cells, together; of the peak at least how far it moves over twice its window, whose oscillations behind a wave
/// front are the same on every mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MotionError {
    /// Of the peak of the contact force, in force, `>= 0`.
    pub peak_force: f64,
    /// Of the impulse, in force times time, `>= 0`.
    pub impulse: f64,
    /// Of the time at which the last contact ended, in time, `>= 0`; `None` if nothing touches in one of the runs.
    pub release: Option<f64>,
    /// `true` if the error of the peak is at most a tenth of it.
    pub resolved: bool,
}

impl MotionError {
    /// The errors of a motion of `scene` in steps of length `step`, in time, with this `summary`: two more runs, the
    /// finer one with twice the cells along each edge.
    ///
    /// # Errors
    /// [`Error::Scene`] for a body from a mesh file, which cannot be refined; those of the scene and of its steps;
    /// [`qp::Error::Interrupted`] if the watch of `settings` stops a run.
    pub fn of(scene: &Scene, step: f64, summary: &MotionSummary, settings: &Settings) -> Result<Self, Error> {
        let finer = scene.refined(2)?;
        // The step of a bar is the time of a wave through a cell, whatever is asked for: half of it is the same motion.
        let same = summary_of(scene, step / 2.0, step, settings)?;
        let finer = summary_of(&finer, step / 2.0, f64::INFINITY, settings)?;
        let apart = |value: &dyn Fn(&MotionSummary) -> f64| {
            same.iter().chain(&finer).map(|other| (value(other) - value(summary)).abs()).sum::<f64>()
        };
        let of_window = (summary.contact.peak_force() - summary.contact.wide.largest).abs();
        let peak_force = apart(&|summary| summary.contact.peak_force()).max(of_window);
        let release = |summary: &MotionSummary| summary.contact.last.unwrap_or(f64::NAN);
        let release = Some(apart(&release)).filter(|apart| apart.is_finite());
        Ok(MotionError {
            peak_force,
            impulse: apart(&|summary| summary.contact.impulse),
            release,
            resolved: peak_force <= RESOLVED * summary.contact.peak_force(),
        })
    }
}

/// The summary of a motion in steps of another length; `None` if the step is `known` all the same.
fn summary_of(scene: &Scene, step: f64, known: f64, settings: &Settings) -> Result<Option<MotionSummary>, Error> {
    let mut scene = scene.clone();
    if let Some(AnalysisSpec::Dynamic(spec)) = &mut scene.analysis {
        (spec.step, spec.courant) = (Some(step), None);
    }
    let model = scene.build()?;
    let dynamics = scene.dynamics(&model)?.ok_or_else(still)?;
    if dynamics.step == known {
        return Ok(None);
    }
    let mut integrator = Integrator::new(dynamics.problem, dynamics.scheme, dynamics.step, settings)?;
    let mut summary =
        MotionSummary::starting(&model.of_whole(integrator.observe()), 0, dynamics.windows, dynamics.step);
    for number in 1..=dynamics.steps {
        settings.watch.part("step", number, dynamics.steps);
        if settings.watch.is_over() {
            return Err(qp::Error::Interrupted.into());
        }
        integrator.advance()?;
        summary.add(&model.of_whole(integrator.observe()), &[]);
    }
    Ok(Some(summary))
}
