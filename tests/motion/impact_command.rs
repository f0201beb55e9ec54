//! `signorini solve` of scenes with a motion: its output and files, its refusals, and how it resumes after a stop.

use std::fs;

use serde_json::{Value, json};
use support::program::{Desk, scene};

/// Largest difference of memory between runs of which one has ten times as many steps: less than the 2 MB of 36,000
/// more observations of seven numbers.
#[cfg(target_os = "linux")]
const GROWTH: f64 = 1e6;

/// A bar of 20 cells against a wall, with 120 steps.
pub fn bar() -> Value {
    json!({
        "title": "Bar",
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "loads": [{"body-force": [0]}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": 2, "initial": [{"velocity": {"value": [10]}}], "frames": 12}}
    })
}

/// The bar with one value of its dynamic analysis changed.
pub fn with(key: &str, value: Value) -> Value {
    let mut scene = bar();
    scene["analysis"]["dynamic"][key] = value;
    scene
}

#[test]
fn a_motion_prints_a_report_and_writes_history_series_and_plots() {
    let desk = Desk::new();
    desk.write("bar.json", bar().to_string());
    let run = desk.run(&["solve", "bar.json", "--out", "out", "--format", "json"]).ends_with(0);
    assert_eq!(run.stderr, "", "there is a progress bar although standard error is no terminal");
    let report = run.json();
    assert_eq!((report["status"].as_str(), report["scheme"].as_str()), (Some("certified"), Some("fox-goodwin")));
    // The impulse is 2 L rho v0.
    assert!((report["contact"]["impulse"].as_f64().unwrap() / 200.0 - 1.0).abs() < 0.02, "{report}");
    assert!(report["energy"]["change"].as_f64().unwrap().abs() < 5e-3, "{report}");
    let history = fs::read_to_string(desk.path("out/history.csv")).unwrap();
    assert_eq!(history.lines().count(), 2 + report["steps"].as_u64().unwrap() as usize);
    assert!(history.lines().all(|line| line.split(',').count() == 9));
    let series = fs::read_to_string(desk.path("out/series.pvd")).unwrap();
    for number in 0..=12 {
        let name = format!("series-{number:05}.vtu");
        assert!(series.contains(&name) && desk.path(&format!("out/{name}")).exists(), "{name}");
    }
    assert!(desk.path("out/history.png").exists() && desk.path("out/report.json").exists());
    // A bar has no picture in the plane.
    assert!(!desk.path("out/motion.png").exists());
    let text = desk.run(&["solve", "bar.json"]).ends_with(0).stdout;
    assert!(text.contains("fox-goodwin, 120 steps") && text.contains("peak force"), "{text}");
}

#[test]
fn a_motion_in_the_plane_writes_an_animation_of_all_its_frames() {
    let mut block = scene();
    block["material"]["density"] = json!(1000);
    block["body"]["rectangle"]["y"]["divisions"] = json!([4]);
    block["analysis"] = json!({"dynamic": {"duration": 0.01, "frames": 3}});
    block["gap"] = json!(0.0001);
    let desk = Desk::new();
    desk.write("block.json", block.to_string());
    desk.run(&["solve", "block.json", "--out", "out"]).ends_with(0);
    let bytes = fs::read(desk.path("out/motion.png")).unwrap();
    let info = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap().info().clone();
    assert_eq!(info.animation_control.unwrap().num_frames, 4);
    assert!(info.width > 300 && info.height > 150);
}

#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_number_of_steps() {
    let desk = Desk::new();
    let peak = |step: f64| {
        let mut scene = with("step", json!(step));
        scene["analysis"]["dynamic"]["frames"] = json!(2);
        scene["analysis"]["dynamic"]["scheme"] = json!("midpoint");
        // The plots show the same number of points of both histories.
        scene["analysis"]["dynamic"]["duration"] = json!(1.995);
        desk.write("bar.json", scene.to_string());
        let peak = desk.peak(&["solve", "bar.json", "--out", "out"]);
        (peak, fs::read_to_string(desk.path("out/history.csv")).unwrap().lines().count())
    };
    let ((few, lines), (many, more_lines)) = (peak(5e-4), peak(5e-5));
    assert_eq!((lines, more_lines), (3992, 39_902));
    assert!(many - few < GROWTH, "{few} bytes in 3,990 steps, {many} in 39,900");
}

