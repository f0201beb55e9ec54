//! The curves of a sweep, of a motion and of a search for an error, as plots.

use crate::plots::plot::{Plot, Series};
use crate::plots::ticks::{Quantity, Scale};
use signorini_mechanics::scene::Model;
use signorini_study::{Level, LevelKind, ObstacleContact, Sweep, SweepCorner, SweepPoint, TotalError};

/// A plotted value of an item.
type Value<'a, T> = &'a dyn Fn(&T) -> f64;

/// Force, contact width (outside plane strain and plane stress, area) and peak pressure over the gap or force of a
/// sweep; of each obstacle, if there are several.
pub(crate) fn sweep_plots(sweep: &Sweep) -> Vec<Plot> {
    let points = &sweep.points;
    let Some(first) = points.first() else { return Vec::new() };
    let units = first.answer.model().units();
    let (swept, swept_in) = match first.force {
        Some(_) => ("force F", &units.force),
        None => ("gap g", &units.length),
    };
    let over_gap = |name: &str, unit: &str, series: Vec<Series>| {
        let mut plot = Plot::new(Quantity::new(swept, swept_in), Quantity::new(name, unit), series);
        plot.nested = true;
        plot.y_from_zero = true;
        plot
    };
    // Beside the exact path the gaps are marks without a line.
    let of_all = |name: &str, unit: &str, at_point: Value<SweepPoint>, at_corner: Value<SweepCorner>| {
        let join = if sweep.corners.is_empty() { None } else { Some([f64::NAN; 2]) };
        let at = |point: &SweepPoint| [point.force.unwrap_or(point.gap), at_point(point)];
        let at_points = points.iter().flat_map(|point| [Some(at(point)), join]).flatten().collect();
        let exact = sweep.corners.iter().map(|corner| [corner.gap, at_corner(corner)]).collect::<Vec<_>>();
        let marks = if first.force.is_some() { "forces of the sweep" } else { "gaps of the sweep" };
        let mut series = vec![Series::new(marks, at_points)];
        if !exact.is_empty() {
            series.insert(0, Series::new("exact path", exact));
        }
        over_gap(name, unit, series)
    };
    let of_each = |name: &str, unit: &str, of: Value<ObstacleContact>| {
        let series = first.summary.contact.obstacles.iter().enumerate().map(|(index, one)| {
            let at =
                |point: &SweepPoint| [point.force.unwrap_or(point.gap), of(&point.summary.contact.obstacles[index])];
            Series::new(&one.of, points.iter().map(at).collect())
        });
        over_gap(name, unit, series.collect())
    };
    let (contact, several) =
        (|point: &SweepPoint| point.summary.contact.clone(), first.summary.contact.is_of_several());
    let square = format!("{}²", units.length);
    let extent = match (first.summary.contact.width.is_some(), several) {
        (true, true) => of_each("estimated width", &units.length, &|one| {
            one.estimate.and_then(|estimate| estimate.width).unwrap_or(0.0)
        }),
        (false, true) => of_each("estimated area", &square, &|one| one.estimate.map_or(0.0, |estimate| estimate.area)),
        (true, false) => {
            let width = |point: &SweepPoint| contact(point).width.unwrap_or(0.0);
            of_all("width of the cells of closed nodes", &units.length, &width, &|corner| corner.width.unwrap_or(0.0))
        }
        (false, false) => {
            let area = |point: &SweepPoint| contact(point).area.unwrap_or(0.0);
            of_all("area of the cells of closed nodes", &square, &area, &|corner| corner.area)
        }
    };
    let travel = || of_all("travel d", &units.length, &|point| point.travel().unwrap_or(0.0), &|_| 0.0);
    let force = match several {
        true => of_each("force", &units.force, &|one| one.force),
        false => of_all("sum of multipliers", &units.force, &|point| contact(point).force, &|corner| corner.force),
    };
    let peak = match several {
        true => of_each("peak pressure", &units.pressure(), &|one| one.pressure_max),
        false => {
            of_all("peak pressure", &units.pressure(), &|p| contact(p).pressure_max.unwrap_or(0.0), &|c| c.pressure_max)
        }
    };
    let of_forces: Vec<Plot> = match first.force {
        Some(_) if several => vec![travel(), force],
        Some(_) => vec![travel()],
        None => vec![force],
    };
    of_forces.into_iter().chain([extent, peak]).collect()
}

/// Contact force and energies over the time of a motion; `history` has the columns of `history.csv`.
pub(crate) fn history_plots(model: &Model, history: &[[f64; 9]]) -> Vec<Plot> {
    let line = |name: &str, column: usize| Series::new(name, history.iter().map(|row| [row[0], row[column]]).collect());
    let units = model.units();
    let work = format!("{} {}", units.force, units.length);
    let force = if model.obstacles().len() > 1 { "contact force F of all obstacles" } else { "contact force F" };
    let energies = vec![line("kinetic", 4), line("strain", 5), line("potential", 6), line("total", 7)];
    let time = || Quantity::new("time t", units.time());
    vec![
        Plot::new(
            time(),
            Quantity::new(force, &units.force),
            vec![line("of each step", 1), line("mean over the window of the peak, at its end", 8)],
        ),
        Plot::new(time(), Quantity::new("energy", work.trim()), energies),
    ]
}

/// The errors over the unknowns of the meshes, and the goal.
pub(crate) fn error_plot(found: &TotalError) -> Plot {
    let line = |name: &str, value: &dyn Fn(&Level) -> Option<f64>| {
        let point = |level: &Level| Some([level.dofs as f64, value(level)?]);
        Series::new(name, found.levels.iter().filter_map(point).collect())
    };
    let of_mean = |level: &Level| match level.kind {
        LevelKind::Guaranteed { mean_stress_error, .. } => Some(mean_stress_error),
        LevelKind::Estimated { .. } => None,
    };
    let (name, axes) = match found.total_error.guaranteed {
        true => ("displacement", ["unknowns of the displacement", "guaranteed relative error"]),
        false => ("estimated", ["unknowns", "total error, relative"]),
    };
    let series = [
        line(name, &|level| Some(level.total_error)),
        line("mean stress", &of_mean),
        line("contact force", &Level::half_width),
        line("goal", &|_| Some(found.goal.total_error)),
    ];
    let series = series.into_iter().filter(|series| !series.points.is_empty()).collect();
    let [x, y] = axes.map(|name| Quantity::new(name, ""));
    Plot { scales: [Scale::Logarithmic; 2], ..Plot::new(x, y, series) }
}
