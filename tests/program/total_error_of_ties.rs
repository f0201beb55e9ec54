//! The total error of tied bodies, and of obstacles that reach over a part of an edge only.

use crate::total_error::solved;
use serde_json::{Value, json};

fn line(from: f64, to: f64, divisions: usize) -> Value {
    json!({"points": [from, to], "divisions": [divisions]})
}

/// A block of two layers under a round obstacle: two tied bodies whose meshes do not match in the plane, or one body of
/// two materials.
fn layers(model: &str, is_tied: bool) -> Value {
    let is_in_space = model == "space";
    let (stiff, soft) = (json!({"young": 5e9, "poisson": 0.2}), json!({"young": 1e9, "poisson": 0.3}));
    let body = |from: f64, to: f64, divisions: [usize; 2]| match is_in_space {
        true => json!({"box": {"x": line(0.0, 1.0, 2), "y": line(0.0, 1.0, 2), "z": line(from, to, divisions[1])}}),
        false => json!({"rectangle": {"x": line(0.0, 1.0, divisions[0]), "y": line(from, to, divisions[1])}}),
    };
    let (up, apex) = if is_in_space { ("z", json!([0.3, 0.6, 0.95])) } else { ("y", json!([0.3, 0.95])) };
    let mut support = json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0});
    support[up] = json!(0);
    let shape = if is_in_space { "sphere" } else { "circle" };
    let mut scene = json!({
        "model": model,
        "supports": [support],
        "obstacles": [{"boundary": "top", "approach": format!("+{up}"), "shape": {shape: {"apex": apex, "radius": 1}}}],
    });
    if is_tied {
        (scene["body"], scene["material"]) = (body(0.0, 0.5, [5, 2]), soft);
        scene["further-bodies"] = json!([{"name": "cap", "body": body(0.5, 1.0, [4, 2]), "material": stiff}]);
        scene["ties"] = json!([{"surfaces": {"boundary": "cap.bottom", "to": "top"}}]);
        scene["obstacles"][0]["boundary"] = json!("cap.top");
    } else {
        (scene["body"], scene["material"]) = (body(0.0, 1.0, [4, 4]), soft);
        let above = if is_in_space { json!([0, 0, 0.5]) } else { json!([0, 0.5]) };
        let to = if is_in_space { json!([1, 1, 1]) } else { json!([1, 1]) };
        scene["materials"] = json!([{"box": {"min": above, "max": to}, "material": stiff}]);
    }
    scene
}

/// Tied bodies are one body of two materials: both descriptions enclose the same energy and the same force.
#[test]
fn tied_bodies_have_the_energy_and_the_force_of_one_body() {
    for (model, error) in [("plane-strain", "0.05"), ("axisymmetric", "0.1"), ("space", "0.4")] {
        let [tied, one] = [true, false].map(|is_tied| {
            let (code, report, message) = solved(&layers(model, is_tied), &["--total-error", error]);
            assert!(
                code == 0 && report["total_error"]["guaranteed"] == true,
                "{model}: {message} {}",
                report["reason"]
            );
            report
        });
        for key in ["potential_energy", "force_interval"] {
            let [[low, high], [from, to]] =
                [&tied, &one].map(|report| [0, 1].map(|end| report[key][end].as_f64().unwrap()));
            assert!(
                low < high && from < to && low.max(from) <= high.min(to),
                "{model} {key}: {low} {high} {from} {to}"
            );
        }
    }
}

/// Where surfaces do not lie on each other, or something acts on them, the reason says so.
#[test]
fn ties_without_a_guarantee_are_estimated_with_the_reason() {
    let mut apart = layers("plane-strain", true);
    apart["further-bodies"][0]["body"]["rectangle"]["y"]["points"] = json!([0.51, 1.0]);
    let mut loaded = layers("plane-strain", true);
    loaded["loads"] = json!([{"traction": {"boundary": "top", "value": [1e6, 0]}}]);
    let mut unmatched = layers("space", true);
    unmatched["body"]["box"]["x"]["divisions"] = json!([3]);
    let mut equation = layers("plane-strain", true);
    let terms = json!([{"on": {"point": [1, 0.25]}, "x": 1}, {"on": {"point": [0, 0.25]}, "x": -1}]);
    equation["ties"] = json!([equation["ties"][0], {"equation": {"terms": terms}}]);
    let mut repeated = layers("plane-strain", true);
    repeated["ties"] = json!([repeated["ties"][0], repeated["ties"][0]]);
    let cases = [
        (repeated, "ties[1]: surfaces that do not lie on each other"),
        (apart, "surfaces that do not lie on each other"),
        (loaded, "on a tied surface"),
        (unmatched, "are not the same"),
        (equation, "equations of nodes"),
    ];
    for (scene, reason) in cases {
        let (code, report, message) = solved(&scene, &["--total-error", "0.9"]);
        assert!(code == 0 && report["total_error"]["guaranteed"] == false, "{reason}: {message}");
        assert!(report["reason"].as_str().unwrap().contains(reason), "{}", report["reason"]);
    }
}

/// A circle narrower than an edge of the first mesh is reached by facets of a finer one; its force is the contact
/// force.
#[test]
fn a_pressed_circle_narrower_than_an_edge_has_a_guarantee() {
    let scene = json!({
        "body": {"rectangle": {"x": line(0.0, 1.0, 3), "y": line(0.0, 0.5, 2)}},
        "material": {"young": 1e9, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "force": 1e5, "shape": {"circle": {"apex": [0.4, 0.5], "radius": 0.1}}}],
    });
    let (code, report, message) = solved(&scene, &["--total-error", "0.3"]);
    assert!(code == 0 && report["total_error"]["guaranteed"] == true, "{message} {}", report["reason"]);
    assert_eq!(report["force_interval"], json!([1e5, 1e5]));
}
