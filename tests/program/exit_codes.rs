//! The exit code of a command, and the message of a failure in text and JSON.

use crate::promised::is_answer;
use serde_json::{Value, json};
use support::program::{Desk, Problem, example, matrix, scene};

#[test]
fn exit_code_1_means_bad_input() {
    let desk = Desk::new();
    desk.write("bad.json", "{}");
    desk.run(&["solve", "nowhere.json"]).fails_with(1, &["cannot read nowhere.json"]);
    desk.run(&["solve", "bad.json"]).fails_with(1, &["bad.json:1:2", "the key `body` is missing"]);
    desk.run(&["compare", "bad.json"]).fails_with(1, &["the key `body` is missing"]);
    desk.run(&["sweep", "bad.json", "--gaps", "0:1:2"]).fails_with(1, &["the key `body` is missing"]);
    desk.run(&["export", "bad.json", "p"]).fails_with(1, &["the key `body` is missing"]);
    assert!(!desk.path("p").exists(), "a scene that fails writes no file");
}

#[test]
fn exit_code_2_means_wrong_usage_and_the_message_names_what_is_expected() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    for (arguments, phrase) in [
        (&["frobnicate"][..], "unrecognized subcommand 'frobnicate'"),
        (&["solve"], "<INPUT>"),
        (&["solve", "block.json", "--frob"], "unexpected argument '--frob'"),
        (&["solve", "block.json", "other.json"], "unexpected argument 'other.json'"),
        (&["solve", "block.json", "--method", "newton"], "auto, qp, active-set, penalty"),
        (&["solve", "block.json", "--format", "yaml"], "text, json"),
        (&["solve", "block.json", "--tolerance", "tiny"], "at most 0.1, such as 1e-9"),
        (&["solve", "block.json", "--tolerance", "-1"], "at most 0.1, such as 1e-9"),
        (&["compare", "block.json", "--tolerance", "0"], "at most 0.1, such as 1e-9"),
        (&["sweep", "block.json", "--gaps", "0:1:2", "--tolerance", "nan"], "at most 0.1, such as 1e-9"),
        (&["verify", "p", "--displacement", "u", "--multiplier", "l", "--tolerance", "inf"], "at most 0.1"),
        (&["solve", "block.json", "--out", ""], "--out <DIR>"),
        (&["compare"], "<INPUT>"),
        (&["sweep", "block.json"], "--gaps <FIRST:LAST:COUNT>"),
        (&["sweep", "block.json", "--gaps", "-0.01:-0.10"], "FIRST:LAST:COUNT, such as -0.01:-0.10:10"),
        (&["sweep", "block.json", "--gaps", "a:1:2"], "`a` is not a finite number"),
        (&["sweep", "block.json", "--gaps", "0:inf:2"], "`inf` is not a finite number"),
        (&["sweep", "block.json", "--gaps", "0:1:0"], "whole number from 1 to 10000"),
        (&["sweep", "block.json", "--gaps", "0:1:1e9"], "whole number from 1 to 10000"),
        (&["sweep", "block.json", "--gaps", "0:1:1"], "one gap cannot be both 0 and 1"),
        (&["export", "block.json"], "<DIRECTORY>"),
        (&["verify", "p"], "--displacement <u.mtx>"),
        (&["schema", "block.json"], "unexpected argument"),
    ] {
        let run = desk.run(arguments).ends_with(2);
        assert!(run.stdout.is_empty() && run.stderr.contains(phrase), "{arguments:?}: {}", run.stderr);
    }
}

#[test]
fn exit_code_3_means_that_there_is_no_unique_solution() {
    let desk = Desk::new();
    let cases = [
        ("infeasible", Problem::infeasible(), "contact rows 0 and 1 oppose each other"),
        ("unbounded", Problem::unbounded(), "dof 1"),
        ("under_held", Problem::under_held(), "held by neither supports nor obstacle"),
    ];
    for (status, problem, phrase) in cases {
        desk.problem(status, &problem);
        for command in ["solve", "compare"] {
            let run = desk.run(&[command, status, "--format", "json"]).fails_with(3, &[phrase]);
            assert_eq!(run.json()["status"], status);
        }
    }
    let mut loose = scene();
    loose["supports"] = json!([{"on": {"boundary": "left"}, "y": 0}]);
    desk.write("loose.json", loose.to_string());
    for arguments in [&["solve", "loose.json"][..], &["sweep", "loose.json", "--gaps", "0:1:2"]] {
        desk.run(arguments).fails_with(3, &["translation along x", "add a guide"]);
    }
    let mut squeezed = scene();
    let below =
        json!({"boundary": "top", "approach": "-y", "shape": {"plane": {"point": [0, 0.5], "normal": [0, -1]}}});
    squeezed["obstacles"].as_array_mut().unwrap().push(below);
    desk.write("squeezed.json", squeezed.to_string());
    desk.run(&["solve", "squeezed.json"]).fails_with(3, &["infeasible", "no room between obstacles[0]"]);
}

