//! A trade-off as a table and as comma-separated values.

use super::certificate::number;
use super::report::{Column, columns, comma_separated, plural, table};
use crate::text::printable;
use signorini_study::{Tradeoff, TradeoffPoint};

/// The energy error of an answer that is called loose.
const LOOSE: f64 = 1e-2;

/// A relative error of the force below this is rounding.
const LEAST_LOST: f64 = 1e-10;

/// The tables of a trade-off, mesh by mesh, and the recommended choice. A star marks the Pareto front.
pub(crate) fn tradeoff_text(title: &str, tradeoff: &Tradeoff) -> String {
    let mut text = format!("{}\n", printable(title));
    for (index, mesh) in tradeoff.meshes.iter().enumerate() {
        let cells = match mesh.divided_by {
            1 => "mesh of the scene".to_string(),
            times => format!("each edge of the scene's cells divided into {times}"),
        };
        let (cells, off) = match mesh.discretisation_error {
            Some(error) => (cells, format!("; the relative error of the mesh in the energy norm is about {error:.1e}")),
            None => ("matrices".to_string(), String::new()),
        };
        text += &format!("\n{cells}: {} dofs, {}{off}\n", mesh.dofs, plural(mesh.contact_rows, "contact row"));
        text += &columns(&table(tradeoff.points.iter().filter(|point| point.mesh == index), &COLUMNS));
    }
    text += &format!(
        "\nEach time is the fastest of at least {}, from the data to the answer; certificate and proof have \
         columns of their own.\n\
         A setting is the tolerance of the interior point, the accuracy of multigrid, the last penalty over the \
         local stiffness.\nA star: no other row is both faster and as accurate.\n",
        plural(tradeoff.runs, "run")
    );
    let unsettled = tradeoff.points.iter().filter(|point| !point.is_repeated).count();
    if unsettled > 0 && tradeoff.runs > 1 {
        let of = tradeoff.points.len();
        text += &format!("{unsettled} of {of} times could not be repeated to 3 %: other work runs on this machine.\n");
    }
    text + &advice(tradeoff)
}

/// The columns of the printed points of a trade-off.
const COLUMNS: [Column<TradeoffPoint>; 11] = [
    ("method", &|point| format!("{}{}", point.method, if point.best { " *" } else { "" })),
    ("setting", &|point| point.knob.map_or_else(|| "-".to_string(), |knob| format!("{knob:.0e}"))),
    ("unknowns", &|point| unknowns(point).to_string()),
    ("seconds", &|point| format!("{:.5}", point.seconds)),
    ("certificate", &|point| number(point.certificate_seconds)),
    ("proof", &|point| number(point.proof_seconds)),
    ("energy error", &|point| number(point.energy_error)),
    ("bound", &|point| match point.energy_error_bound {
        bound if bound.is_finite() => number(bound),
        _ => "none".to_string(),
    }),
    ("force error", &|point| number(point.force_error)),
    ("pressure error", &|point| point.pressure_error.map_or_else(|| "-".to_string(), number)),
    ("misclassified rows", &|point| point.rows_wrong.to_string()),
];

pub(crate) fn unknowns(point: &TradeoffPoint) -> &'static str {
    if point.condensed { "contact" } else { "all" }
}

/// A method with its settings in words.
fn way(point: &TradeoffPoint) -> String {
    let named = match (point.method, point.knob) {
        (_, None) => String::new(),
        ("penalty", Some(knob)) => format!(" up to {knob:.0e} times the stiffness"),
        (_, Some(knob)) => format!(" to {knob:.0e}"),
    };
    format!("{}{named} on {} dofs", point.method, unknowns(point))
}

