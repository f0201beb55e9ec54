//! The derivatives of outputs as tables.

use super::report::{Column, columns, plural, table};
use crate::text::printable;
use signorini_mechanics::scene::{ByParameter, Model, Sensitivities, Sensitivity};
use signorini_qp::Derivative;

/// Changes in per cent below this are rounding.
const ROUNDING: f64 = 1e-9;

/// Rows at a kink that a text names.
const MOST_ROWS: usize = 12;

/// The tables of all outputs, and the number of rows at a kink.
pub(crate) fn sensitivity_text(title: &str, found: &Sensitivities) -> String {
    let mut text = format!("{}\n", printable(title));
    for output in &found.outputs {
        text += &of_output(output);
    }
    match found.at_kink.len() {
        0 => text,
        count => text + &format!("\n{} at a kink, or undecided by the proof.\n", plural(count, "row")),
    }
}

fn of_output(output: &Sensitivity) -> String {
    let Sensitivity { output: name, value, unit, by, notes } = output;
    let mut text = format!("\n{name} = {}\n", with_unit(&number(*value), unit));
    let of_unit = |row: &ByParameter| match (unit.as_str(), row.unit.as_str()) {
        ("", "") => "-".to_string(),
        (unit, "") => unit.to_string(),
        ("", parameter) => format!("1/{parameter}"),
        (unit, parameter) if unit == parameter => "-".to_string(),
        (unit, parameter) => format!("{unit} / {parameter}"),
    };
    let columns_of: [Column<ByParameter>; 5] = [
        ("parameter", &|row| row.parameter.clone()),
        ("derivative", &|row| in_words(&row.derivative, number)),
        ("unit", &of_unit),
        ("% for 1 %", &|row| row.relative.as_ref().map_or_else(|| "-".to_string(), |of| in_words(of, share))),
        ("verdict", &|row| row.derivative.verdict().to_string()),
    ];
    text += &columns(&table(by, &columns_of));
    let mut reasons: Vec<&str> = notes.iter().map(String::as_str).collect();
    for row in by {
        if let Derivative::Unknown { why } = &row.derivative
            && !reasons.contains(&why.as_str())
        {
            reasons.push(why);
        }
    }
    reasons.iter().for_each(|reason| text += &format!("{}.\n", printable(reason)));
    text
}

/// A derivative, each of its numbers in words by `shown`.
fn in_words(derivative: &Derivative<f64>, shown: fn(f64) -> String) -> String {
    match derivative {
        Derivative::Proven(value) => shown(*value),
        Derivative::OneSided { left, right } => format!("{} left, {} right", shown(*left), shown(*right)),
        Derivative::Undecided { between, .. } => {
            between.iter().map(|value| shown(*value)).collect::<Vec<String>>().join(" or ")
        }
        Derivative::Unknown { .. } => "-".to_string(),
    }
}

/// The rows that make a kink, or that the proof leaves undecided, with their nodes.
pub(crate) fn kink_text(found: &Sensitivities) -> String {
    let (rows, model): (&[usize], &Model) = (&found.at_kink, found.answer.model());
    if rows.is_empty() {
        return String::new();
    }
    let named = |&row: &usize| format!("{row} (node {})", model.rows()[row].node);
    let mut names: Vec<String> = rows.iter().take(MOST_ROWS).map(named).collect();
    if rows.len() > MOST_ROWS {
        names.push(format!("{} more", rows.len() - MOST_ROWS));
    }
    let is_exact = found.outputs.iter().flat_map(|output| &output.by);
    let is_exact = is_exact.into_iter().any(|row| matches!(row.derivative, Derivative::OneSided { .. }));
    let (count, several) = (plural(rows.len(), "row"), rows.len() > 1);
    let what = match is_exact {
        true => "touch without a force: the derivatives to both sides differ",
        false if several => {
            "are neither proven open nor closed; the derivatives are those with all of them open, and closed; the true one may belong to \
             another combination"
        }
        false => "is neither proven open nor closed; the derivatives are those with it open, and closed",
    };
    format!("\n{count} {what}: {}\n", names.join(", "))
}

fn number(value: f64) -> String {
    if value == 0.0 { "0".to_string() } else { format!("{value:.6e}") }
}

/// A change in per cent, to four digits; below 1e-9 it is rounding.
fn share(value: f64) -> String {
    match value.abs() {
        size if size < ROUNDING => "0".to_string(),
        size if size < 1e-3 => format!("{value:.3e}"),
        _ => {
            let rounded = format!("{value:.3e}");
            let exponent = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
            format!("{value:.*}", (3 - exponent.unwrap_or(0)).clamp(0, 6) as usize)
        }
    }
}

fn with_unit(number: &str, unit: &str) -> String {
    if unit.is_empty() { number.to_string() } else { format!("{number} {unit}") }
}

/// The derivatives of an output with respect to the places of all nodes, as comma-separated values; `None` if they are
/// not known.
pub(crate) fn places_csv(model: &Model, output: &Sensitivity) -> Option<String> {
    let places = output.by.iter().find_map(|row| row.places.as_ref()?.proven())?;
    let (dimension, axes) = (model.body().dimension(), ["x", "y", "z"]);
    let heads: Vec<String> = axes[..dimension].iter().map(|axis| axis.to_string()).collect();
    let by: Vec<String> = axes[..dimension].iter().map(|axis| format!("by_{axis}")).collect();
    let mut text = format!("node,{},{}\n", heads.join(","), by.join(","));
    for (node, (at, values)) in model.mesh().nodes().iter().zip(places.chunks(dimension)).enumerate() {
        let numbers: Vec<String> = at[..dimension].iter().chain(values).map(|value| format!("{value:e}")).collect();
        text += &format!("{node},{}\n", numbers.join(","));
    }
    Some(text)
}
