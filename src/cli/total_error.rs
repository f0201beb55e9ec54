//! `signorini solve --total-error`: an answer with its error against the continuum, guaranteed or estimated.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::about::about;
use super::input::{build, scene_title, warnings};
use super::options::Solve;
use super::outcome::{Outcome, Report, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::gallery::{self, Pictures};
use crate::output::page::{About, write_answer_page, write_total_error_page};
use crate::output::{
    estimated_error_text, meshes_picture, total_error_text, why_text, write_estimated_error, write_total_error,
};
use crate::qp::Settings;
use crate::scene::Scene;
use crate::solution::Goal;
use crate::study::total_error::{Estimated, Found, TotalError, TotalErrorGoal, total_error};
use crate::study::{Summary, scene_summary};
use crate::watch::Watch;

/// Writing takes this share of the time.
const REPORT: f64 = 0.05;

pub(super) fn run(options: &Solve, scene: &Scene, goal: TotalErrorGoal, watch: &Watch) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let model = Arc::new(build(scene, &options.input)?);
    let seconds = clock.elapsed().as_secs_f64();
    warn(&warnings(&model));
    let settings = settings(options.method, &options.common, &watch.keeping(REPORT * options.time.unwrap_or(0.0)));
    let wanted = options.common.wanted(Pictures::Answer);
    let (title, units) = (scene_title(&model, &options.input), model.units().clone());
    let about = about(&title, "solve", &options.input, options.common.out.as_ref(), options.common.threads);
    let keep = |found: &TotalError| {
        if let Ok(report) = Report::new(found, total_error_text(&title, found, &units)) {
            watch.keep(report.formatted(options.common.format));
        }
    };
    match total_error(scene, &model, goal, &settings, &keep).map_err(|error| model.explain(error))? {
        Found::Guaranteed(found) => {
            if options.explain {
                warn("warning: --explain has no effect with a guaranteed error: it explains a single solve\n");
            }
            let report = Report::new(&found, total_error_text(&title, &found, &units))?;
            if let Some(folder) = &options.common.out {
                report.write_with_text(folder, "total-error.txt")?;
                write_total_error(folder, &title, &found, &units, wanted)?;
            }
            let outcome = report.outcome(options.common.format, found.status);
            let Some(folder) = options.common.out.clone() else { return Ok(outcome) };
            Ok(outcome.with_pictures(move || {
                let meshes = meshes_picture(&title, &found, &units);
                write_total_error_page(&folder, &about, &model, &found, &meshes)
            }))
        }
        Found::Estimated(found) => estimated(options, *found, about, &settings, seconds),
    }
}

/// An estimated error with its answer.
#[derive(Serialize)]
struct EstimatedReport<'a> {
    #[serde(flatten)]
    found: &'a Estimated,
    answer: &'a Summary,
}

fn estimated(
    options: &Solve,
    found: Estimated,
    about: About,
    settings: &Settings,
    seconds: f64,
) -> Result<Outcome, Error> {
    let goal = Goal { accuracy: Some(found.algebra()), ..settings.goal() };
    let mut summary = scene_summary(&found.answer, found.solution.clone(), goal, seconds)?;
    summary.discretisation_error = found.levels.last().map(|level| level.discretisation_error);
    let units = found.answer.model().units();
    let mut text = estimated_error_text(&about.title, &found, &summary, units);
    if let Some(why) = summary.solution.why.as_ref().filter(|_| options.explain) {
        text += &why_text(why);
    }
    let report = Report::new(&EstimatedReport { found: &found, answer: &summary }, text)?;
    let Some(folder) = options.common.out.clone() else {
        return Ok(report.outcome(options.common.format, found.status));
    };
    gallery::write_answer(&folder, &summary.solution, Some(&found.answer))?;
    report.write_with_text(&folder, "total-error.txt")?;
    let wanted = options.common.wanted(Pictures::Answer);
    write_estimated_error(&folder, &about.title, &found, wanted)?;
    let outcome = report.outcome(options.common.format, found.status);
    Ok(outcome.with_pictures(move || {
        write_answer_page(&folder, &about, &found.answer, &summary)?;
        gallery::write_solve(&folder, &found.answer, &summary.solution.history, wanted)
    }))
}