#[test]
fn exit_code_4_means_an_answer_that_is_not_certified() {
    let desk = Desk::new();
    let run = desk.run(&["solve", &example("indentation"), "--method", "penalty", "--format", "json"]);
    let run = run.fails_with(4, &["not certified", "above the tolerance 1.0e-9 (penalty after 12 iterations)"]);
    is_answer(&run.json(), true);
    assert_eq!(run.json()["status"], "not_certified");
    let strict = desk.run(&["solve", &example("indentation"), "--tolerance", "1e-30"]);
    // The remaining error is rounding of the displacement to doubles, and the report says so.
    let strict = strict.ends_with(0);
    assert!(strict.stdout.contains("certified as exact as doubles can hold u: "), "{}", strict.stdout);
    let loose = ["--method", "penalty", "--tolerance", "1e-12"];
    let loose = desk.run(&[&["solve", &example("indentation")][..], &loose].concat());
    let loose = loose.fails_with(4, &["not certified: ", "above the tolerance 1.0e-12"]);
    assert!(loose.stdout.contains("NOT certified to 1.0e-12"), "{}", loose.stdout);
}

#[test]
fn failures_in_json_are_one_object_with_status_and_message() {
    let desk = Desk::new();
    desk.write("bad.json", "{");
    let indefinite = matrix("symmetric", "2 2", &["1 1 1", "2 1 -3", "2 2 1"]);
    desk.problem("indefinite", &Problem { k: indefinite, ..Problem::right() });
    for (arguments, status) in [
        (&["solve", "bad.json"][..], "bad_input"),
        (&["compare", "bad.json"], "bad_input"),
        (&["sweep", "bad.json", "--gaps", "0:1:2"], "bad_input"),
        (&["solve", "indefinite"], "not_convex"),
        (&["verify", "nowhere", "--displacement", "u", "--multiplier", "l"], "bad_input"),
    ] {
        let run = desk.run(&[arguments, &["--format", "json"]].concat()).fails_with(1, &[]);
        let report = run.json();
        assert_eq!(report["status"], status);
        assert_eq!(run.stderr, format!("error: {}\n", report["message"].as_str().unwrap()));
    }
}

/// A bar under forces up to half of its stiffness, which it stretches by half, and above.
#[test]
fn an_answer_beyond_small_displacements_ends_with_exit_code_4_and_its_likely_cause() {
    let (desk, code) = (Desk::new(), "beyond-small-displacements");
    let mut scene = json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 2], "divisions": [4]}}},
        "material": {"young": 100, "poisson": 0},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"force": {"boundary": "right", "value": [1]}}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [3.5], "normal": [1]}}}]
    });
    let run = |scene: &Value, arguments: &[&str]| {
        desk.write("scene.json", scene.to_string());
        desk.run(&[&arguments[..1], &["scene.json"], &arguments[1..]].concat())
    };
    for (force, is_beyond) in [(16.0, false), (49.9, false), (50.1, true)] {
        scene["loads"][0]["force"]["value"] = json!([force]);
        let report = run(&scene, &["solve", "--format", "json"]).ends_with(if is_beyond { 4 } else { 0 }).json();
        assert_eq!(report["status"] == code, is_beyond, "{report}");
        let text = run(&scene, &["solve", "--linear"]).ends_with(0).stdout;
        assert!(text.contains(if is_beyond { "strains reach 50.1 %" } else { "the largest strain is" }), "{text}");
    }
    let report = run(&scene, &["solve", "--linear", "--format", "json"]).ends_with(0).json();
    let is_warned = |warning: &Value| {
        warning["code"] == code && warning["message"].to_string().contains("do not fit the stiffness")
    };
    assert!(report["warnings"].as_array().unwrap().iter().any(is_warned), "{report}");
    run(&scene, &["solve"]).fails_with(4, &["beyond small displacements"]);
    let compared = run(&scene, &["compare"]).fails_with(4, &["beyond small displacements"]).stdout;
    assert!(compared.contains("small displacements do not"), "{compared}");
    run(&scene, &["compare", "--linear"]).ends_with(0);
    scene["loads"][0]["force"]["value"] = json!([0]);
    let swept = run(&scene, &["sweep", "--gaps", "-1:-3:3", "--format", "json"]).ends_with(4).json();
    let statuses: Vec<&Value> = swept["points"].as_array().unwrap().iter().map(|point| &point["status"]).collect();
    assert_eq!(statuses, ["certified", "certified", code], "{swept}");
    run(&scene, &["sweep", "--gaps", "-1:-3:3", "--linear"]).ends_with(0);
}
