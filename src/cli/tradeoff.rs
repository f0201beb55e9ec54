//! `signorini tradeoff`: one scene with every method, and the cost of each digit.

use serde::Serialize;

use super::about::about;
use super::input::{Input, build, read_scene, scene_title, warnings};
use super::options;
use super::outcome::{OfPart, Outcome, Report, warn};
use crate::error::Error;
use crate::output::gallery::Pictures;
use crate::output::page::{About, write_tradeoff_page};
use crate::output::{
    Drawing, motion_tradeoff_csv, motion_tradeoff_plot_for, motion_tradeoff_text, total_error_plot, tradeoff_csv,
    tradeoff_plot_for, tradeoff_text, write_files, write_picture,
};
use crate::qp::Settings;
use crate::study::{Tradeoff, TradeoffGrid, motion_tradeoff, tradeoff};
use crate::watch::Watch;

/// Largest number of finer meshes if only the time limits them.
const MOST_REFINEMENTS: usize = 8;

pub(super) fn run(options: &options::Tradeoff, watch: &Watch) -> Result<Outcome, Error> {
    let grid = TradeoffGrid {
        refinements: options.refinements.map_or(if options.time.is_some() { MOST_REFINEMENTS } else { 1 }, usize::from),
        runs: options.runs.into(),
        most_full_dofs: options.most_full_dofs,
        seconds: options.time.unwrap_or(f64::INFINITY),
    };
    let about = |title: &str| about(title, "tradeoff", &options.input, options.out.as_ref(), 1);
    if options.input.is_dir() {
        let input = Input::read(&options.input, &options.limits)?;
        let about = &about(&input.title);
        let measured = Tradeoff::of_problem(input.problem(), &grid, watch)?;
        let (text, csv) = (tradeoff_text(&input.title, &measured), tradeoff_csv(&measured));
        let plots = || vec![("tradeoff", tradeoff_plot_for(options.style, &input.title, &measured))];
        return reported(options, watch, about, &measured, text, &csv, plots);
    }
    let scene = read_scene(&options.input, &options.limits)?;
    let moves = scene.analysis.is_some();
    let model = if moves {
        scene.build_within(options.limits.most_memory())?
    } else {
        build(&scene, &options.input, &options.limits)?
    };
    warn(&warnings(&model));
    let title = &scene_title(&model, &options.input);
    let about = &about(title);
    if moves {
        let settings = Settings { watch: watch.clone(), ..Settings::default() };
        let measured = motion_tradeoff(&scene, &settings)?;
        let (text, csv) = (motion_tradeoff_text(title, &measured), motion_tradeoff_csv(&measured));
        let plots = || vec![("tradeoff", motion_tradeoff_plot_for(options.style, title, &measured))];
        return reported(options, watch, about, &measured, text, &csv, plots);
    }
    let measured = tradeoff(&scene, &grid, watch)?;
    let (mut text, csv) = (tradeoff_text(title, &measured), tradeoff_csv(&measured));
    let is_part = model.parts_of_whole() > 1.0;
    if is_part {
        text += "All numbers but the error of the mesh are of the meshed part.\n";
    }
    let plots = || {
        vec![
            ("tradeoff", tradeoff_plot_for(options.style, title, &measured)),
            ("total-error", total_error_plot(options.style, title, &measured)),
        ]
    };
    let report = OfPart::new(&measured, is_part, &["advice", "meshes", "points"]);
    reported(options, watch, about, &report, text, &csv, plots)
}

/// Reports the measurements, with their values and pictures in the folder of the options.
fn reported(
    options: &options::Tradeoff,
    watch: &Watch,
    about: &About,
    measured: &impl Serialize,
    text: String,
    csv: &str,
    plots: impl Fn() -> Vec<(&'static str, Drawing)>,
) -> Result<Outcome, Error> {
    watch.step("report", 0);
    let report = Report::new(measured, text)?;
    if let Some(folder) = &options.out {
        report.write_with_text(folder, "tradeoff.txt")?;
        write_files(folder, &[("tradeoff.csv", csv)])?;
        let plots = if options.pictures == Pictures::None { Vec::new() } else { plots() };
        write_tradeoff_page(folder, about, measured, plots.iter().map(|(_, drawing)| drawing))?;
        for (stem, drawing) in plots {
            write_picture(folder, stem, &drawing)?;
        }
    }
    Ok(report.printed(options.format))
}
