//! `signorini solve` of a scene that asks for its motion: step after step.

use std::time::Instant;

use super::input::{scene_title, unit_names, warnings};
use super::options::{Format, Solve};
use super::outcome::{Outcome, warn};
use super::settings::settings;
use crate::error::Error;
use crate::motion::Integrator;
use crate::output::{MotionFolder, MotionSeconds, motion_is_certified, motion_json, motion_text, write_files};
use crate::qp::Method;
use crate::scene::Scene;
use crate::study::MotionSummary;
use crate::watch::Watch;

/// Energy beyond this, relative to the largest of the motion, is told even of a scheme that should keep it.
const GAIN: f64 = 0.01;

pub(super) fn run(options: &Solve, scene: &Scene, watch: &Watch) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let model = scene.build()?;
    let Some(dynamics) = scene.dynamics(&model)? else { return Ok(Outcome::certified(String::new())) };
    warn(&warnings(&model));
    warn(&dynamics.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect::<String>());
    let assemble = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let mut settings = settings(options.method.method(), &options.common, watch);
    if settings.method == Method::Auto {
        settings.method = Method::ActiveSet;
    }
    let explained = |error| model.explain(error);
    let mut integrator =
        Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, &settings).map_err(explained)?;
    let factor = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let first = integrator.observe();
    let mut summary = MotionSummary::starting(&first);
    let text = serde_json::to_string(scene)
        .map_err(|error| Error::Numerical { step: "writing JSON", reason: error.to_string() })?;
    let mut folder = match &options.common.out {
        Some(folder) if options.resume => {
            let (folder, state, so_far) = MotionFolder::resume(folder, text)?;
            if state.steps > dynamics.steps {
                let message = format!("the run in the folder has gone on to step {} already, beyond it", state.steps);
                return Err(Error::Scene { path: "analysis.dynamic.duration".into(), message });
            }
            integrator.resume(state)?;
            if integrator.time() != so_far.time {
                let message = "the run in the folder has another step; its duration was less than one".to_string();
                return Err(Error::Scene { path: "analysis.dynamic.step".into(), message });
            }
            summary = so_far;
            Some(folder)
        }
        Some(folder) => {
            let mut folder = MotionFolder::new(folder, text, &first)?;
            folder.frame(&model, 0.0, integrator.state(), &summary)?;
            Some(folder)
        }
        None => None,
    };
    // A frame ends where the share of the steps reaches the next whole number of frames.
    let frames_until = |step: usize| step as u128 * dynamics.frames as u128 / dynamics.steps as u128;
    while integrator.state().steps < dynamics.steps {
        watch.part("step", integrator.state().steps + 1, dynamics.steps);
        match integrator.advance() {
            Err(Error::Interrupted) => break,
            advanced => advanced.map_err(explained)?,
        };
        let seen = integrator.observe();
        summary.add(&seen, dynamics.step);
        let steps = integrator.state().steps;
        if let Some(folder) = &mut folder {
            folder.observe(&seen)?;
            if frames_until(steps) > frames_until(steps - 1) {
                folder.frame(&model, seen.time, integrator.state(), &summary)?;
            }
        }
    }
    if summary.steps < dynamics.steps && !watch.is_stopped() {
        warn(&format!("out of time after step {} of {}\n", summary.steps, dynamics.steps));
    }
    watch.step("report", 0);
    if summary.energy_gain() > GAIN {
        let percent = 100.0 * summary.energy_gain();
        warn(&format!("warning: the energy grew by {percent:.1} % of its largest: do not trust this motion\n"));
    }
    let seconds = MotionSeconds { assemble, factor, steps: clock.elapsed().as_secs_f64() };
    let json = format!("{:#}\n", motion_json(&model, &dynamics, settings.method, &summary, &seconds));
    let title = scene_title(&model, &options.input);
    let text = match options.common.format {
        Format::Text => motion_text(&title, &model, &dynamics, &summary, &seconds, &unit_names(&model)),
        Format::Json => json.clone(),
    };
    let outcome = Outcome::judged(text, motion_is_certified(&dynamics, settings.method, &summary));
    let (Some(folder), Some(path)) = (folder, &options.common.out) else { return Ok(outcome) };
    write_files(path, &[("report.json", json)])?;
    Ok(outcome.with_pictures(move || folder.draw(&model)))
}
