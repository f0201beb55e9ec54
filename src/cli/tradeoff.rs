//! `signorini tradeoff`: one scene in every way, and what each digit costs.

use super::input::{build, read_scene, scene_title, warnings};
use super::options::{Format, Tradeoff};
use super::outcome::{Outcome, warn};
use crate::error::Error;
use crate::output::{
    motion_tradeoff_csv, motion_tradeoff_json, motion_tradeoff_plot, motion_tradeoff_text, tradeoff_csv, tradeoff_json,
    tradeoff_plot, tradeoff_text, write_files, write_picture,
};
use crate::qp::Settings;
use crate::scene::Scene;
use crate::study::{TradeoffGrid, motion_tradeoff, tradeoff};
use crate::watch::Watch;

pub(super) fn run(options: &Tradeoff, watch: &Watch) -> Result<Outcome, Error> {
    let scene = read_scene(&options.scene, &options.limits)?;
    if scene.analysis.is_some() {
        return of_motion(options, &scene, watch);
    }
    let model = build(&scene, &options.scene)?;
    warn(&warnings(&model));
    let title = scene_title(&model, &options.scene);
    let grid = TradeoffGrid {
        refinements: options.refinements.into(),
        runs: options.runs.into(),
        most_full_dofs: options.most_full_dofs,
    };
    let measured = tradeoff(&scene, &grid, watch)?;
    watch.step("report", 0);
    let (text, json) = (tradeoff_text(&title, &measured), format!("{:#}\n", tradeoff_json(&measured)));
    if let Some(folder) = &options.out {
        let files =
            [("tradeoff.txt", text.clone()), ("tradeoff.csv", tradeoff_csv(&measured)), ("report.json", json.clone())];
        write_files(folder, &files)?;
        write_picture(folder, "tradeoff", &tradeoff_plot(&title, &measured))?;
    }
    Ok(Outcome::certified(match options.format {
        Format::Text => text,
        Format::Json => json,
    }))
}

/// Every scheme at several steps.
fn of_motion(options: &Tradeoff, scene: &Scene, watch: &Watch) -> Result<Outcome, Error> {
    let model = scene.build()?;
    warn(&warnings(&model));
    let title = scene_title(&model, &options.scene);
    let settings = Settings { watch: watch.clone(), ..Settings::default() };
    let measured = motion_tradeoff(scene, &settings)?;
    watch.step("report", 0);
    let (text, json) = (motion_tradeoff_text(&title, &measured), format!("{:#}\n", motion_tradeoff_json(&measured)));
    if let Some(folder) = &options.out {
        let files = [
            ("tradeoff.txt", text.clone()),
            ("tradeoff.csv", motion_tradeoff_csv(&measured)),
            ("report.json", json.clone()),
        ];
        write_files(folder, &files)?;
        write_picture(folder, "tradeoff", &motion_tradeoff_plot(&title, &measured))?;
    }
    Ok(Outcome::certified(match options.format {
        Format::Text => text,
        Format::Json => json,
    }))
}
