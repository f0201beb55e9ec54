//! The measurements as tables: seconds and memory of every task, and the ratios of tasks with their limits.

use serde_json::Value;

/// A ratio of two tasks of a case: name, case, first task, second task, required value, desired value.
const RATIOS: [(&str, &str, &str, &str, f64, f64); 11] = [
    ("contact / linear solve", "Q4 256", "active set", "linear solve", 1.15, 1.0),
    ("contact / linear solve", "Q4 512", "active set", "linear solve", 1.0, 0.8),
    ("contact / linear solve", "Hex8 28", "active set", "linear solve", 0.45, 0.35),
    ("contact / linear solve, dissected", "Hex8 28", "active set", "linear solve, dissected", 1.35, 1.15),
    ("contact, condensed certificate / linear solve", "Q4 256", "active set, uncertified", "linear solve", 1.15, 1.0),
    ("next gap, forces / first gap", "Q4 256", "next gap, forces", "active set", 0.02, 0.005),
    ("next gap, displacement / first gap", "Q4 256", "next gap, displacement", "active set", 0.15, 0.1),
    ("QP / QP, full", "Q4 256", "QP", "QP, full", 1.0 / 15.0, 1.0 / 30.0),
    ("sweep of ten gaps / contact", "Q4 256", "sweep of ten gaps", "active set", 1.1, 1.02),
    ("two threads / one", "Q4 512", "active set, two threads", "active set, wall clock", 1.0, 0.5),
    ("two threads / one", "Hex8 28", "active set, two threads", "active set, wall clock", 1.0, 0.5),
];

/// Ratio of the peak memory of a contact solve to the bytes of its factor: case, required value, desired value.
const MEMORY: (&str, f64, f64) = ("Q4 512", 2.0, 1.3);

const MEGABYTE: f64 = 1e6;

pub fn text(cases: &[Value], rounds: &str) -> String {
    let mut text = format!(
        "Smallest processor seconds of {rounds} rounds, in which the tasks alternate; `full` tasks run once.\n\n"
    );
    text += "| case | dofs | rows | task | seconds | over linear solve | peak MB |\n|---|---|---|---|---|---|---|\n";
    for case in cases {
        let linear = seconds(case, "linear solve");
        for (task, entry) in case["tasks"].as_object().into_iter().flatten() {
            let spent = seconds(case, task);
            let over = spent.zip(linear).map_or("-".into(), |(spent, linear)| format!("{:.3}", spent / linear));
            let peak = entry["peak_bytes"].as_f64().map_or("not measured".into(), |b| format!("{:.0}", b / MEGABYTE));
            let spent = spent.map_or("-".into(), |spent| format!("{spent:.5}"));
            text += &format!(
                "| {} | {} | {} | {task} | {spent} | {over} | {peak} |\n",
                case["case"].as_str().unwrap_or_default(),
                case["dofs"],
                case["rows"]
            );
        }
    }
    text += "\n| ratio | case | measured | required | desired |\n|---|---|---|---|---|\n";
    let mut line = |what: &str, case: &Value, measured: Option<f64>, must: f64, strive: f64| {
        let measured = measured.map_or("not run".into(), |value| format!("{value:.4}"));
        let name = case["case"].as_str().unwrap_or_default();
        text += &format!("| {what} | {name}, {} dofs | {measured} | {must:.3} | {strive:.3} |\n", case["dofs"]);
    };
    for (what, name, task, over, must, strive) in RATIOS {
        if let Some(case) = cases.iter().find(|case| case["case"] == name) {
            let measured = seconds(case, task).zip(seconds(case, over)).map(|(a, b)| a / b);
            line(what, case, measured, must, strive);
        }
    }
    let (name, must, strive) = MEMORY;
    if let Some(case) = cases.iter().find(|case| case["case"] == name) {
        let factor = case["factor_bytes"].as_f64();
        let peak = |task: &str| case["tasks"][task]["peak_bytes"].as_f64();
        let over = |task: &str, factor: Option<f64>| peak(task).zip(factor).map(|(peak, factor)| peak / factor);
        line("peak memory of contact / its factor", case, over("active set", factor), must, strive);
        let linear = over("linear solve", case["linear_factor_bytes"].as_f64());
        line("peak memory of linear solve / its factor", case, linear, must, strive);
    }
    text
}

fn seconds(case: &Value, task: &str) -> Option<f64> {
    case["tasks"][task]["seconds"].as_f64()
}
