//! Derivatives on the command line: the table, the files, and names that do not exist.

use serde_json::{Value, json};
use support::program::{Desk, Run, scene};

/// Runs the command on a scene.
fn derivatives(desk: &Desk, scene: &Value, arguments: &[&str]) -> Run {
    desk.write("scene.json", scene.to_string());
    desk.run(&[&["sensitivity", "scene.json"], arguments].concat())
}

#[test]
fn derivatives_are_in_the_table_in_json_and_in_the_folder() {
    let desk = Desk::new();
    let arguments = ["--of", "force,peak-pressure", "--to", "gap,young,nodes", "--out", "out"];
    let mut unloaded = scene();
    unloaded["loads"] = json!([]);
    let printed = derivatives(&desk, &unloaded, &arguments).ends_with(0);
    let text = |name: &str| std::fs::read_to_string(desk.path(name)).unwrap();
    assert!(printed.stdout.contains("% for 1 %") && printed.stdout.contains("proven"), "{}", printed.stdout);
    let report: Value = serde_json::from_str(&text("out/report.json")).unwrap();
    let force = &report["sensitivities"][0];
    let value = |index: usize| force["by"][index]["derivative"]["value"].as_f64().unwrap();
    // All forces are proportional to the modulus.
    let young = force["by"][1]["value"].as_f64().unwrap();
    assert!((value(1) * young / force["value"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{force}");
    assert!(value(0) < 0.0 && force["by"][0]["derivative"]["verdict"] == "proven");
    // Moving the body and the obstacle together changes nothing: the places of all nodes along y undo the gap.
    let table = text("out/nodes-0.csv");
    let by_y: f64 = table.lines().skip(1).map(|line| line.split(',').nth(4).unwrap().parse::<f64>().unwrap()).sum();
    assert!((by_y + value(0)).abs() < 1e-6 * value(0).abs(), "{by_y} and {}", value(0));
    assert!(text("out/report.html").contains("sensitivities"));
}

#[test]
fn names_that_do_not_exist_and_inputs_without_derivatives_are_answered_in_one_sentence() {
    let desk = Desk::new();
    for (arguments, sentence) in [
        (vec!["--of", "forze"], "there is no output `forze`; there are `force`,"),
        (vec!["--of", "force", "--to", "yuong"], "did you mean `young`?"),
        (vec!["--of", "pressure@1"], "the place of `pressure@1` needs 2 numbers"),
        (vec!["--of", "stress@0.5,0.5:qq"], "with the components xx, yy, zz, xy, yz, zx, von-mises"),
    ] {
        derivatives(&desk, &scene(), &arguments).fails_with(1, &[sentence]);
    }
    let mut moving = scene();
    moving["material"]["density"] = json!(1);
    moving["analysis"] = json!({"dynamic": {"step": 0.1, "duration": 1}});
    derivatives(&desk, &moving, &["--of", "force"]).fails_with(1, &["only an equilibrium has derivatives here"]);
}

#[test]
fn a_scene_without_contact_has_plain_derivatives() {
    let desk = Desk::new();
    let mut free = scene();
    free["obstacles"] = json!([]);
    free["loads"] = json!([{"traction": {"boundary": "top", "value": [0, 1]}}]);
    let arguments = ["--of", "strain-energy", "--to", "loads[0],young", "--format", "json"];
    let report = derivatives(&desk, &free, &arguments).json();
    let relative = |index: usize| report["sensitivities"][0]["by"][index]["relative"]["value"].as_f64().unwrap();
    // The energy is proportional to the square of the load, over the modulus.
    assert!((relative(0) - 2.0).abs() < 1e-9 && (relative(1) + 1.0).abs() < 1e-9, "{report}");
}

/// A cap that only its tie holds, before a plane: the force is proportional to the depth.
#[test]
fn a_body_that_only_ties_hold_has_proven_derivatives() {
    let desk = Desk::new();
    let block = |from: f64, divisions: usize| {
        let axis = |from: f64| json!({"points": [from, from + 1.0], "divisions": [divisions]});
        json!({"rectangle": {"x": axis(0.0), "y": axis(from)}})
    };
    let material = json!({"young": 1e6, "poisson": 0.3});
    let tied = json!({
        "model": "plane-strain", "body": block(0.0, 4), "material": material, "gap": -0.01,
        "further-bodies": [{"name": "cap", "body": block(1.0, 3), "material": material}],
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "ties": [{"surfaces": {"boundary": "cap.bottom", "to": "top"}}],
        "obstacles": [{"boundary": "cap.top", "approach": "+y", "shape": {"plane": {"point": [0, 2], "normal": [0, 1]}}}]
    });
    let arguments = ["--of", "force", "--to", "gap", "--format", "json"];
    let report = derivatives(&desk, &tied, &arguments).ends_with(0).json();
    let by_gap = &report["sensitivities"][0]["by"][0];
    assert_eq!(by_gap["derivative"]["verdict"], "proven", "{by_gap}");
    assert!((by_gap["relative"]["value"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{by_gap}");
}
