//! `signorini solve --total-error`: an answer with its error against the continuum, guaranteed or estimated.

use crate::output::{InWords, Pictures, Wanted, why_text};
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::about::about;
use super::input::{build, scene_title, warnings};
use super::interrupt::Kept;
use super::options::Solve;
use super::outcome::{OfPart, Outcome, Report, warn};
use super::settings::settings;
use crate::Error;
use crate::qp::{Goal, Solution, Watch};
use crate::scene::{Answer, Scene};
use crate::study::{LevelKind, Summary, TotalError, TotalErrorGoal};

/// Writing takes this share of the time.
const REPORT: f64 = 0.05;

/// An error against the continuum with the answer on the last mesh.
#[derive(Serialize)]
struct WithAnswer<'a> {
    #[serde(flatten)]
    found: &'a TotalError,
    #[serde(skip_serializing_if = "Option::is_none")]
    answer: Option<&'a Summary>,
}

pub(super) fn run(
    options: &Solve,
    scene: &Scene,
    goal: TotalErrorGoal,
    watch: &Watch,
    kept: &Kept,
) -> Result<Outcome, Error> {
    let clock = Instant::now();
    let common = &options.common;
    let model = Arc::new(build(scene, &options.input, &common.limits)?);
    let seconds = clock.elapsed().as_secs_f64();
    warn(&warnings(&model));
    let settings = settings(options.method, common, &watch.keeping(REPORT * options.time.unwrap_or(0.0)));
    let (title, units) = (scene_title(&model, &options.input), model.units().clone());
    let keep = |found: &TotalError| {
        if let Ok(report) = Report::new(found, (found, None).text(&title, &units)) {
            kept.keep(report.formatted(common.format));
        }
    };
    let found = TotalError::search(scene, &model, goal, &settings, &keep).map_err(|error| model.explain(error))?;
    let answer = match &found.last {
        Ok(last) => Some(summed(&found, (**last).clone(), settings.goal(), seconds)?),
        Err(_) => None,
    };
    let summary = answer.as_ref().map(|(_, summary)| summary);
    let mut text = (&found, summary).text(&title, &units);
    if let Some(why) = summary.map(|summary| &summary.solution.why).filter(|_| options.explain) {
        text += &why_text(why);
    }
    let with_answer = WithAnswer { found: &found, answer: summary };
    let report = Report::new(&OfPart::new(with_answer, model.parts_of_whole() > 1.0, &["levels", "model"]), text)?;
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, found.status)) };
    let wanted = common.wanted(Pictures::Answer);
    if let Some((answer, summary)) = &answer {
        Wanted::write_answer(&folder, &summary.solution, Some(answer))?;
    }
    report.write_with_text(&folder, "total-error.txt")?;
    wanted.write_total_error(&folder, &title, &found, &units)?;
    let (value, status) = (report.value()?, found.status);
    let about = about(&title, "solve", &options.input, common.out.as_ref(), common.threads);
    Ok(report.outcome(common.format, status).with_pictures(move || {
        about.write_total_error(&folder, (&model, answer.as_ref()), &value, &found)?;
        match &answer {
            Some((answer, summary)) => wanted.write_solve(&folder, answer, &summary.solution.history),
            None => Ok(()),
        }
    }))
}

/// The answer on the last mesh with its numbers; the error of its mesh is the one that the search has found.
fn summed(
    found: &TotalError,
    (answer, solution): (Answer, Solution),
    goal: Goal,
    seconds: f64,
) -> Result<(Answer, Summary), Error> {
    let (goal, discretisation_error) = match found.levels.last().map(|level| &level.kind) {
        Some(LevelKind::Estimated { discretisation_error, .. }) => {
            (Goal { accuracy: Some(found.algebra()), ..goal }, Some(*discretisation_error))
        }
        _ => {
            let last = found.guarantee.as_ref().and_then(|guarantee| guarantee.last_mesh.as_ref());
            (goal, last.map(|last| last.estimated))
        }
    };
    let summary = Summary::of_answer(&answer, solution, goal, seconds)?;
    Ok((answer, Summary { discretisation_error, ..summary }))
}
