//! `signorini solve` of a scene that asks for its motion: step after step.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use super::about::about;
use super::input::{scene_title, warnings};
use super::options::Solve;
use super::outcome::{Outcome, Report, unfit, warn};
use super::settings::settings;
use crate::Error;
use crate::motion::Integrator;
use crate::output::{MotionFolder, MotionReport, Pictures, Wanted};
use crate::qp;
use crate::qp::Watch;
use crate::scene::{Dynamics, Model, Scene};
use crate::study::{MotionError, MotionSummary, RunSeconds};

pub(super) fn run(options: &Solve, scene: &Scene, watch: &Watch) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let model = Arc::new(scene.build_within(options.common.limits.most_memory())?);
    let Some(dynamics) = scene.dynamics(&model)? else { return Ok(Outcome::done(String::new())) };
    if options.refine_in_time {
        // A mesh that cannot be refined is refused before the first step.
        scene.refined(2)?;
    }
    warn(&warnings(&model));
    warn(&dynamics.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect::<String>());
    let (title, common) = (scene_title(&model, &options.input), &options.common);
    let about = about(&title, "solve", &options.input, common.out.as_ref(), common.threads);
    let assemble = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let settings = settings(options.method, &options.common, watch).exactly();
    let explained = |error| model.explain(error);
    let integrator =
        Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, &settings).map_err(explained)?;
    let factor = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let run = Run::new(&model, &dynamics, integrator);
    let mut run = match &options.common.out {
        None => run,
        Some(path) if options.resume => run.resumed(path, scene)?,
        Some(path) => run.in_folder(path, scene)?,
    };
    run.advance(watch)?;
    let Run { summary, folder, .. } = run;
    let is_late = summary.steps < dynamics.steps && !watch.is_stopped();
    let why = is_late.then(|| format!("out of time after step {} of {}", summary.steps, dynamics.steps));
    watch.step("report", 0);
    warn(&summary.warnings(&model).iter().map(|warning| format!("warning: {}\n", warning.message)).collect::<String>());
    let seconds = RunSeconds::new(assemble, factor, clock.elapsed().as_secs_f64());
    let is_whole = summary.steps == dynamics.steps;
    let error = match options.refine_in_time && is_whole {
        true => Some(MotionError::of(scene, dynamics.step, &summary, &settings)?),
        false => None,
    };
    let method = settings.method;
    let motion = MotionReport { model: &model, dynamics: &dynamics, method, summary: &summary, error, seconds };
    let report = Report::new(&motion, motion.text(&title))?;
    let (format, status) = (options.common.format, motion.status());
    let (Some(folder), Some(path)) = (folder, &options.common.out) else {
        return Ok(report.outcome(format, status).because(why));
    };
    report.write(path)?;
    let value = report.value()?;
    let Wanted { pictures, medium } = options.common.wanted(Pictures::Answer);
    Ok(report.outcome(format, status).because(why).with_pictures(move || {
        folder.write_page(&model, &about, &value)?;
        match pictures {
            Pictures::None => Ok(()),
            _ => folder.draw_for(&model, medium),
        }
    }))
}

/// The steps of a motion, and their output.
struct Run<'a> {
    model: &'a Arc<Model>,
    dynamics: &'a Dynamics,
    integrator: Integrator,
    summary: MotionSummary,
    folder: Option<MotionFolder>,
}

impl<'a> Run<'a> {
    fn new(model: &'a Arc<Model>, dynamics: &'a Dynamics, integrator: Integrator) -> Self {
        let (seen, obstacles) = (model.of_whole(integrator.observe()), model.obstacles().len());
        let summary = MotionSummary::starting(&seen, obstacles, dynamics.windows, dynamics.step);
        Run { model, dynamics, integrator, summary, folder: None }
    }

    /// A new run, which writes its frames into a folder.
    fn in_folder(self, path: &Path, scene: &Scene) -> Result<Self, Error> {
        let Run { model, dynamics, integrator, summary, .. } = &self;
        let mut folder = MotionFolder::new(path, scene, model, &dynamics.watched)?;
        let resultants = dynamics.resultants(model, integrator)?;
        folder.observe(model, (&model.of_whole(integrator.observe()), 0.0), integrator.state(), &resultants)?;
        folder.frame(model, 0.0, integrator.state(), summary)?;
        Ok(Run { folder: Some(folder), ..self })
    }

    /// The run in a folder, to be resumed.
    fn resumed(mut self, path: &Path, scene: &Scene) -> Result<Self, Error> {
        let (folder, state, summary) = MotionFolder::resume(path, scene, self.model, &self.dynamics.watched)?;
        if state.steps > self.dynamics.steps {
            let message = format!(
                "the motion in the folder of --out has already reached step {}, beyond this duration; give a longer \
                 one",
                state.steps
            );
            return unfit("analysis.dynamic.duration", message);
        }
        self.integrator.resume(state)?;
        if self.integrator.time() != summary.time {
            let message = "the motion in the folder of --out has another step, because its duration was shorter than \
                           one step; start it anew";
            return unfit("analysis.dynamic.step", message);
        }
        Ok(Run { summary, folder: Some(folder), ..self })
    }

    /// All remaining steps, until the watch stops them.
    fn advance(&mut self, watch: &Watch) -> Result<(), Error> {
        let Dynamics { steps: last, frames, .. } = *self.dynamics;
        // A frame ends when the share of the steps reaches the next whole number of frames.
        let frames_until = |step: usize| step as u128 * frames as u128 / last as u128;
        while self.integrator.state().steps < last {
            watch.part("step", self.integrator.state().steps + 1, last);
            match self.integrator.advance() {
                Err(qp::Error::Interrupted) => break,
                advanced => advanced.map_err(|error| self.model.explain(error))?,
            };
            let seen = self.model.of_whole(self.integrator.observe());
            let state = self.integrator.state();
            let (forces, rows) =
                (self.model.obstacle_forces(&state.multiplier), self.model.pressing_rows(&state.multiplier));
            self.summary.add(&seen, &forces.into_iter().zip(rows).collect::<Vec<_>>());
            if let Some(folder) = &mut self.folder {
                let seen_with_mean = (&seen, self.summary.contact.mean_force());
                folder.observe(
                    self.model,
                    seen_with_mean,
                    state,
                    &self.dynamics.resultants(self.model, &self.integrator)?,
                )?;
                if frames_until(state.steps) > frames_until(state.steps - 1) {
                    folder.frame(&self.dynamics.model_at(self.model, seen.time)?, seen.time, state, &self.summary)?;
                }
            }
        }
        Ok(())
    }
}
