//! `signorini sweep`: one scene at several gaps.

use super::about::about;
use super::input::{scene_title, still_model, warnings};
use super::options::{Gaps, Sweep};
use super::outcome::{Outcome, Report, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::page::write_sweep_page;
use crate::output::{gallery, sweep_text};
use crate::study::scene::{even_gaps, sweep_forces};
use crate::study::sweep;
use crate::watch::Watch;

pub(super) fn run(options: &Sweep, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let model = still_model(&options.scene, &common.limits)?;
    warn(&warnings(&model));
    let title = scene_title(&model, &options.scene);
    let about = about(&title, "sweep", &options.scene, common.out.as_ref(), common.threads);
    let settings = settings(options.method, common, watch);
    let even = |range: &Gaps| even_gaps(range.first, range.last, range.count);
    let swept = match (&options.gaps, &options.forces) {
        (_, Some(forces)) => sweep_forces(&model, &even(forces), &settings)?,
        (gaps, None) => sweep(&model, &gaps.as_ref().map_or_else(Vec::new, even), &settings)?,
    };
    watch.step("report", 0);
    let text = sweep_text(&title, &swept, model.units());
    let report = Report::new(&swept, text)?;
    let status = swept.points.iter().map(|point| point.summary.status).collect();
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, status)) };
    report.write(&folder)?;
    let outcome = report.outcome(common.format, status);
    Ok(outcome.with_pictures(move || {
        write_sweep_page(&folder, &about, &swept)?;
        gallery::write_sweep(&folder, &swept)
    }))
}