#[test]
fn a_killed_run_is_resumed_bit_for_bit() {
    let desk = Desk::new();
    desk.write("bar.json", with("frames", json!(60)).to_string());
    desk.run(&["solve", "bar.json", "--out", "whole", "--pictures", "none"]).ends_with(0);
    let mut child = desk.command(&["solve", "bar.json", "--out", "stopped", "--pictures", "none"]).spawn().unwrap();
    while !desk.path("stopped/series-00010.vtu").exists() {
        assert!(child.try_wait().unwrap().is_none(), "the run ended before its tenth frame");
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // The files are complete: every file in the list exists.
    let series = fs::read_to_string(desk.path("stopped/series.pvd")).unwrap();
    assert!(series.ends_with("</VTKFile>\n"));
    let names = series.split('"').filter(|name| name.ends_with(".vtu"));
    assert!(names.map(|name| desk.path(&format!("stopped/{name}"))).all(|path| path.exists()));
    desk.run(&["solve", "bar.json", "--out", "stopped", "--resume", "--pictures", "none"]).ends_with(0);
    for name in ["history.csv", "checkpoint.json", "series.pvd", "series-00059.vtu", "frames/00060.json"] {
        let [whole, stopped] = ["whole", "stopped"].map(|run| fs::read(desk.path(&format!("{run}/{name}"))).unwrap());
        assert!(whole == stopped, "{name} differs");
    }
}

#[test]
fn only_a_run_of_the_same_scene_is_resumed() {
    let desk = Desk::new();
    desk.write("bar.json", bar().to_string());
    desk.write("other.json", with("step", json!(0.01)).to_string());
    desk.run(&["solve", "bar.json", "--out", "out", "--resume"]).fails_with(1, &["cannot resume", "checkpoint.json"]);
    desk.run(&["solve", "bar.json", "--out", "out", "--pictures", "none"]).ends_with(0);
    desk.run(&["solve", "other.json", "--out", "out", "--resume"]).fails_with(1, &["belongs to another scene"]);
    desk.write("still.json", scene().to_string());
    desk.run(&["solve", "still.json", "--out", "out", "--resume"]).fails_with(1, &["no motion to resume"]);
    desk.run(&["solve", "bar.json", "--resume"]).ends_with(2);
}

/// Options that a motion, modes or an equilibrium would pass over are refused by name.
#[test]
fn options_without_effect_are_refused() {
    let desk = Desk::new();
    desk.write("bar.json", bar().to_string());
    let mut modes = scene();
    modes["analysis"] = json!({"modes": {"count": 2}});
    desk.write("modes.json", modes.to_string());
    for option in [
        &["--total-error", "0.1"][..],
        &["--accuracy", "1e-3"],
        &["--precision", "double"],
        &["--no-proof"],
        &["--explain"],
        &["--plan"],
        &["--start", "earlier"],
    ] {
        for (file, what) in [("bar.json", "motion"), ("modes.json", "modes")] {
            desk.run(&[&["solve", file], option].concat()).fails_with(1, &[option[0], what, "no effect"]);
        }
    }
    for option in [&["--refine-in-time"][..], &["--resume", "--out", "o"]] {
        desk.run(&[&["solve", "modes.json"], option].concat()).fails_with(1, &[option[0], "no motion to"]);
    }
}

#[test]
fn invalid_values_of_a_motion_are_refused_in_one_sentence_without_files() {
    let table = |times: Value, factors: Value| {
        with("loads-in-time", json!([{"load": 0, "factor": {"table": {"times": times, "factors": factors}}}]))
    };
    let of_explicit = |key: &str, value: Value| {
        let mut scene = with("scheme", json!("central-difference"));
        scene["analysis"]["dynamic"][key] = value;
        scene
    };
    let (too_fast, consistent) = (of_explicit("courant", json!(1.5)), of_explicit("mass", json!("consistent")));
    let ramp = json!({"load": 0, "factor": {"ramp": {"end": 1}}});
    let twice = with("loads-in-time", json!([ramp, {"load": 0, "factor": {"pulse": {"end": 1}}}]));
    let mut both = with("courant", json!(0.5));
    both["analysis"]["dynamic"]["step"] = json!(0.1);
    let mut weightless = bar();
    weightless["material"].as_object_mut().unwrap().remove("density");
    let mut heavy = bar();
    heavy["material"]["density"] = json!(-1);
    let mut inside = bar();
    inside["obstacles"][0]["shape"]["plane"]["point"] = json!([9.75]);
    let cases: Vec<(Value, &[&str])> = vec![
        (with("step", json!(0)), &["at `analysis.dynamic.step`", "0 is not allowed", "positive"]),
        (with("step", json!(-0.1)), &["at `analysis.dynamic.step`", "-0.1", "positive"]),
        (with("step", json!(null)), &["analysis.dynamic.step", "null", "must be a number"]),
        (with("step", json!(3)), &["at `analysis.dynamic.step`", "longer than the duration 2"]),
        (
            of_explicit("step", json!(0.02)),
            &["at `analysis.dynamic.step`", "0.02 is beyond 0.0165", "0.99 times 0.01666666", "largest stable step"],
        ),
        (with("step", json!(1e-300)), &["at `analysis.dynamic.step`", "2.00e300 steps of 1e-300 are too many"]),
        (with("alpha", json!(-0.1)), &["at `analysis.dynamic.alpha`", "only the scheme `hht`", "`fox-goodwin`"]),
        (with("restitution", json!(0)), &["at `analysis.dynamic.restitution`", "only the scheme `central-difference`"]),
        (with("initial", json!([{"velocity": {"value": [1e308]}}])), &["at `analysis.dynamic.initial`", "too large"]),
        (with("duration", json!(0)), &["at `analysis.dynamic.duration`", "positive"]),
        (with("duration", json!(1e12)), &["at `analysis.dynamic.step`", "are too many"]),
        (with("courant", json!(-1)), &["at `analysis.dynamic.courant`", "-1", "positive"]),
        (with("scheme", json!("verlet")), &["analysis.dynamic.scheme", "verlet", "midpoint"]),
        (with("mass", json!("heavy")), &["analysis.dynamic.mass", "heavy", "redistributed"]),
        (with("frames", json!(0)), &["at `analysis.dynamic.frames`", "from 1 to 10000"]),
        (with("damping", json!({"mass": -1})), &["at `analysis.dynamic.damping.mass`", "-1", "zero or positive"]),
        (with("initial", json!([{"velocity": {"value": [1, 2]}}])), &["initial[0].velocity.value", "2 entries", "[x]"]),
        (with("initial", json!([{"body": "other"}])), &["initial[0].body", "no further body `other`"]),
        (table(json!([0, 2, 1]), json!([0, 1, 2])), &["table.times[2]", "1.0 does not lie beyond 2.0"]),
        (table(json!([0, 1]), json!([0])), &["factor.table", "2 times and 1 factors"]),
        (with("loads-in-time", json!([{"load": 3, "factor": {"ramp": {"end": 1}}}])), &["no loads[3]", "1 loads"]),
        (with("loads-in-time", json!([{"load": 0, "factor": {"ramp": {"end": 0}}}])), &["factor.ramp.end", "later"]),
        (twice, &["loads-in-time[1]", "loads[0] has two factors"]),
        (both, &["at `analysis.dynamic.courant`", "give `step` or `courant`, not both"]),
        (too_fast, &["at `analysis.dynamic.courant`", "1.5", "at most 0.99"]),
        (consistent, &["at `analysis.dynamic.mass`", "central differences need a lumped mass"]),
        (
            with("initial", json!([{"velocity": {"value": [1], "gradient": [[1], [2]]}}])),
            &["velocity.gradient", "2 rows"],
        ),
        (weightless, &["at `material`", "needs a `density`"]),
        (heavy, &["at `material.density`", "-1", "positive"]),
        (
            inside,
            &["at `analysis.dynamic.initial`", "node 20 at (10) starts 2.500e-1 inside obstacles[0]", "`project`"],
        ),
    ];
    let desk = Desk::new();
    for (scene, phrases) in cases {
        desk.write("scene.json", scene.to_string());
        desk.run(&["solve", "scene.json", "--out", "out"]).fails_with(1, phrases);
        assert!(!desk.path("out").exists(), "{scene}");
    }
    desk.write("scene.json", bar().to_string().replace("\"duration\":2", "\"duration\":2,\"step\":NaN"));
    desk.run(&["solve", "scene.json", "--out", "out"])
        .fails_with(1, &["scene.json:1:", "at `analysis.dynamic.step`", "expected a value of JSON"]);
    assert!(!desk.path("out").exists());
    let mut mass = with("scheme", json!("trapezoidal"));
    mass["analysis"]["dynamic"]["mass"] = json!("redistributed");
    desk.write("scene.json", mass.to_string());
    desk.run(&["solve", "scene.json"]).fails_with(1, &["at `analysis.dynamic.mass`", "only the scheme `midpoint`"]);
    for command in [&["compare", "scene.json"][..], &["sweep", "scene.json", "--gaps", "0:1:2"]] {
        desk.run(command).fails_with(1, &["at `analysis`", "the scene is a motion"]);
    }
}

#[test]
fn a_body_that_starts_inside_an_obstacle_is_projected_if_the_scene_demands_it() {
    let mut inside = with("initial-penetration", json!("project"));
    inside["obstacles"][0]["shape"]["plane"]["point"] = json!([9.75]);
    let desk = Desk::new();
    desk.write("scene.json", inside.to_string());
    let report = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(0).json();
    assert!(report["contact"]["penetration_max"].as_f64().unwrap() < 1e-12, "{report}");
}

#[test]
fn a_scheme_that_gains_energy_is_warned_about_before_and_after() {
    let desk = Desk::new();
    desk.write("scene.json", with("scheme", json!("trapezoidal")).to_string());
    let run = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(4);
    assert!(run.stderr.contains("warning: the scheme `trapezoidal` can gain energy"), "{}", run.stderr);
    assert!(run.stderr.contains("warning: the energy grew by"), "{}", run.stderr);
    assert_eq!(run.json()["gains_energy"], json!(true));
}

#[test]
fn a_motion_may_have_a_body_without_supports() {
    let mut free = scene();
    free["supports"] = json!([]);
    free["obstacles"] = json!([]);
    free["loads"] = json!([]);
    free["material"]["density"] = json!(1000);
    free["analysis"] = json!({"dynamic": {"duration": 1, "step": 0.05, "initial": [{"velocity": {"value": [3, 4]}}]}});
    let desk = Desk::new();
    desk.write("free.json", free.to_string());
    let report = desk.run(&["solve", "free.json", "--format", "json"]).ends_with(0).json();
    // The mass is 1000 * 0.5, the speed 5.
    for moment in ["first", "last"] {
        assert!((report["energy"][moment]["kinetic"].as_f64().unwrap() / 6250.0 - 1.0).abs() < 1e-9, "{report}");
    }
}

#[test]
fn a_trade_off_of_a_motion_runs_every_scheme_and_marks_the_best() {
    let desk = Desk::new();
    desk.write("bar.json", bar().to_string());
    let report = desk.run(&["tradeoff", "bar.json", "--out", "out", "--format", "json"]).ends_with(0).json();
    let points = report["points"].as_array().unwrap();
    let schemes: std::collections::BTreeSet<_> = points.iter().map(|point| point["scheme"].as_str().unwrap()).collect();
    assert_eq!(schemes.len(), 8);
    assert!(points.iter().any(|point| point["best"] == json!(true)));
    let errors: Vec<f64> = points[..4].iter().map(|point| point["displacement_error"].as_f64().unwrap()).collect();
    assert!(
        errors[3] < errors[0] && errors[3] > 0.0,
        "smaller steps do not reduce the error of the default scheme: {errors:?}"
    );
    for name in ["tradeoff.txt", "tradeoff.csv", "tradeoff.png"] {
        assert!(desk.path(&format!("out/{name}")).exists());
    }
}
