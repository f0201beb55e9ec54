//! `signorini solve` of a scene that asks for its natural vibrations.

use serde_json::json;

use super::about::about;
use super::input::{Content, Input, add_error_and_energy};
use super::options::Solve;
use super::outcome::{Outcome, Report, unfit, warn};
use super::settings::settings;
use crate::Error;
use crate::output::{InWords, ModesShown, Pictures, Wanted, write_files};
use crate::qp::Watch;
use crate::scene::{ModalAnalysis, Scene};
use crate::study::Status;

pub(super) fn run(options: &Solve, scene: &Scene, read_seconds: f64, watch: &Watch) -> Result<Outcome, Error> {
    let (common, count) = (&options.common, scene.modes().map_or(0, |spec| spec.count));
    let input = Input::of_scene(scene, &options.input, &common.limits, read_seconds)?;
    warn(&input.warnings());
    let Content::Scene(model) = &input.content else { return unfit("scene", "there is no body") };
    let about = about(&input.title, "solve", &options.input, common.out.as_ref(), common.threads);
    let settings = settings(options.method, common, watch);
    let found = ModalAnalysis::of(model.clone(), count, &settings)?;
    watch.step("report", 0);
    let mut text = String::new();
    let mut summary = None;
    if let Some(solution) = &found.solution {
        let mut own = input.summary(solution.clone(), Some(&found.answer), settings.goal())?;
        add_error_and_energy(&mut own, &found.answer)?;
        text = own.text(&input.title, &input.units) + "\n";
        summary = Some(own);
    }
    text += &found.text(&input.title, &input.units);
    let status = match (&summary, found.is_complete) {
        (Some(summary), true) => summary.status,
        (None, true) => Status::Certified,
        (_, false) => Status::NotCertified,
    };
    let report = json!({ "answer": summary, "modes": found });
    let written = Report::new(&report, text)?;
    let Some(folder) = common.out.clone() else { return Ok(written.outcome(common.format, status)) };
    if let Some(solution) = &found.solution {
        Wanted::write_answer(&folder, solution, Some(&found.answer))?;
    }
    write_files(&folder, &[("modes.csv", found.table()), ("modes.vtu", found.vtu()?)])?;
    written.write(&folder)?;
    let outcome = written.outcome(common.format, status);
    let wanted = common.wanted(Pictures::Answer);
    Ok(outcome.with_pictures(move || {
        about.write_modes(&folder, (&found, summary.as_ref()), &report)?;
        match &found.solution {
            Some(solution) => wanted.write_solve(&folder, &found.answer, &solution.history),
            None => Ok(()),
        }
    }))
}
