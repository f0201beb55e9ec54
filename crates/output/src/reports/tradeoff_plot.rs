//! A trade-off as a picture: error over time, a curve for each method with its settings (a way).

use super::report::plural;
use super::tradeoff::unknowns;
use crate::draw::drawing::Drawing;
use crate::plots::medium::Medium;
use crate::plots::plot::{Plot, Series, line_plots_for};
use crate::plots::ticks::{Quantity, Scale};
use signorini_study::{Tradeoff, TradeoffMesh, TradeoffPoint};

/// An error below this is rounding: the answer is exact for its mesh.
const EXACT: f64 = 3e-16;

/// Total errors below this are rounding, and no result of a mesh.
pub(crate) const OF_ROUNDING: f64 = 1e-10;

/// Most curves in one panel: more could not be distinguished.
const MOST_CURVES: usize = 6;

/// An answer is as good as its mesh allows if its total error is at most this times the error of the mesh.
const NEARLY: f64 = 1.05;

fn way(point: &TradeoffPoint) -> String {
    format!("{}, {} dofs", point.method, unknowns(point))
}

/// The points of each way, in the order of the ways.
fn by_way<'a>(points: impl Iterator<Item = &'a TradeoffPoint>) -> Vec<(String, Vec<&'a TradeoffPoint>)> {
    let mut ways: Vec<(String, Vec<&TradeoffPoint>)> = Vec::new();
    for point in points {
        let name = way(point);
        match ways.iter_mut().find(|entry| entry.0 == name) {
            Some(entry) => entry.1.push(point),
            None => ways.push((name, vec![point])),
        }
    }
    ways
}

/// The ways that get a curve: those on the Pareto front, then the fastest; the best come first.
fn chosen(mut ways: Vec<(String, Vec<&TradeoffPoint>)>) -> Vec<(String, Vec<&TradeoffPoint>)> {
    let best = |points: &[&TradeoffPoint]| points.iter().filter(|point| point.best).count();
    let fastest = |points: &[&TradeoffPoint]| points.iter().map(|point| point.seconds).fold(f64::INFINITY, f64::min);
    // The fastest way to the exact answer is always shown.
    let exact = |points: &[&TradeoffPoint]| {
        let exact = points.iter().filter(|point| point.energy_error <= EXACT).map(|point| point.seconds);
        exact.fold(f64::INFINITY, f64::min)
    };
    let soonest = ways.iter().map(|way| exact(&way.1)).fold(f64::INFINITY, f64::min);
    let rank = |points: &[&TradeoffPoint]| (best(points), usize::from(soonest.is_finite() && exact(points) == soonest));
    ways.sort_by(|a, b| rank(&b.1).cmp(&rank(&a.1)).then(fastest(&a.1).total_cmp(&fastest(&b.1))));
    ways.truncate(MOST_CURVES);
    ways
}

/// The error in the energy over the seconds of the best methods, a plot for each mesh, for a screen or for paper.
pub(crate) fn tradeoff_plot(medium: Medium, title: &str, tradeoff: &Tradeoff) -> Drawing {
    let panel = |(index, mesh): (usize, &TradeoffMesh)| {
        let of_mesh = || tradeoff.points.iter().filter(move |point| point.mesh == index);
        let place = |point: &TradeoffPoint| [point.seconds, point.energy_error];
        let all = by_way(of_mesh());
        let count = all.len();
        let series = curves(chosen(all), place);
        let mut band: Vec<[f64; 2]> = of_mesh().filter(|point| point.best).map(place).collect();
        band.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let rest = if series.len() < count { format!(", {} of {count} ways", series.len()) } else { String::new() };
        Plot {
            title: format!("{} dofs, {}{rest}", mesh.dofs, plural(mesh.contact_rows, "contact row")),
            level: mesh.discretisation_error.map(|error| ("error of the mesh".into(), error)),
            ..error_over_time("relative energy error of the algebra", series, band)
        }
    };
    let panels: Vec<Plot> = tradeoff.meshes.iter().enumerate().map(panel).collect();
    line_plots_for(medium, title, &panels)
}

/// Total error over time: a curve for each way, a point for each mesh: the cheapest answer with hardly more error than
/// the mesh.
pub(crate) fn total_error_plot(medium: Medium, title: &str, tradeoff: &Tradeoff) -> Drawing {
    let near = |point: &&TradeoffPoint| {
        let of_mesh = tradeoff.meshes.get(point.mesh).and_then(|mesh| mesh.discretisation_error);
        of_mesh.zip(point.total_error).is_some_and(|(of_mesh, total)| total <= NEARLY * of_mesh)
    };
    let mut ways = by_way(tradeoff.points.iter().filter(near));
    for (_, points) in &mut ways {
        points
            .sort_by(|a, b| (a.mesh, a.seconds).partial_cmp(&(b.mesh, b.seconds)).unwrap_or(std::cmp::Ordering::Equal));
        points.dedup_by_key(|point| point.mesh);
    }
    let place = |point: &TradeoffPoint| [point.seconds, point.total_error.unwrap_or(f64::NAN)];
    let all: Vec<[f64; 2]> = ways.iter().flat_map(|way| &way.1).map(|point| place(point)).collect();
    let mut band: Vec<[f64; 2]> =
        all.iter().zip(Tradeoff::on_front(&all)).filter(|point| point.1).map(|point| *point.0).collect();
    band.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let panel = Plot {
        title: format!("a point for each of the {} meshes", tradeoff.meshes.len()),
        ..error_over_time("relative total error, mesh estimated", curves(chosen(ways), place), band)
    };
    line_plots_for(medium, title, &[panel])
}

/// Error over time on logarithmic axes, the names beside the curves, with the Pareto front as a band.
fn error_over_time(error: &str, series: Vec<Series>, front: Vec<[f64; 2]>) -> Plot {
    Plot {
        scales: [Scale::Logarithmic; 2],
        names_beside: true,
        band: Some(Series::new("Pareto front", front)),
        exact: EXACT,
        ..Plot::new(Quantity::new("time", "s"), Quantity::new(error, ""), series)
    }
}

fn curves(ways: Vec<(String, Vec<&TradeoffPoint>)>, place: fn(&TradeoffPoint) -> [f64; 2]) -> Vec<Series> {
    ways.into_iter().map(|(name, points)| Series::new(name, points.into_iter().map(place).collect())).collect()
}
