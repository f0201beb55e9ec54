//! GOAL: every derivative of an output of a scene with respect to its numbers is that of the answer.
//!
//! REFERENCE: differences of whole answers inside one proven contact set, and the slope of the exact path. A short form
//! of `cargo run --release --example studies -- derivatives scenes 200`.

use serde_json::{Value, json};
use signorini::qp::Derivative;
use signorini::{Scene, Settings};
use support::program::example;
use support::slopes::{off_path, wrong_slopes};
use support::{axis_scenes, key_scenes, plane_scenes, space_scenes};

#[test]
fn examples_have_the_derivatives_that_differences_show() {
    let mut compared = 0;
    for name in ["indentation", "bar", "circle", "inclined"] {
        let found = wrong_slopes(&Scene::read(example(name)).unwrap());
        assert!(found.wrong.is_empty(), "{name}: {:#?}", found.wrong);
        compared += found.all.iter().filter(|slope| slope.difference.is_some() && slope.found.is_finite()).count();
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn random_scenes_have_the_derivatives_that_differences_show() {
    let kinds = [plane_scenes::scene, axis_scenes::scene, space_scenes::scene, key_scenes::scene];
    for (kind, scene) in kinds.into_iter().enumerate() {
        for seed in [2, 3] {
            let found = wrong_slopes(&scene(seed).0);
            assert!(found.wrong.is_empty(), "kind {kind}, seed {seed}: {:#?}", found.wrong);
        }
    }
}

/// With closest points the area of a row turns with its normal. REFERENCE: central differences of whole answers with
/// steps of 1e-5 and 1e-6, which agree to eight digits.
#[test]
fn the_width_of_a_contact_has_the_derivatives_that_differences_show() {
    let scene = json!({
        "model": "plane-stress", "material": {"young": 1e6, "poisson": 0.34},
        "body": {"rectangle": {"x": {"points": [0, 0.7, 1.4], "divisions": [6, 6]}, "y": {"points": [0, 1.14], "divisions": [3]}}},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point", "gap": -0.011,
                       "shape": {"circle": {"apex": [0.67, 1.14], "radius": 4.6}}}]
    });
    let scene = Scene::from_json(&scene.to_string(), "width").unwrap();
    let parameters = ["obstacles[0].apex[0]", "obstacles[0].radius", "gap"];
    let found = scene.sensitivity(&["width"], &parameters, &Settings::default()).unwrap();
    for (by, exact) in found.outputs[0].by.iter().zip([1.6103977, 3.635821e-2, -15.2942464]) {
        assert!(matches!(by.derivative, Derivative::Proven(value) if (value / exact - 1.0).abs() < 1e-6), "{by:?}");
    }
}

/// GOAL: outputs of one obstacle are those of its rows.
/// CONDITIONS: a block between a sharp and a blunt circle at different depths.
/// REFERENCE: differences; the width of all is the sum, the peak of all is the larger one, the note names the sum.
#[test]
fn outputs_of_one_obstacle_have_its_own_derivatives() {
    let circle = |boundary: &str, approach: &str, y: f64, radius: f64| {
        let shape = json!({"circle": {"apex": [0.7, y], "radius": radius}});
        json!({"boundary": boundary, "approach": approach, "gap": -0.004 * radius, "shape": shape})
    };
    let scene = json!({
        "model": "plane-stress", "material": {"young": 1e6, "poisson": 0.34},
        "body": {"rectangle": {"x": {"points": [0, 1.4], "divisions": [12]}, "y": {"points": [0, 1.1], "divisions": [6]}}},
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}, {"on": {"boundary": "right"}, "x": 0, "y": 0}],
        "obstacles": [circle("top", "+y", 1.1, 1.0), circle("bottom", "-y", 0.0, 4.0)]
    });
    let scene = Scene::from_json(&scene.to_string(), "press").unwrap();
    let found = wrong_slopes(&scene);
    assert!(found.wrong.is_empty(), "{:#?}", found.wrong);
    let names = ["width", "peak-pressure", "force"];
    let all = names.iter().flat_map(|name| ["", "obstacles[0].", "obstacles[1]."].map(|of| format!("{of}{name}")));
    let all: Vec<String> = all.collect();
    let outputs: Vec<&str> = all.iter().map(String::as_str).collect();
    let found = scene.sensitivity(&outputs, &["young"], &Settings::default()).unwrap().outputs;
    let value = |place: usize| found[place].value;
    assert!((value(0) - value(1) - value(2)).abs() < 1e-12 && value(1) > 0.0 && value(2) > 0.0, "{found:?}");
    assert!(value(3) == value(4).max(value(5)) && value(4) != value(5), "{found:?}");
    let noted: Vec<bool> =
        found.iter().map(|output| output.notes.iter().any(|note| note.contains("sum over"))).collect();
    assert_eq!(noted, [true, false, false, false, false, false, true, false, false]);
}

