//! The measurements as tables and as a picture.

use serde_json::Value;
use signorini::output::{Drawing, Plot, Quantity, Scale, Series, line_plots};

use crate::table::table;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Formats a number, or returns a dash if it was not measured.
fn known(value: &Value, words: impl Fn(f64) -> String) -> String {
    value.as_f64().map_or("-".into(), words)
}

fn gigabytes(value: &Value) -> f64 {
    number(value) / 1e9
}

/// Returns the cells of one case.
fn cells(case: &Value) -> String {
    let (set_up, linear, contact) = (number(&case["set_up"]), number(&case["linear"]), number(&case["contact"]));
    let wall = |times: &Value| number(&times["set_up"]) + number(&times["contact"]);
    let threads = case.get("two_threads").map_or("".into(), |two| format!("{:.2}", wall(two) / wall(&case["wall"])));
    let direct = case.get("direct").map_or("| |".into(), |direct| {
        let same = if case["same_set"] == true { "the same" } else { "ANOTHER" };
        format!("{:.2} | {:.2} | {same}", number(&direct["contact"]), gigabytes(&direct["peak_bytes"]))
    });
    format!(
        "{} | {:.1} | {} | {} | {:.2} | {set_up:.2} | {linear:.2} | {contact:.2} | {:.2} | {} | {:.1e} | {:.2} | {threads} | {direct}",
        case["dofs"],
        number(&case["radius"]),
        case["linear_cycles"],
        case["contact_cycles"],
        number(&case["contact_cycles"]) / number(&case["linear_cycles"]),
        (set_up + contact) / (set_up + linear),
        case["closed"],
        number(&case["certificate"]),
        gigabytes(&case["peak_bytes"]),
    )
}

/// The columns of a table of bodies.
pub const OF_BODY: &str = "body | dofs | linear, cycles | contact, cycles | ratio | set-up, s | linear, s | contact, s \
                           | closed | certificate | peak, GB";

/// Returns the cells of one body.
pub fn of_body(name: &str, case: &Value) -> String {
    format!(
        "{name} | {} | {} | {} | {} | {:.2} | {} | {:.2} | {} | {:.1e} | {:.2}",
        case["dofs"],
        known(&case["linear_cycles"], |cycles| format!("{cycles}")),
        case["contact_cycles"],
        known(&case["linear_cycles"], |cycles| format!("{:.2}", number(&case["contact_cycles"]) / cycles)),
        number(&case["set_up"]),
        known(&case["linear_cycles"], |_| format!("{:.2}", number(&case["linear"]))),
        number(&case["contact"]),
        case["closed"],
        number(&case["certificate"]),
        gigabytes(&case["peak_bytes"]),
    )
}

/// Returns the table of all cases, with the growth of the time from the second last case to the last.
pub fn of_cases(cases: &[Value]) -> String {
    let columns = "dofs | R | linear, cycles | contact, cycles | ratio | set-up, s | linear, s | contact, s | ratio with \
                   set-up | closed | certificate | peak, GB | two threads | direct, s | direct, GB | contact set";
    let text = table(columns, &cases.iter().map(cells).collect::<Vec<_>>());
    let plain: Vec<&Value> = cases.iter().filter(|case| case["radius"] == 2.0).collect();
    let [.., before, last] = plain[..] else { return text };
    let seconds = |case: &Value| number(&case["set_up"]) + number(&case["contact"]);
    let growth = (seconds(last) / seconds(before)).ln() / (number(&last["dofs"]) / number(&before["dofs"])).ln();
    format!("{text}\nFrom {} to {} dofs the seconds grow as N^{growth:.2}.\n", before["dofs"], last["dofs"])
}

/// Draws seconds and memory over the number of unknowns.
pub fn plot(cases: &[Value]) -> Drawing {
    let plain: Vec<&Value> = cases.iter().filter(|case| case["radius"] == 2.0).collect();
    let series = |name: &str, value: &dyn Fn(&Value) -> f64| {
        Series::new(name, plain.iter().map(|case| [number(&case["dofs"]), value(case)]).collect())
    };
    let seconds = vec![
        series("direct, contact", &|case| number(&case["direct"]["contact"])),
        series("multigrid, contact", &|case| number(&case["set_up"]) + number(&case["contact"])),
        series("multigrid, linear solve", &|case| number(&case["set_up"]) + number(&case["linear"])),
    ];
    let memory = vec![
        series("direct", &|case| gigabytes(&case["direct"]["peak_bytes"])),
        series("multigrid", &|case| gigabytes(&case["peak_bytes"])),
    ];
    let panel = |title: &str, unit: &str, series| {
        let plot = Plot::new(Quantity::new("unknowns", ""), Quantity::new(title, unit), series);
        Plot { title: title.into(), scales: [Scale::Logarithmic; 2], ..plot }
    };
    line_plots("Blocks in space under a sphere", &[panel("time", "s", seconds), panel("peak memory", "GB", memory)])
}
