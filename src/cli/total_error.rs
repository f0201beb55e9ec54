//! `signorini solve --total-error`: an answer with its guaranteed error against the continuum.

use super::input::{build, scene_title, warnings};
use super::options::Solve;
use super::outcome::{Outcome, Report, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::{total_error_text, write_total_error};
use crate::scene::Scene;
use crate::study::total_error::{TotalErrorGoal, total_error};
use crate::watch::Watch;

/// Writing takes this share of the time.
const REPORT: f64 = 0.05;

pub(super) fn run(options: &Solve, scene: &Scene, goal: TotalErrorGoal, watch: &Watch) -> Result<Outcome, Error> {
    let model = std::sync::Arc::new(build(scene, &options.input)?);
    warn(&warnings(&model));
    let settings = settings(options.method, &options.common, &watch.keeping(REPORT * options.time.unwrap_or(0.0)));
    let found = total_error(scene, &model, goal, &settings).map_err(|error| model.explain(error))?;
    let (title, units) = (scene_title(&model, &options.input), model.units().clone());
    let report = Report::new(&found, total_error_text(&title, &found, &units))?;
    if let Some(folder) = &options.common.out {
        report.write_with_text(folder, "total-error.txt")?;
        write_total_error(folder, &title, &found, &units)?;
    }
    Ok(report.outcome(options.common.format, found.status))
}