#[test]
fn derivatives_with_respect_to_the_gap_are_the_slopes_of_the_exact_path() {
    let scenes = (1..=12).map(|seed| plane_scenes::scene(seed).0);
    let off: Vec<f64> = scenes.filter_map(|scene| off_path(&scene)).collect();
    assert!(off.len() >= 3 && off.iter().all(|&off| off <= 1e-10), "{off:?}");
}

/// A stretch of a body moves all nodes: the derivative along it is that with respect to a coordinate of the body.
#[test]
fn derivatives_with_respect_to_the_places_of_nodes_are_those_of_a_stretched_body() {
    let plane = json!({
        "model": "plane-strain", "gap": -0.01,
        "body": {"rectangle": {"x": {"points": [0, 1.1], "divisions": [12]}, "y": {"points": [0, 0.6], "divisions": [6]}, "element": "q8"}},
        "material": {"young": 1e3, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "springs": [{"on": {"boundary": "left"}, "x": 50, "normal": 20}],
        "loads": [{"pressure": {"boundary": "right", "value": 5}}, {"body-force": [1, -3]}],
        "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point", "shape": {"circle": {"apex": [0.52, 0.6], "radius": 2}}}]
    });
    let mut axis = plane.clone();
    axis["model"] = json!("axisymmetric");
    axis["body"]["rectangle"]["element"] = json!("t6");
    axis["obstacles"][0] =
        json!({"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0, 0.6], "radius": 2}}});
    axis["springs"] = json!([]);
    let mut pressed = plane.clone();
    pressed["body"]["rectangle"]["element"] = json!("q4");
    pressed["gap"] = json!(0);
    pressed["obstacles"][0] = json!({"boundary": "top", "approach": "+y", "force": 12, "shape": {"parabola": {"apex": [0.52, 0.6], "radius": 2}}});
    let space = json!({
        "model": "space", "gap": -0.02,
        "body": {"box": {"x": {"points": [0, 1.1], "divisions": [5]}, "y": {"points": [0, 0.9], "divisions": [5]},
                         "z": {"points": [0, 0.5], "divisions": [3]}, "element": "hex8"}},
        "material": {"young": 1e3, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "loads": [{"traction": {"boundary": "right", "value": [1, 2, -3]}}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "closest-point", "shape": {"sphere": {"apex": [0.53, 0.41, 0.5], "radius": 2}}}]
    });
    let outputs = ["force", "peak-pressure", "largest-displacement", "strain-energy"];
    for (name, scene, shape) in [
        ("plane", plane, "rectangle"),
        ("axis", axis, "rectangle"),
        ("pressed", pressed, "rectangle"),
        ("space", space, "box"),
    ] {
        let read = |scene: &Value| Scene::from_json(&scene.to_string(), name).unwrap();
        let own = read(&scene);
        let found = own.sensitivity(&outputs, &["nodes"], &Settings::default()).unwrap();
        let nodes = found.answer.model().mesh().nodes().to_vec();
        let dimension = found.answer.model().mesh().dimension();
        for along in 0..2 {
            let key = ["x", "y"][along];
            let length = scene["body"][shape][key]["points"][1].as_f64().unwrap();
            let at = |by: f64| -> Vec<f64> {
                let mut stretched = scene.clone();
                stretched["body"][shape][key]["points"][1] = json!(length + by);
                let found = read(&stretched).sensitivity(&outputs, &[], &Settings::default()).unwrap();
                found.outputs.iter().map(|output| output.value).collect()
            };
            let step = 1e-5 * length;
            let (a, b, c, d) = (at(-2.0 * step), at(-step), at(step), at(2.0 * step));
            for (index, output) in found.outputs.iter().enumerate() {
                let places = output.by[0].places.as_ref().unwrap();
                let gradient = places.proven().unwrap_or_else(|| panic!("{name}, {}: {places:?}", output.output));
                let moved: f64 = nodes
                    .iter()
                    .enumerate()
                    .map(|(node, at)| gradient[dimension * node + along] * at[along] / length)
                    .sum();
                let difference = (8.0 * (c[index] - b[index]) - (d[index] - a[index])) / (12.0 * step);
                let size = difference.abs().max(1e-3 * output.value.abs() / length);
                assert!(
                    (moved - difference).abs() <= 1e-6 * size,
                    "{name}, {} along {key}: {moved} and {difference}",
                    output.output
                );
            }
        }
    }
}
