//! The documented form of JSON reports.

use serde_json::Value;
use signorini::qp::read_vector;
use support::program::Desk;

/// Asserts that `value` is an object with these fields, each of its kind: `number`, `count`, `string` or `bool`.
#[track_caller]
pub fn has(value: &Value, fields: &[(&str, &str)]) {
    for &(name, kind) in fields {
        let field = &value[name];
        let fits = match kind {
            "number" => field.is_f64(),
            "count" => field.is_u64(),
            "string" => field.is_string(),
            "bool" => field.is_boolean(),
            other => panic!("{other} is not a kind"),
        };
        assert!(fits, "{name} is {field}, not a {kind}, in {value:#}");
    }
}

pub const CERTIFICATE: [(&str, &str); 5] = [
    ("stationarity", "number"),
    ("penetration", "number"),
    ("adhesion", "number"),
    ("complementarity", "number"),
    ("duality_gap", "number"),
];

/// Asserts the documented form of one answer.
#[track_caller]
pub fn is_answer(answer: &Value, of_scene: bool) {
    has(answer, &[("status", "string"), ("method", "string"), ("iterations", "count"), ("tolerance", "number")]);
    assert!(answer["status"] == "certified" || answer["status"] == "not_certified", "{}", answer["status"]);
    has(&answer["contact"], &[("count", "count"), ("force", "number")]);
    assert_eq!(answer["contact"]["pressure_max"].is_f64(), of_scene, "{answer:#}");
    has(&answer["certificate"], &CERTIFICATE);
    let bound =
        answer["certificate"].get("energy_error_bound").expect("the field is a bound, or null if no bound is known");
    assert!(bound.is_f64() || bound.is_null(), "{bound}");
    has(&answer["model"], &[("dofs", "count"), ("contact_rows", "count"), ("condensed_dofs", "count")]);
    has(
        &answer["seconds"],
        &[("assemble", "number"), ("factor", "number"), ("solve", "number"), ("proof", "number"), ("total", "number")],
    );
}

pub fn vectors(desk: &Desk, folder: &str) -> (Vec<f64>, Vec<f64>) {
    let read = |name: &str| read_vector(&desk.path(&format!("{folder}/{name}.mtx"))).unwrap();
    (read("u"), read("lambda"))
}
