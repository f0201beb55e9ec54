//! The output of a sweep of a problem directory: its table, its answers, and its force along the sweep.

use std::path::Path;

use super::gallery::{Pictures, Wanted};
use crate::file::write_files;
use crate::plots::plot::{Plot, Series, line_plots_for};
use crate::plots::ticks::Quantity;
use crate::reports::certificate::conditions;
use crate::reports::in_words::InWords;
use crate::reports::report::{columns, events_text, plural, table};
use crate::text::printable;
use signorini_mechanics::Error;
use signorini_mechanics::scene::Units;
use signorini_study::{ProblemPoint, ProblemSweep};

/// The table of a sweep, and the events between its points.
fn problem_sweep_text(title: &str, sweep: &ProblemSweep) -> String {
    let points = table(
        &sweep.points,
        &[
            ("t", &|point| format!("{:.6}", point.t)),
            ("iterations", &|point| point.summary.solution.iterations.to_string()),
            ("contact", &|point| point.summary.contact.count.to_string()),
            ("-sum(lambda)", &|point| format!("{:.9e}", point.summary.contact.force)),
            ("energy error <=", &|point| conditions(&point.summary.solution.certificate)[5].2.clone()),
            ("status", &|point| point.summary.status.words().to_owned()),
        ],
    );
    let text = format!("{}, from t = 0 to its other end at t = 1\n\n{}", printable(title), columns(&points));
    let Some(events) = &sweep.events else { return text };
    let (times, exactly) = (plural(events.len(), "time"), if events.is_empty() { "" } else { ", exactly at" });
    let lines = events_text(events.iter().map(|event| (event.t, format!("row {}", event.row), event.touches)));
    format!("{text}\nBetween the ends a row touches or releases {times}{exactly}\n{lines}")
}

impl Wanted {
    /// Writes the answer of each point (`point-01/u.mtx`, `point-01/lambda.mtx`, ...), from which a later solve may
    /// start.
    ///
    /// # Errors
    /// [`qp::LinearError::File`](signorini_qp::LinearError::File).
    pub fn write_points(folder: &Path, sweep: &ProblemSweep) -> Result<(), Error> {
        for (index, point) in sweep.points.iter().enumerate() {
            write_files(&folder.join(format!("point-{:02}", index + 1)), &point.summary.solution.files())?;
        }
        Ok(())
    }

    /// Draws the sum of the multipliers and the number of closed rows along the sweep (`force`).
    ///
    /// # Errors
    /// [`qp::LinearError::File`](signorini_qp::LinearError::File),
    /// [`qp::LinearError::Numerical`](signorini_qp::LinearError::Numerical).
    pub fn draw_problem_sweep(self, folder: &Path, title: &str, sweep: &ProblemSweep) -> Result<(), Error> {
        if self.pictures == Pictures::None {
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
        line_plots_for(self.medium, title, &plots).write(folder, "force").map(drop)
    }
}

impl InWords for ProblemSweep {
    fn text(&self, title: &str, _: &Units) -> String {
        problem_sweep_text(title, self)
    }
}
