//! The output of a sweep of a problem directory: its table, its answers, and its force along the sweep.

use std::path::Path;

use super::certificate::conditions;
use super::gallery::{Pictures, Wanted};
use super::plot::line_plots_for;
use super::report::{MOST_EVENTS, columns, plural};
use super::text::printable;
use super::{Plot, Quantity, Series, write_files, write_picture};
use crate::error::Error;
use crate::qp::solution_files;
use crate::study::{ProblemPoint, ProblemSweep};

/// The table of a sweep, and the events between its points.
pub(crate) fn problem_sweep_text(title: &str, sweep: &ProblemSweep) -> String {
    let header = ["t", "iterations", "contact", "-sum(lambda)", "energy error <=", "status"].map(String::from);
    let row = |point: &ProblemPoint| {
        let summary = &point.summary;
        vec![
            format!("{:.6}", point.t),
            summary.solution.iterations.to_string(),
            summary.contact.count.to_string(),
            format!("{:.9e}", summary.contact.force),
            conditions(&summary.solution.certificate)[5].2.clone(),
            summary.status.words().to_owned(),
        ]
    };
    let table: Vec<Vec<String>> = std::iter::once(header.to_vec()).chain(sweep.points.iter().map(row)).collect();
    let mut text = format!("{}, from t = 0 to its other end at t = 1\n\n{}", printable(title), columns(&table));
    let Some(events) = &sweep.events else { return text };
    let times = plural(events.len(), "time");
    text += &format!(
        "\nBetween the ends a row touches or releases {times}{}\n",
        if events.is_empty() { "" } else { ", exactly at" }
    );
    let lines: Vec<Vec<String>> = events
        .iter()
        .take(MOST_EVENTS)
        .map(|event| {
            let what = if event.touches { "touches" } else { "releases" };
            vec![format!("  {:.12}", event.t), format!("row {}", event.row), what.to_string()]
        })
        .collect();
    text += &columns(&lines);
    if events.len() > MOST_EVENTS {
        text += &format!("  and {} more; --format json has all\n", events.len() - MOST_EVENTS);
    }
    text
}

/// Writes the answer of each point (`point-01/u.mtx`, `point-01/lambda.mtx`, ...), from which a later solve may start.
///
/// # Errors
/// [`Error::File`].
pub(crate) fn write_points(folder: &Path, sweep: &ProblemSweep) -> Result<(), Error> {
    for (index, point) in sweep.points.iter().enumerate() {
        write_files(&folder.join(format!("point-{:02}", index + 1)), &solution_files(&point.summary.solution))?;
    }
    Ok(())
}

/// Draws the sum of the multipliers and the number of closed rows along the sweep (`force`).
///
/// # Errors
/// [`Error::File`], [`Error::Numerical`].
pub(crate) fn draw_problem_sweep(
    folder: &Path,
    title: &str,
    sweep: &ProblemSweep,
    wanted: Wanted,
) -> Result<(), Error> {
    if wanted.pictures == Pictures::None {
        return Ok(());
    }
    let over_way = |name: &str, of: fn(&ProblemPoint) -> f64| {
        let points = sweep.points.iter().map(|point| [point.t, of(point)]).collect();
        Plot::new(Quantity::new("way t", ""), Quantity::new(name, ""), vec![Series::new(name, points)])
    };
    let plots = [
        over_way("sum of multipliers", |point| point.summary.contact.force),
        over_way("closed rows", |point| point.summary.contact.count as f64),
    ];
    write_picture(folder, "force", &line_plots_for(wanted.medium, title, &plots)).map(drop)
}
