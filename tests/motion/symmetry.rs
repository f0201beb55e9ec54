//! GOAL: the motion of a part with planes of symmetry has the forces and energies of the whole.
//!
//! REFERENCE: the whole, on the same mesh.

use serde_json::{Value, json};
use support::program::Desk;

/// Rounding over some hundred steps.
const ROUNDING: f64 = 1e-9;

/// A block [-1, 1] x [0, 1] that falls on a parabola, or its right half.
fn block(is_whole: bool) -> Value {
    let (left, cells) = if is_whole { (-1, 12) } else { (0, 6) };
    json!({
        "model": "plane-strain",
        "body": {"rectangle": {
            "x": {"points": [left, 1], "divisions": [cells]}, "y": {"points": [0, 1], "divisions": [6]}}},
        "material": {"young": 1000, "poisson": 0.3, "density": 1},
        "symmetry": if is_whole { json!([]) } else { json!(["x"]) },
        "loads": [{"gravity": [0, -5]}],
        "obstacles": [
            {"boundary": "bottom", "approach": "-y", "shape": {"parabola": {"apex": [0, -0.05], "radius": 3}}}],
        "analysis": {"dynamic": {"duration": 0.3, "initial": [{"velocity": {"value": [0, -3]}}]}}
    })
}

#[test]
fn a_half_moves_as_the_whole() {
    let desk = Desk::new();
    let solved = |is_whole: bool| {
        desk.write("scene.json", block(is_whole).to_string());
        let folder = if is_whole { "whole" } else { "half" };
        let report = desk
            .run(&["solve", "scene.json", "--out", folder, "--format", "json", "--pictures", "none"])
            .ends_with(0)
            .json();
        let history = std::fs::read_to_string(desk.path(&format!("{folder}/history.csv"))).unwrap();
        (report, history)
    };
    let ((whole, of_whole), (half, of_half)) = (solved(true), solved(false));
    assert_eq!((half["parts_of_whole"].as_u64(), whole.get("parts_of_whole")), (Some(2), None));
    let close = |a: &Value, b: &Value, what: &str| {
        let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
        assert!((a - b).abs() <= ROUNDING * b.abs(), "{what}: {a} of the half, {b} of the whole");
    };
    for key in ["impulse", "force_max", "duration"] {
        assert!(whole["contact"][key].as_f64() > Some(0.0));
        close(&half["contact"][key], &whole["contact"][key], key);
        close(&half["contact"]["obstacles"][0][key], &whole["contact"]["obstacles"][0][key], key);
    }
    close(&half["contact"]["peak_force"]["value"], &whole["contact"]["peak_force"]["value"], "peak");
    for energy in ["kinetic", "strain", "potential"] {
        close(&half["energy"]["last"][energy], &whole["energy"]["last"][energy], energy);
    }
    assert_eq!(of_half.lines().count(), of_whole.lines().count());
}

#[test]
fn a_part_that_starts_across_its_plane_is_refused() {
    let mut scene = block(false);
    scene["analysis"]["dynamic"]["initial"] = json!([{"velocity": {"value": [1, 0]}}]);
    let desk = Desk::new();
    desk.write("scene.json", scene.to_string());
    let phrases = ["at `analysis.dynamic.initial`", "at (0, 0) lies on a plane of symmetry", "along x"];
    desk.run(&["solve", "scene.json"]).fails_with(1, &phrases);
}
