//! `signorini sweep`: one scene at several gaps.

use super::input::{scene_title, still_model, unit_names, warnings};
use super::options::{Format, Sweep};
use super::outcome::{Outcome, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::{gallery, sweep_json, sweep_text, write_files};
use crate::qp::Method;
use crate::study::{even_gaps, sweep};
use crate::watch::Watch;

pub(super) fn run(options: &Sweep, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let model = still_model(&options.scene, &common.limits)?;
    warn(&warnings(&model));
    let gaps = even_gaps(options.gaps.first, options.gaps.last, options.gaps.count);
    let swept = sweep(&model, &gaps, &settings(Method::Auto, common, watch))?;
    watch.step("report", 0);
    let json = format!("{:#}\n", sweep_json(&swept));
    let text = match common.format {
        Format::Text => sweep_text(&scene_title(&model, &options.scene), &swept, &unit_names(&model)),
        Format::Json => json.clone(),
    };
    let outcome = Outcome::judged(text, swept.points.iter().all(|point| point.summary.is_certified()));
    let Some(folder) = common.out.clone() else { return Ok(outcome) };
    write_files(&folder, &[("report.json", json)])?;
    Ok(outcome.with_pictures(move || gallery::write_sweep(&folder, &swept)))
}