fn advice(tradeoff: &Tradeoff) -> String {
    let off = tradeoff.meshes.first().and_then(|mesh| mesh.discretisation_error);
    let place = if off.is_some() { " on the mesh of the scene" } else { "" };
    let (mut lines, off) = (vec![format!("\nWhat to choose{place}:")], off.unwrap_or(0.0));
    for advice in tradeoff.advice.iter().filter(|advice| !advice.chooses_mesh) {
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
    lines.join("\n") + "\n" + &losses(&tradeoff.points) + &advice_of_meshes(tradeoff)
}

/// Mesh and method for a total error and for a time, a sentence each.
fn advice_of_meshes(tradeoff: &Tradeoff) -> String {
    if tradeoff.advice.iter().all(|advice| !advice.chooses_mesh) {
        return String::new();
    }
    let mut text =
        "\nMesh and method for a total error (the error of the mesh is estimated and included):\n".to_string();
    for advice in tradeoff.advice.iter().filter(|advice| advice.chooses_mesh) {
        let wanted = match (advice.total_error, advice.seconds) {
            (Some(total), _) => format!("for {:.0} %", 100.0 * total),
            (None, seconds) => format!("in {} s", seconds.unwrap_or(0.0)),
        };
        let chosen = advice.point.and_then(|index| tradeoff.points.get(index));
        let choice = chosen.and_then(|point| Some((point, tradeoff.meshes.get(point.mesh)?))).map_or_else(
            || "none of the measured meshes and methods".to_string(),
            |(point, mesh)| {
                let total = 100.0 * point.total_error.unwrap_or(f64::INFINITY);
                format!("{} dofs by {}: {:.5} s, {total:.1} % off", mesh.dofs, way(point), point.seconds)
            },
        );
        text += &format!("  {wanted:<10}{choice}\n");
    }
    text
}

/// Time and force error of the cheapest loose answer of each method that is never exact, beside the exact active set.
fn losses(points: &[TradeoffPoint]) -> String {
    let cheapest = |method: &str, good: &dyn Fn(&TradeoffPoint) -> bool| {
        let own = points.iter().filter(|point| point.mesh == 0 && point.method == method && good(point));
        own.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    };
    let named = |point: &TradeoffPoint| {
        let lost = match point.force_error {
            error if error <= LEAST_LOST => "nothing".to_string(),
            error => format!("{:.1e} % of the force", 100.0 * error),
        };
        format!("{} takes {:.5} s and loses {lost}", way(point), point.seconds)
    };
    let Some(exact) = cheapest("active-set", &|point| point.knob.is_none()) else { return String::new() };
    let loose = |method| cheapest(method, &|point| point.energy_error <= LOOSE);
    let compared = |method| loose(method).map(|loose| format!("  {}; {}\n", named(loose), named(exact)));
    ["penalty", "qp", "mprgp"].into_iter().filter_map(compared).collect()
}

/// The points as comma-separated values, a line each under a heading.
pub(crate) fn tradeoff_csv(tradeoff: &Tradeoff) -> String {
    let given = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
    let points = tradeoff.points.iter().filter_map(|point| Some((tradeoff.meshes.get(point.mesh)?, point)));
    comma_separated(&table(
        &points.collect::<Vec<_>>(),
        &[
            ("mesh", &|(_, point)| point.mesh.to_string()),
            ("divided_by", &|(mesh, _)| mesh.divided_by.to_string()),
            ("dofs", &|(mesh, _)| mesh.dofs.to_string()),
            ("contact_rows", &|(mesh, _)| mesh.contact_rows.to_string()),
            ("discretisation_error", &|(mesh, _)| given(mesh.discretisation_error)),
            ("method", &|(_, point)| format!("\"{}\"", point.method)),
            ("knob", &|(_, point)| given(point.knob)),
            ("unknowns", &|(_, point)| unknowns(point).to_string()),
            ("seconds", &|(_, point)| format!("{:e}", point.seconds)),
            ("certificate_seconds", &|(_, point)| format!("{:e}", point.certificate_seconds)),
            ("proof_seconds", &|(_, point)| format!("{:e}", point.proof_seconds)),
            ("energy_error", &|(_, point)| format!("{:e}", point.energy_error)),
            ("total_error", &|(_, point)| given(point.total_error)),
            ("energy_error_bound", &|(_, point)| format!("{:e}", point.energy_error_bound)),
            ("force_error", &|(_, point)| format!("{:e}", point.force_error)),
            ("pressure_error", &|(_, point)| given(point.pressure_error)),
            ("rows_wrong", &|(_, point)| point.rows_wrong.to_string()),
            ("best", &|(_, point)| u8::from(point.best).to_string()),
        ],
    ))
}
