//! A trade-off as a table, as comma-separated values, and as a picture of error over time.

use super::report::{columns, number, plural, printable};
use super::{Drawing, Plot, Quantity, Scale, Series, line_plots};
use crate::study::{Tradeoff, TradeoffMesh, TradeoffPoint};

/// Errors below this are shown as this on a logarithmic axis: they are below the resolution of doubles.
const LEAST_SHOWN_ERROR: f64 = 1e-16;

/// The columns of the table.
const HEADING: [&str; 10] = [
    "method",
    "setting",
    "unknowns",
    "precision",
    "seconds",
    "energy error",
    "bound",
    "force error",
    "pressure error",
    "misclassified rows",
];

/// The tables of a trade-off, mesh by mesh, and what to choose. A star marks the Pareto front.
pub fn tradeoff_text(title: &str, tradeoff: &Tradeoff) -> String {
    let mut text = format!("{}\n", printable(title));
    for (index, mesh) in tradeoff.meshes.iter().enumerate() {
        let cells = match mesh.divided_by {
            1 => "mesh of the scene".to_string(),
            times => format!("cells cut into {times} along each edge"),
        };
        text += &format!(
            "\n{cells}: {} dofs, {}; the mesh itself is about {:.1e} of the energy norm off\n",
            mesh.dofs,
            plural(mesh.contact_rows, "contact row"),
            mesh.discretisation_error
        );
        let mut table = vec![HEADING.map(String::from).to_vec()];
        table.extend(tradeoff.points.iter().filter(|point| point.mesh == index).map(row));
        text += &columns(&table);
    }
    text += &format!(
        "\nEach time is the fastest of {}; a star: no other way is faster and as accurate.\n",
        plural(tradeoff.runs, "run")
    );
    text + &advice(tradeoff)
}

fn row(point: &TradeoffPoint) -> Vec<String> {
    let star = if point.best { " *" } else { "" };
    vec![
        format!("{}{star}", point.method),
        point.knob.map_or_else(|| "-".to_string(), |knob| format!("{knob:.0e}")),
        unknowns(point).to_string(),
        precision(point).to_string(),
        format!("{:.5}", point.seconds),
        number(point.energy_error),
        if point.energy_error_bound.is_finite() { number(point.energy_error_bound) } else { "none".to_string() },
        number(point.force_error),
        number(point.pressure_error),
        point.rows_wrong.to_string(),
    ]
}

fn unknowns(point: &TradeoffPoint) -> &'static str {
    if point.condensed { "contact" } else { "all" }
}

fn precision(point: &TradeoffPoint) -> &'static str {
    if point.mixed { "mixed" } else { "double" }
}

/// A way in words.
fn way(point: &TradeoffPoint) -> String {
    let told = match (point.method, point.knob) {
        (_, None) => String::new(),
        ("penalty", Some(knob)) => format!(" up to {knob:.0e} times the stiffness"),
        (_, Some(knob)) => format!(" to {knob:.0e}"),
    };
    let mixed = if point.mixed { ", mixed precision" } else { "" };
    format!("{}{told} on {} dofs{mixed}", point.method, unknowns(point))
}

fn advice(tradeoff: &Tradeoff) -> String {
    let mut lines = vec!["\nWhat to choose on the mesh of the scene:".to_string()];
    let off = tradeoff.meshes.first().map_or(0.0, |mesh| mesh.discretisation_error);
    for advice in &tradeoff.advice {
        let wanted = match (advice.accuracy, advice.seconds) {
            (Some(accuracy), _) => format!("energy error {accuracy:.0e}"),
            (None, seconds) => {
                format!("within {:.5} s, a tenth of the reference method's time", seconds.unwrap_or(0.0))
            }
        };
        let choice = match advice.point.and_then(|index| tradeoff.points.get(index)) {
            Some(point) => format!("{}: {:.5} s, energy error {:.1e}", way(point), point.seconds, point.energy_error),
            None => "no measured method reaches it".to_string(),
        };
        let useless = advice.accuracy.is_some_and(|accuracy| accuracy < 1e-2 * off);
        lines
            .push(format!("  {wanted:<58}{choice}{}", if useless { " (far below the error of the mesh)" } else { "" }));
    }
    lines.join("\n") + "\n"
}

/// The points as comma-separated values, a line each under a heading.
pub fn tradeoff_csv(tradeoff: &Tradeoff) -> String {
    let mut text =
        "mesh,divided_by,dofs,contact_rows,discretisation_error,method,knob,unknowns,precision,seconds,energy_error,\
                    energy_error_bound,force_error,pressure_error,rows_wrong,best\n"
            .to_string();
    for point in &tradeoff.points {
        let Some(mesh) = tradeoff.meshes.get(point.mesh) else { continue };
        text += &format!(
            "{},{},{},{},{:e},\"{}\",{},{},{},{:e},{:e},{:e},{:e},{:e},{},{}\n",
            point.mesh,
            mesh.divided_by,
            mesh.dofs,
            mesh.contact_rows,
            mesh.discretisation_error,
            point.method,
            point.knob.map_or_else(String::new, |knob| format!("{knob:e}")),
            unknowns(point),
            precision(point),
            point.seconds,
            point.energy_error,
            point.energy_error_bound,
            point.force_error,
            point.pressure_error,
            point.rows_wrong,
            u8::from(point.best)
        );
    }
    text
}

/// Error over time, a panel a mesh, a line a method, and the Pareto front.
pub fn tradeoff_plot(title: &str, tradeoff: &Tradeoff) -> Drawing {
    let panel = |(index, mesh): (usize, &TradeoffMesh)| {
        let of_mesh = || tradeoff.points.iter().filter(move |point| point.mesh == index);
        let place = |point: &TradeoffPoint| [point.seconds, point.energy_error.max(LEAST_SHOWN_ERROR)];
        let mut series: Vec<Series> = Vec::new();
        for point in of_mesh() {
            let mixed = if point.mixed { ", mixed" } else { "" };
            let name = format!("{}, {} dofs{mixed}", point.method, unknowns(point));
            match series.iter_mut().find(|series| series.name == name) {
                Some(series) => series.points.push(place(point)),
                None => series.push(Series::new(name, vec![place(point)])),
            }
        }
        let mut front: Vec<[f64; 2]> = of_mesh().filter(|point| point.best).map(place).collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        series.push(Series::new("Pareto front", front));
        let (x, y) = (Quantity::new("time", "s"), Quantity::new("relative energy error of the algebra", ""));
        let title = format!("{} dofs, {}", mesh.dofs, plural(mesh.contact_rows, "contact row"));
        Plot { title, scales: [Scale::Logarithmic; 2], ..Plot::new(x, y, series) }
    };
    let plots: Vec<Plot> = tradeoff.meshes.iter().enumerate().map(panel).collect();
    line_plots(title, &plots)
}
