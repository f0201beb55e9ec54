//! `signorini solve --total-error`: an answer with its error against the continuum, guaranteed or estimated.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::about::about;
use super::input::{build, scene_title, warnings};
use super::interrupt::Kept;
use super::options::Solve;
use super::outcome::{OfPart, Outcome, Report, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::gallery::{self, Pictures};
use crate::output::page::write_total_error_page;
use crate::output::{
    Drawing, Plot, estimated_error_text, estimated_meshes_picture, estimated_plot, guaranteed_plot, meshes_picture,
    total_error_text, why_text, write_estimated_error, write_total_error,
};
use crate::scene::{Answer, Model, Scene};
use crate::solution::{Goal, Solution};
use crate::study::total_error::{Found, TotalError, TotalErrorGoal, total_error};
use crate::study::{ModelSize, Status, Summary, scene_summary};
use crate::watch::Watch;

/// Writing takes this share of the time.
const REPORT: f64 = 0.05;

/// An error against the continuum with the answer on the last mesh.
#[derive(Serialize)]
struct WithAnswer<'a, T> {
    #[serde(flatten)]
    found: &'a T,
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<&'a ModelSize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    answer: Option<&'a Summary>,
}

/// What both kinds of an error report and write.
struct Shown<'a> {
    text: String,
    /// The answer on the last mesh with its numbers.
    answer: Option<(Answer, Summary)>,
    /// Writes the files of the error itself into a folder.
    files: &'a dyn Fn(&Path) -> Result<(), Error>,
    /// The errors of all meshes, as a curve.
    plot: Plot,
    meshes: Option<Drawing>,
}

pub(super) fn run(
    options: &Solve,
    scene: &Scene,
    goal: TotalErrorGoal,
    watch: &Watch,
    kept: &Kept,
) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let model = Arc::new(build(scene, &options.input, &options.common.limits)?);
    let seconds = clock.elapsed().as_secs_f64();
    warn(&warnings(&model));
    let settings = settings(options.method, &options.common, &watch.keeping(REPORT * options.time.unwrap_or(0.0)));
    let wanted = options.common.wanted(Pictures::Answer);
    let (title, units) = (scene_title(&model, &options.input), model.units().clone());
    let keep = |found: &TotalError| {
        if let Ok(report) = Report::new(found, total_error_text(&title, found, None, &units)) {
            kept.keep(report.formatted(options.common.format));
        }
    };
    match total_error(scene, &model, goal, &settings, &keep).map_err(|error| model.explain(error))? {
        Found::Guaranteed(found) => {
            let estimated = found.last_mesh.map(|last| last.estimated);
            let answer = match found.last.clone() {
                Ok(last) => Some(summed(last.0, last.1, settings.goal(), estimated, seconds)?),
                Err(_) => None,
            };
            let text = total_error_text(&title, &found, answer.as_ref().map(|(_, summary)| summary), &units);
            let files = |folder: &Path| write_total_error(folder, &title, &found, &units, wanted);
            let (plot, meshes) = (guaranteed_plot(&found), Some(meshes_picture(&title, &found, &units)));
            let shown_as = Shown { text, answer, files: &files, plot, meshes };
            shown(options, &title, (&model, &*found, found.status), shown_as)
        }
        Found::Estimated(found) => {
            let goal = Goal { accuracy: Some(found.algebra()), ..settings.goal() };
            let estimated = found.levels.last().map(|level| level.discretisation_error);
            let answer = summed(found.answer.clone(), found.solution.clone(), goal, estimated, seconds)?;
            let text = estimated_error_text(&title, &found, &answer.1, &units);
            let files = |folder: &Path| write_estimated_error(folder, &title, &found, wanted);
            let (plot, meshes) = (estimated_plot(&found), estimated_meshes_picture(&title, &found));
            let shown_as = Shown { text, answer: Some(answer), files: &files, plot, meshes };
            shown(options, &title, (&model, &*found, found.status), shown_as)
        }
    }
}

/// An answer with its numbers.
fn summed(
    answer: Answer,
    solution: Solution,
    goal: Goal,
    estimated: Option<f64>,
    seconds: f64,
) -> Result<(Answer, Summary), Error> {
    let summary = scene_summary(&answer, solution, goal, seconds)?;
    Ok((answer, Summary { discretisation_error: estimated, ..summary }))
}

/// Reports an error with its answer, and writes the output of `--out`.
fn shown<T: Serialize>(
    options: &Solve,
    title: &str,
    (first, found, status): (&Arc<Model>, &T, Status),
    Shown { mut text, answer, files, plot, meshes }: Shown,
) -> Result<Outcome, Error> {
    let common = &options.common;
    let summary = answer.as_ref().map(|(_, summary)| summary);
    if let Some(why) = summary.map(|summary| &summary.solution.why).filter(|_| options.explain) {
        text += &why_text(why);
    }
    let is_part = first.parts_of_whole() > 1.0;
    let found = WithAnswer { found, model: summary.map(|summary| &summary.model), answer: summary };
    let report = Report::new(&OfPart::new(found, is_part, &["levels", "model"]), text)?;
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, status)) };
    if let Some((answer, summary)) = &answer {
        gallery::write_answer(&folder, &summary.solution, Some(answer))?;
    }
    report.write_with_text(&folder, "total-error.txt")?;
    files(&folder)?;
    let (wanted, value, first) = (common.wanted(Pictures::Answer), report.value()?, first.clone());
    let about = about(title, "solve", &options.input, common.out.as_ref(), common.threads);
    Ok(report.outcome(common.format, status).with_pictures(move || {
        write_total_error_page(&folder, &about, (&first, answer.as_ref()), value, (&plot, meshes.as_ref()))?;
        match &answer {
            Some((answer, summary)) => gallery::write_solve(&folder, answer, &summary.solution.history, wanted),
            None => Ok(()),
        }
    }))
}
