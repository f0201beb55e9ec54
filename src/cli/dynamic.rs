//! `signorini solve` of a scene that asks for its motion: step after step, with a bar that tells how long it takes.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use super::input::{scene_title, unit_names, warnings};
use super::options::{Format, Solve};
use super::solve::settings;
use super::{Outcome, warn};
use crate::dynamic::Integrator;
use crate::error::Error;
use crate::output::{MotionFolder, MotionSeconds, motion_is_certified, motion_json, motion_text, write_files};
use crate::scene::Scene;
use crate::solve::Method;
use crate::study::MotionSummary;

/// Energy beyond this, relative to the largest of the motion, is told even of a scheme that should keep it.
const GAIN: f64 = 0.01;

pub(super) fn run(options: &Solve, scene: &Scene) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let model = scene.build()?;
    let Some(dynamics) = scene.dynamics(&model)? else { return Ok(Outcome::certified(String::new())) };
    warn(&warnings(&model));
    warn(&dynamics.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect::<String>());
    let assemble = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let mut settings = settings(options.method.method(), &options.common);
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
            integrator.resume(state)?;
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
    let mut progress = Progress::new(integrator.state().steps, dynamics.steps);
    // A frame ends where the share of the steps reaches the next whole number of frames.
    let frames_until = |step: usize| step as u128 * dynamics.frames as u128 / dynamics.steps as u128;
    while integrator.state().steps < dynamics.steps {
        integrator.advance().map_err(explained)?;
        let seen = integrator.observe();
        summary.add(&seen, dynamics.step);
        let steps = integrator.state().steps;
        if let Some(folder) = &mut folder {
            folder.observe(&seen)?;
            if frames_until(steps) > frames_until(steps - 1) {
                folder.frame(&model, seen.time, integrator.state(), &summary)?;
            }
        }
        progress.show(steps);
    }
    progress.clear();
    if summary.energy_gain() > GAIN {
        let percent = 100.0 * summary.energy_gain();
        warn(&format!("warning: the energy grew by {percent:.1} % of its largest: do not trust this motion\n"));
    }
    let seconds = MotionSeconds { assemble, factor, steps: clock.elapsed().as_secs_f64() };
    let json = format!("{:#}\n", motion_json(&model, &dynamics, settings.method, &summary, &seconds));
    if let (Some(folder), Some(path)) = (&folder, &options.common.out) {
        folder.draw(&model)?;
        write_files(path, &[("report.json", json.clone())])?;
    }
    let title = scene_title(&model, &options.input);
    let text = match options.common.format {
        Format::Text => motion_text(&title, &model, &dynamics, &summary, &seconds, &unit_names(&model)),
        Format::Json => json,
    };
    Ok(Outcome::judged(text, motion_is_certified(&dynamics, settings.method)))
}

/// A bar on standard error, where that is a terminal.
struct Progress {
    shown: bool,
    start: Instant,
    last: Option<Instant>,
    first_step: usize,
    steps: usize,
}

impl Progress {
    /// How often it is drawn, and how wide.
    const PERIOD: Duration = Duration::from_millis(200);
    const WIDTH: usize = 30;

    fn new(first_step: usize, steps: usize) -> Self {
        Progress { shown: io::stderr().is_terminal(), start: Instant::now(), last: None, first_step, steps }
    }

    fn show(&mut self, step: usize) {
        if !self.shown || self.last.is_some_and(|last| last.elapsed() < Self::PERIOD) {
            return;
        }
        self.last = Some(Instant::now());
        let done = step - self.first_step;
        let left = self.start.elapsed().as_secs_f64() * (self.steps - step) as f64 / done.max(1) as f64;
        let filled = (Self::WIDTH as u128 * step as u128 / self.steps.max(1) as u128) as usize;
        let bar: String = (0..Self::WIDTH).map(|place| if place < filled { '#' } else { '.' }).collect();
        warn(&format!("\r[{bar}] step {step} of {}, {left:.0} s left   ", self.steps));
    }

    fn clear(&self) {
        if self.last.is_some() {
            warn(&format!("\r{:1$}\r", "", Self::WIDTH + 60));
        }
    }
}
