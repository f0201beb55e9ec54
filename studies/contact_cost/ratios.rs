//! The measurements as tables: seconds and memory of every task, and the ratios of tasks with their limits.

use serde_json::Value;

use crate::table::table;

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

pub fn text(cases: &[Value], rounds: usize) -> String {
    let (mut rows, mut ratios) = (Vec::new(), Vec::new());
    for case in cases {
        let (linear, name) = (seconds(case, "linear solve"), case["case"].as_str().unwrap_or_default());
        for (task, entry) in case["tasks"].as_object().into_iter().flatten() {
            let spent = seconds(case, task);
            let over = spent.zip(linear).map_or("-".into(), |(spent, linear)| format!("{:.3}", spent / linear));
            let peak = entry["peak_bytes"].as_f64().map_or("not measured".into(), |b| format!("{:.0}", b / MEGABYTE));
            let spent = spent.map_or("-".into(), |spent| format!("{spent:.5}"));
            rows.push(format!("{name} | {} | {} | {task} | {spent} | {over} | {peak}", case["dofs"], case["rows"]));
        }
    }
    let mut add = |what: &str, name: &str, must: f64, strive: f64, measured: &dyn Fn(&Value) -> Option<f64>| {
        let Some(case) = cases.iter().find(|case| case["case"] == name) else { return };
        let measured = measured(case).map_or("not run".into(), |value| format!("{value:.4}"));
        ratios.push(format!("{what} | {name}, {} dofs | {measured} | {must:.3} | {strive:.3}", case["dofs"]));
    };
    for (what, name, task, over, must, strive) in RATIOS {
        add(what, name, must, strive, &|case| Some(seconds(case, task)? / seconds(case, over)?));
    }
    let (name, must, strive) = MEMORY;
    for (what, task, factor) in [
        ("peak memory of contact / its factor", "active set", "factor_bytes"),
        ("peak memory of linear solve / its factor", "linear solve", "linear_factor_bytes"),
    ] {
        let share = |case: &Value| Some(case["tasks"][task]["peak_bytes"].as_f64()? / case[factor].as_f64()?);
        add(what, name, must, strive, &share);
    }
    format!(
        "Smallest processor seconds of {rounds} rounds, in which the tasks alternate; `full` tasks run once.\n\n{}\n{}",
        table("case | dofs | rows | task | seconds | over linear solve | peak MB", &rows),
        table("ratio | case | measured | required | desired", &ratios)
    )
}

fn seconds(case: &Value, task: &str) -> Option<f64> {
    case["tasks"][task]["seconds"].as_f64()
}
