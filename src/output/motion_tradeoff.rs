//! The cost of each scheme of a motion, as a table, as comma-separated values, and as a picture of error over time.

use super::certificate::number;
use super::medium::Medium;
use super::plot::line_plots_for;
use super::report::columns;
use super::text::printable;
use super::{Drawing, Plot, Quantity, Scale, Series};
use crate::study::{MotionPoint, MotionTradeoff};

const HEADING: [&str; 8] =
    ["scheme", "step", "steps", "seconds", "displacement error", "impulse error", "energy change", "penetration"];

/// The table of a trade-off of motions, one line for each scheme and step; a star marks the Pareto front.
pub fn motion_tradeoff_text(title: &str, tradeoff: &MotionTradeoff) -> String {
    let mut table = vec![HEADING.map(String::from).to_vec()];
    table.extend(tradeoff.points.iter().map(|point| {
        let star = if point.best { " *" } else { "" };
        vec![
            format!("{}{star}", point.scheme),
            format!("{:.3e}", point.step),
            point.steps.to_string(),
            format!("{:.4}", point.seconds),
            number(point.displacement_error),
            number(point.impulse_error),
            format!("{:.1e}", point.energy_change),
            number(point.penetration),
        ]
    }));
    format!(
        "{}\n\n{} dofs; errors against `midpoint` on the same mesh with the step {:.3e}\n{}\nA star: no other row \
         is both faster and as accurate.\n",
        printable(title),
        tradeoff.dofs,
        tradeoff.reference_step,
        columns(&table)
    )
}

/// The points of a trade-off of motions as comma-separated values, one line each under a heading.
pub fn motion_tradeoff_csv(tradeoff: &MotionTradeoff) -> String {
    let heading = "scheme,step,steps,seconds,displacement_error,impulse_error,energy_change,penetration,best\n";
    let row = |p: &MotionPoint| {
        format!(
            "{},{:e},{},{:e},{:e},{:e},{:e},{:e},{}\n",
            p.scheme,
            p.step,
            p.steps,
            p.seconds,
            p.displacement_error,
            p.impulse_error,
            p.energy_change,
            p.penetration,
            p.best
        )
    };
    heading.to_string() + &tradeoff.points.iter().map(row).collect::<String>()
}

/// A picture of the error over the seconds of a run, a line for each scheme, on logarithmic axes.
pub fn motion_tradeoff_plot(title: &str, tradeoff: &MotionTradeoff) -> Drawing {
    motion_tradeoff_plot_for(Medium::Screen, title, tradeoff)
}

/// The same for a screen or for paper.
pub(crate) fn motion_tradeoff_plot_for(medium: Medium, title: &str, tradeoff: &MotionTradeoff) -> Drawing {
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
