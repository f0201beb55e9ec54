//! `signorini tradeoff`: one scene with every method, and the cost of each digit.

use serde::Serialize;

use super::about::about;
use super::input::{Input, build, read_scene, rests, scene_title, warnings};
use super::options;
use super::outcome::{OfPart, Outcome, Report, warn};
use crate::Error;
use crate::output::{About, Measured, Pictures, write_files};
use crate::qp::{Settings, Watch};
use crate::scene::Units;
use crate::study::{MotionTradeoff, Tradeoff, TradeoffGrid};

/// Largest number of finer meshes if only the time limits them.
const MOST_REFINEMENTS: usize = 8;

pub(super) fn run(options: &options::Tradeoff, watch: &Watch) -> Result<Outcome, Error> {
    let grid = TradeoffGrid {
        refinements: options.refinements.map_or(if options.time.is_some() { MOST_REFINEMENTS } else { 1 }, usize::from),
        runs: options.runs.into(),
        most_full_dofs: options.most_full_dofs,
        seconds: options.time.unwrap_or(f64::INFINITY),
    };
    let about = |title: &str| about(title, "tradeoff", &options.input, options.out.as_ref(), None);
    if options.input.is_dir() {
        let input = Input::read(&options.input, &options.limits)?;
        let measured = Tradeoff::of_problem(input.problem(), &grid, watch)?;
        return reported(options, watch, &about(&input.title), &measured, &measured, "");
    }
    let scene = read_scene(&options.input, &options.limits)?;
    let moves = scene.dynamic().is_some();
    if !moves {
        rests(&scene)?;
    }
    let model = if moves {
        scene.build_within(options.limits.most_memory())?
    } else {
        build(&scene, &options.input, &options.limits)?
    };
    warn(&warnings(&model));
    let about = &about(&scene_title(&model, &options.input));
    if moves {
        let measured = MotionTradeoff::of(&scene, &Settings::default().watched(watch))?;
        return reported(options, watch, about, &measured, &measured, "");
    }
    let measured = Tradeoff::of_scene(&scene, &grid, watch)?;
    let is_part = model.parts_of_whole() > 1.0;
    let remark = if is_part { "All numbers but the error of the mesh are of the meshed part.\n" } else { "" };
    let report = OfPart::new(&measured, is_part, &["advice", "meshes", "points"]);
    reported(options, watch, about, &measured, &report, remark)
}

/// Reports the measurements as `shown`, with a remark below them, and their values and pictures in the folder of the
/// options.
fn reported(
    options: &options::Tradeoff,
    watch: &Watch,
    about: &About,
    measured: &impl Measured,
    shown: &impl Serialize,
    remark: &str,
) -> Result<Outcome, Error> {
    watch.step("report", 0);
    let report = Report::new(shown, measured.text(&about.title, &Units::unnamed()) + remark)?;
    if let Some(folder) = &options.out {
        report.write_with_text(folder, "tradeoff.txt")?;
        write_files(folder, &[("tradeoff.csv", measured.csv())])?;
        let is_drawn = options.pictures != Pictures::None;
        let plots = if is_drawn { measured.plots(options.style, &about.title) } else { Vec::new() };
        about.write_tradeoff(folder, shown, plots.iter().map(|(_, drawing)| drawing))?;
        for (stem, drawing) in plots {
            drawing.write(folder, stem)?;
        }
    }
    Ok(report.printed(options.format))
}
