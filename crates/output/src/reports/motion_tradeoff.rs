//! The cost of each scheme of a motion, as a table, as comma-separated values, and as a picture of error over time.

use super::certificate::number;
use super::report::{columns, comma_separated, table};
use crate::draw::drawing::Drawing;
use crate::plots::medium::Medium;
use crate::plots::plot::{Plot, Series, line_plots_for};
use crate::plots::ticks::{Quantity, Scale};
use crate::text::printable;
use signorini_study::MotionTradeoff;

/// The table of a trade-off of motions, one line for each scheme and step; a star marks the Pareto front.
pub(crate) fn motion_tradeoff_text(title: &str, tradeoff: &MotionTradeoff) -> String {
    let points = table(
        &tradeoff.points,
        &[
            ("scheme", &|point| format!("{}{}", point.scheme, if point.best { " *" } else { "" })),
            ("step", &|point| format!("{:.3e}", point.step)),
            ("steps", &|point| point.steps.to_string()),
            ("seconds", &|point| format!("{:.4}", point.seconds)),
            ("displacement error", &|point| number(point.displacement_error)),
            ("impulse error", &|point| number(point.impulse_error)),
            ("energy change", &|point| format!("{:.1e}", point.energy_change)),
            ("penetration", &|point| number(point.penetration)),
        ],
    );
    format!(
        "{}\n\n{} dofs; errors against `fox-goodwin` on the same mesh with the step {:.3e}\n{}\nA star: no other row \
         is both faster and as accurate.\n",
        printable(title),
        tradeoff.dofs,
        tradeoff.reference_step,
        columns(&points)
    )
}

/// The points of a trade-off of motions as comma-separated values, one line each under a heading.
pub(crate) fn motion_tradeoff_csv(tradeoff: &MotionTradeoff) -> String {
    comma_separated(&table(
        &tradeoff.points,
        &[
            ("scheme", &|point| point.scheme.to_string()),
            ("step", &|point| format!("{:e}", point.step)),
            ("steps", &|point| point.steps.to_string()),
            ("seconds", &|point| format!("{:e}", point.seconds)),
            ("displacement_error", &|point| format!("{:e}", point.displacement_error)),
            ("impulse_error", &|point| format!("{:e}", point.impulse_error)),
            ("energy_change", &|point| format!("{:e}", point.energy_change)),
            ("penetration", &|point| format!("{:e}", point.penetration)),
            ("best", &|point| point.best.to_string()),
        ],
    ))
}

/// The error of the displacement over the seconds of each scheme, as a plot for a screen or for paper.
pub(crate) fn motion_tradeoff_plot(medium: Medium, title: &str, tradeoff: &MotionTradeoff) -> Drawing {
    let mut series: Vec<Series> = Vec::new();
    for point in &tradeoff.points {
        let place = [point.seconds, point.displacement_error];
        match series.last_mut().filter(|last| last.name == point.scheme) {
            Some(last) => last.points.push(place),
            None => series.push(Series::new(point.scheme, vec![place])),
        }
    }
    let mut plot = Plot::new(Quantity::new("time", "s"), Quantity::new("displacement error, relative", ""), series);
    plot.scales = [Scale::Logarithmic; 2];
    line_plots_for(medium, title, &[plot])
}
