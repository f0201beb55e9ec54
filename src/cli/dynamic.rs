//! `signorini solve` of a scene that asks for its motion: step after step.

use std::path::Path;
use std::time::Instant;

use super::input::{scene_title, warnings};
use super::options::Solve;
use super::outcome::{Outcome, Report, warn};
use super::settings::settings;
use crate::error::Error;
use crate::motion::Integrator;
use crate::output::{MotionFolder, MotionReport, compact_json};
use crate::qp::Method;
use crate::scene::{Dynamics, Model, Scene};
use crate::study::{MotionSummary, RunSeconds};
use crate::watch::Watch;

/// Energy beyond this, relative to the largest of the motion, is told even of a scheme that should keep it.
const GAIN: f64 = 0.01;

pub(super) fn run(options: &Solve, scene: &Scene, watch: &Watch) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let model = scene.build()?;
    let Some(dynamics) = scene.dynamics(&model)? else { return Ok(Outcome::done(String::new())) };
    warn(&warnings(&model));
    warn(&dynamics.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect::<String>());
    let assemble = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let mut settings = settings(options.method, &options.common, watch);
    if settings.method == Method::Auto {
        settings.method = Method::ActiveSet;
    }
    let integrator = Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, &settings)
        .map_err(|error| model.explain(error))?;
    let factor = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let mut run = Run::begun(options, scene, &model, &dynamics, integrator)?;
    run.go_on(&model, &dynamics, watch)?;
    let Run { summary, folder, .. } = run;
    watch.step("report", 0);
    if summary.energy_gain() > GAIN {
        let percent = 100.0 * summary.energy_gain();
        warn(&format!("warning: the energy grew by {percent:.1} % of its largest: do not trust this motion\n"));
    }
    let seconds = RunSeconds::new(assemble, factor, clock.elapsed().as_secs_f64());
    let motion =
        MotionReport { model: &model, dynamics: &dynamics, method: settings.method, summary: &summary, seconds };
    let report = Report::new(&motion, motion.text(&scene_title(&model, &options.input)))?;
    let (format, is_certified) = (options.common.format, motion.is_certified());
    let (Some(folder), Some(path)) = (folder, &options.common.out) else {
        return Ok(report.outcome(format, is_certified));
    };
    report.write(path)?;
    Ok(report.outcome(format, is_certified).with_pictures(move || folder.draw(&model)))
}

/// A motion that is under way.
struct Run {
    integrator: Integrator,
    summary: MotionSummary,
    folder: Option<MotionFolder>,
}

impl Run {
    /// A run from its first step, or from where the one in its folder stands.
    fn begun(
        options: &Solve,
        scene: &Scene,
        model: &Model,
        dynamics: &Dynamics,
        integrator: Integrator,
    ) -> Result<Self, Error> {
        let first = integrator.observe();
        let mut run = Run { integrator, summary: MotionSummary::starting(&first), folder: None };
        let text = compact_json(scene)?;
        match &options.common.out {
            Some(folder) if options.resume => run.resume(folder, text, dynamics.steps)?,
            Some(folder) => {
                let mut folder = MotionFolder::new(folder, text, &first)?;
                folder.frame(model, 0.0, run.integrator.state(), &run.summary)?;
                run.folder = Some(folder);
            }
            None => {}
        }
        Ok(run)
    }

    /// Takes up the run in `folder`, of which `steps` are wanted in all.
    fn resume(&mut self, folder: &Path, scene: String, steps: usize) -> Result<(), Error> {
        let (folder, state, so_far) = MotionFolder::resume(folder, scene)?;
        if state.steps > steps {
            let message = format!("the run in the folder has gone on to step {} already, beyond it", state.steps);
            return Err(Error::Scene { path: "analysis.dynamic.duration".into(), message });
        }
        self.integrator.resume(state)?;
        if self.integrator.time() != so_far.time {
            let message = "the run in the folder has another step; its duration was less than one".to_string();
            return Err(Error::Scene { path: "analysis.dynamic.step".into(), message });
        }
        (self.summary, self.folder) = (so_far, Some(folder));
        Ok(())
    }

    /// Takes the steps that are left, until `watch` is asked to stop or its time is over.
    fn go_on(&mut self, model: &Model, dynamics: &Dynamics, watch: &Watch) -> Result<(), Error> {
        // A frame ends where the share of the steps reaches the next whole number of frames.
        let frames_until = |step: usize| step as u128 * dynamics.frames as u128 / dynamics.steps as u128;
        while self.integrator.state().steps < dynamics.steps {
            watch.part("step", self.integrator.state().steps + 1, dynamics.steps);
            match self.integrator.advance() {
                Err(Error::Interrupted) => break,
                advanced => advanced.map_err(|error| model.explain(error))?,
            };
            let seen = self.integrator.observe();
            self.summary.add(&seen, dynamics.step);
            let steps = self.integrator.state().steps;
            if let Some(folder) = &mut self.folder {
                folder.observe(&seen)?;
                if frames_until(steps) > frames_until(steps - 1) {
                    folder.frame(model, seen.time, self.integrator.state(), &self.summary)?;
                }
            }
        }
        if self.summary.steps < dynamics.steps && !watch.is_stopped() {
            warn(&format!("out of time after step {} of {}\n", self.summary.steps, dynamics.steps));
        }
        Ok(())
    }
}
