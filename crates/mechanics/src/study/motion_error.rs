//! Estimated errors of the numbers of a motion, from the same motion with half the step and with half the cells.

use serde::Serialize;
use signorini_qp as qp;

use super::motion::MotionSummary;
use crate::error::Error;
use crate::motion::Integrator;
use crate::scene::Scene;
use crate::scene::input::schema::AnalysisSpec;
use signorini_qp::Settings;

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
        let of_window = (summary.contact.peak_force() - summary.contact.wide_peak()).abs();
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
    let still = || Error::Scene { path: "analysis".into(), message: "the scene does not move".into() };
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
