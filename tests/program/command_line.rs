//! The command line as a contract: what each command prints, in text and JSON, and with which exit code it ends.

use std::fs;
use std::io::Read;
use std::process::Stdio;

use crate::program::{Desk, Problem, Run, example, examples, scene, vector};
use serde_json::{Value, json};
use signorini::qp::read_vector;

const COMMANDS: [&str; 6] = ["solve", "compare", "sweep", "export", "verify", "schema"];

/// Asserts that `value` is an object with these fields, each of its kind: `number`, `count`, `string` or `bool`.
#[track_caller]
fn has(value: &Value, fields: &[(&str, &str)]) {
    for &(name, kind) in fields {
        let field = &value[name];
        let fits = match kind {
            "number" => field.is_f64(),
            "count" => field.is_u64(),
            "string" => field.is_string(),
            "bool" => field.is_boolean(),
            other => panic!("no kind {other}"),
        };
        assert!(fits, "{name} is {field}, not a {kind}, in {value:#}");
    }
}

const CERTIFICATE: [(&str, &str); 5] = [
    ("stationarity", "number"),
    ("penetration", "number"),
    ("adhesion", "number"),
    ("complementarity", "number"),
    ("duality_gap", "number"),
];

/// Asserts the promised form of one answer.
#[track_caller]
fn is_answer(answer: &Value, of_scene: bool) {
    has(answer, &[("status", "string"), ("method", "string"), ("iterations", "count"), ("tolerance", "number")]);
    assert!(answer["status"] == "certified" || answer["status"] == "not_certified", "{}", answer["status"]);
    has(&answer["contact"], &[("count", "count"), ("force", "number")]);
    assert_eq!(answer["contact"]["pressure_max"].is_f64(), of_scene, "{answer:#}");
    has(&answer["certificate"], &CERTIFICATE);
    let bound = answer["certificate"].get("energy_error_bound").expect("a bound, or null where none is known");
    assert!(bound.is_f64() || bound.is_null(), "{bound}");
    has(&answer["model"], &[("dofs", "count"), ("contact_rows", "count"), ("condensed_dofs", "count")]);
    has(
        &answer["seconds"],
        &[("assemble", "number"), ("factor", "number"), ("solve", "number"), ("proof", "number"), ("total", "number")],
    );
}

fn vectors(desk: &Desk, folder: &str) -> (Vec<f64>, Vec<f64>) {
    let read = |name: &str| read_vector(&desk.path(&format!("{folder}/{name}.mtx"))).unwrap();
    (read("u"), read("lambda"))
}

#[test]
fn solve_prints_one_object_of_the_promised_form_for_every_example() {
    let desk = Desk::new();
    for name in examples() {
        let answer = desk.run(&["solve", &example(&name), "--format", "json"]).ends_with(0).json();
        is_answer(&answer, true);
        assert_eq!((&answer["status"], &answer["method"]), (&json!("certified"), &json!("active-set")), "{name}");
    }
}

#[test]
fn solve_of_a_problem_directory_gives_the_answer_that_a_hand_finds() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    let run = desk.run(&["solve", "p", "--format", "json", "--out", "p"]).ends_with(0);
    let answer = run.json();
    is_answer(&answer, false);
    assert_eq!((&answer["contact"]["count"], &answer["model"]["dofs"]), (&json!(1), &json!(2)));
    assert!((answer["contact"]["force"].as_f64().unwrap() - 1.35).abs() < 1e-15);
    let (u, lambda) = vectors(&desk, "p");
    assert!((u[0] - 0.55).abs() < 1e-15 && (u[1] - 0.1).abs() < 1e-15 && (lambda[0] + 1.35).abs() < 1e-15);
}

#[test]
fn each_method_answers_under_its_own_name() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    for (method, name, tolerance) in [
        ("auto", "active-set", "1e-9"),
        ("qp", "qp", "1e-9"),
        ("active-set", "active-set", "1e-9"),
        ("penalty", "penalty", "1e-4"),
    ] {
        let arguments = ["solve", "p", "--method", method, "--tolerance", tolerance, "--format", "json"];
        let answer = desk.run(&arguments).ends_with(0).json();
        assert!(answer["method"].as_str().unwrap().starts_with(name), "{method}: {}", answer["method"]);
        assert_eq!(answer["tolerance"].as_f64(), tolerance.parse().ok());
    }
}

#[test]
fn condensed_and_full_problems_give_the_same_force_under_their_own_sizes() {
    let (desk, scene) = (Desk::new(), example("indentation"));
    let solve = |more: &[&str]| {
        let arguments = [&["solve", &scene, "--format", "json"], more].concat();
        let answer = desk.run(&arguments).ends_with(0).json();
        (answer["model"]["condensed_dofs"].as_u64().unwrap(), answer["contact"]["force"].as_f64().unwrap())
    };
    let (full, condensed) = (solve(&["--no-condense"]), solve(&[]));
    assert_eq!(full.0, 1640);
    assert!(condensed.0 < full.0 && (condensed.1 / full.1 - 1.0).abs() < 1e-12, "{condensed:?} {full:?}");
}

#[test]
fn text_reports_show_title_units_force_and_certificate() {
    let desk = Desk::new();
    let run = desk.run(&["solve", &example("indentation")]).ends_with(0);
    assert_eq!(run.stderr, "");
    for phrase in [
        "Indentation by a parabola\n",
        "1640 dofs, 41 contact rows",
        "7 closed rows, force 7.077361e4 N",
        "peak pressure 5.040723e5 Pa, width 1.750000e-1 m",
        "certified to 1.0e-9",
        "K u - f - B' lambda",
    ] {
        assert!(run.stdout.contains(phrase), "{}\nlacks {phrase:?}", run.stdout);
    }
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{}", run.stdout);
}

#[test]
fn compare_prints_three_methods_and_their_agreement() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    for (input, of_scene) in [(example("indentation"), true), ("p".to_string(), false)] {
        let report = desk.run(&["compare", &input, "--format", "json"]).ends_with(0).json();
        let methods = report["methods"].as_array().expect("an array");
        let names: Vec<&str> = methods.iter().map(|method| method["method"].as_str().unwrap()).collect();
        assert_eq!(names, ["qp", "active-set", "penalty"]);
        methods.iter().for_each(|method| is_answer(method, of_scene));
        has(&report["agreement"], &[("exact_methods", "bool"), ("penalty_within_its_bound", "bool")]);
        assert_eq!(report["agreement"]["exact_methods"], true);
        for pair in ["active_set", "penalty"] {
            has(&report["agreement"][pair], &[("displacement", "number"), ("multiplier", "number"), ("rows", "count")]);
        }
    }
    let text = desk.run(&["compare", "p"]).ends_with(0).stdout;
    for phrase in ["method", "iterations", "max |du|", "seconds", "duality gap", "The QP and the active set agree"] {
        assert!(text.contains(phrase), "{text}");
    }
}

#[test]
fn sweep_certifies_every_gap_with_growing_force_and_width() {
    let desk = Desk::new();
    let arguments = ["sweep", &example("indentation"), "--gaps", "-0.01:-0.10:10", "--format", "json"];
    let report = desk.run(&arguments).ends_with(0).json();
    let points = report["points"].as_array().expect("an array");
    let gaps: Vec<f64> = points.iter().map(|point| point["gap"].as_f64().unwrap()).collect();
    assert_eq!(gaps, [-0.01, -0.02, -0.03, -0.04, -0.05, -0.06, -0.07, -0.08, -0.09, -0.1], "as they are written");
    let mut last = (0.0, 0.0);
    for point in points {
        is_answer(point, true);
        assert_eq!(point["status"], "certified");
        let of = |name: &str| point["contact"][name].as_f64().unwrap();
        let (force, width) = (of("force"), of("width"));
        assert!(force > last.0 && width >= last.1, "force {force}, width {width} after {last:?}");
        last = (force, width);
    }
}

/// GOAL: the methods that a sweep may be told give its answers, with and without a factor.
#[test]
fn a_sweep_by_any_method_finds_the_same_contact_sets() {
    let desk = Desk::new();
    let scene = example("indentation");
    let sweep = |method: &str| {
        let arguments = ["sweep", &scene, "--gaps", "-0.01:-0.10:4", "--format", "json", "--method", method];
        desk.run(&arguments).ends_with(0).json()["points"].clone()
    };
    let auto = sweep("auto");
    for method in ["active-set", "qp", "mprgp"] {
        let points = sweep(method);
        for (point, expected) in points.as_array().unwrap().iter().zip(auto.as_array().unwrap()) {
            assert!(point["method"].as_str().unwrap().starts_with(method), "{}", point["method"]);
            assert_eq!(point["contact"]["count"], expected["contact"]["count"], "{method} at {}", point["gap"]);
        }
    }
}

/// GOAL: `--accuracy exact` takes a factor where the program would choose otherwise, and warns where it has no say.
#[test]
fn an_exact_accuracy_is_the_linear_solve_of_the_settled_set() {
    let desk = Desk::new();
    let scene = example("indentation");
    let solve = ["solve", &scene, "--format", "json", "--accuracy", "exact"];
    let exact = desk.run(&solve).ends_with(0);
    assert!(exact.stderr.is_empty() && exact.json()["method"].as_str().unwrap().starts_with("active-set"));
    let warned = desk.run(&[&solve[..], &["--method", "mprgp"]].concat()).ends_with(0);
    assert!(warned.stderr.contains("--accuracy exact changes nothing: the method is mprgp"), "{}", warned.stderr);
    let refused = desk.run(&["solve", &scene, "--accuracy", "exactly"]).ends_with(2).stderr;
    assert!(refused.contains("a positive number, as 1e-3, or `exact`"), "{refused}");
}

/// GOAL: what a proof costs stands by itself, and it is left out where it is not wanted.
#[test]
fn a_proof_has_seconds_of_its_own_and_can_be_left_out() {
    let desk = Desk::new();
    let scene = example("indentation");
    let with = desk.run(&["solve", &scene, "--format", "json"]).ends_with(0).json();
    let without = desk.run(&["solve", &scene, "--format", "json", "--no-proof"]).ends_with(0).json();
    let seconds = |answer: &Value, stage: &str| answer["seconds"][stage].as_f64().unwrap();
    assert!(with["proven"].is_object() && seconds(&with, "proof") > 0.0);
    assert!(without.get("proven").is_none() && seconds(&without, "proof") == 0.0);
    let parts: f64 = ["assemble", "factor", "solve", "proof"].iter().map(|stage| seconds(&with, stage)).sum();
    assert!((parts - seconds(&with, "total")).abs() <= 1e-12 * parts);
}

#[test]
fn sweep_prints_one_line_for_each_gap_and_names_an_untitled_scene_by_its_file() {
    let desk = Desk::new();
    let mut untitled = scene();
    untitled["title"] = json!("");
    desk.write("block.json", untitled.to_string());
    let text = desk.run(&["sweep", "block.json", "--gaps=-0.01:-0.03:3"]).ends_with(0).stdout;
    assert!(text.starts_with("block.json\n"), "{text}");
    assert_eq!(text.lines().filter(|line| line.ends_with("  certified")).count(), 3, "{text}");
    let one = desk.run(&["sweep", "block.json", "--gaps", "-0.01:-0.01:1", "--format", "json"]).ends_with(0).json();
    assert_eq!(one["points"].as_array().unwrap().len(), 1);
}

#[test]
fn an_obstacle_out_of_reach_is_certified_as_the_free_body() {
    let desk = Desk::new();
    let mut far = scene();
    far["gap"] = json!(1);
    desk.write("far.json", far.to_string());
    let answer = desk.run(&["solve", "far.json", "--format", "json"]).ends_with(0).json();
    assert_eq!((&answer["contact"]["count"], &answer["contact"]["force"]), (&json!(0), &json!(0.0)));
}

#[test]
fn exported_problems_give_the_answer_of_their_scene_bit_for_bit() {
    let desk = Desk::new();
    for name in examples() {
        let of_scene = desk.run(&["solve", &example(&name), "--format", "json", "--out", "scene"]).ends_with(0).json();
        let exported = desk.run(&["export", &example(&name), &name]).ends_with(0);
        assert!(exported.stdout.contains(" dofs and ") && exported.stderr.is_empty(), "{}", exported.stdout);
        let of_files = desk.run(&["solve", &name, "--format", "json", "--out", "files"]).ends_with(0).json();
        assert_eq!(vectors(&desk, "scene"), vectors(&desk, "files"), "{name}");
        assert_eq!(of_scene["contact"]["force"], of_files["contact"]["force"]);
    }
}

fn verify(desk: &Desk, format: &str) -> Run {
    let (u, lambda) = ("p/u.mtx", "p/lambda.mtx");
    desk.run(&["verify", "p", "--displacement", u, "--multiplier", lambda, "--format", format])
}

#[test]
fn verify_accepts_what_solve_wrote_and_rejects_each_single_changed_entry() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.run(&["export", "block.json", "p"]).ends_with(0);
    desk.run(&["solve", "p", "--out", "p"]).ends_with(0);
    let report = verify(&desk, "json").ends_with(0).json();
    has(&report, &[("status", "string"), ("tolerance", "number")]);
    has(&report["certificate"], &CERTIFICATE);
    has(&report["model"], &[("dofs", "count"), ("contact_rows", "count")]);
    assert!(verify(&desk, "text").ends_with(0).stdout.contains("certified to 1.0e-9"));

    let (u, lambda) = vectors(&desk, "p");
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let text = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(f64::to_string).collect();
        vector(&words.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let mut changes = 0;
    for (name, values) in [("u", &u), ("lambda", &lambda)] {
        for index in 0..values.len() {
            // A hundred tolerances of the largest entry.
            let mut changed = values.clone();
            changed[index] += 1e-7 * largest(values);
            desk.write(&format!("p/{name}.mtx"), text(&changed));
            let report = verify(&desk, "json").ends_with(4).json();
            assert_eq!(report["status"], "not_certified", "entry {index} of {name}");
            changes += 1;
        }
        desk.write(&format!("p/{name}.mtx"), text(values));
    }
    assert!(changes > 20);
    verify(&desk, "text").ends_with(0);
}

#[test]
fn verify_rejects_a_multiplier_of_the_other_sign() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    desk.write("p/u.mtx", vector(&["0.55", "0.1"]));
    desk.write("p/lambda.mtx", vector(&["1.35"]));
    assert!(verify(&desk, "text").ends_with(4).stdout.contains("NOT certified"));
    desk.write("p/lambda.mtx", vector(&["-1.35"]));
    verify(&desk, "text").ends_with(0);
}

#[test]
fn exit_code_1_means_bad_input() {
    let desk = Desk::new();
    desk.write("bad.json", "{}");
    desk.run(&["solve", "nowhere.json"]).fails_with(1, &["cannot read nowhere.json"]);
    desk.run(&["solve", "bad.json"]).fails_with(1, &["bad.json:1:2", "missing field `body`"]);
    desk.run(&["compare", "bad.json"]).fails_with(1, &["missing field `body`"]);
    desk.run(&["sweep", "bad.json", "--gaps", "0:1:2"]).fails_with(1, &["missing field `body`"]);
    desk.run(&["export", "bad.json", "p"]).fails_with(1, &["missing field `body`"]);
    assert!(!desk.path("p").exists(), "nothing is written of a scene that fails");
}

#[test]
fn exit_code_2_means_usage_and_says_what_is_expected() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    for (arguments, phrase) in [
        (&["frobnicate"][..], "unrecognized subcommand 'frobnicate'"),
        (&["solve"], "<INPUT>"),
        (&["solve", "block.json", "--frob"], "unexpected argument '--frob'"),
        (&["solve", "block.json", "other.json"], "unexpected argument 'other.json'"),
        (&["solve", "block.json", "--method", "newton"], "auto, qp, active-set, penalty"),
        (&["solve", "block.json", "--format", "yaml"], "text, json"),
        (&["solve", "block.json", "--tolerance", "tiny"], "a positive number, as 1e-9"),
        (&["solve", "block.json", "--tolerance", "-1"], "a positive number, as 1e-9"),
        (&["compare", "block.json", "--tolerance", "0"], "a positive number, as 1e-9"),
        (&["sweep", "block.json", "--gaps", "0:1:2", "--tolerance", "nan"], "a positive number, as 1e-9"),
        (&["verify", "p", "--displacement", "u", "--multiplier", "l", "--tolerance", "inf"], "a positive number"),
        (&["solve", "block.json", "--out", ""], "--out <DIR>"),
        (&["compare"], "<INPUT>"),
        (&["sweep", "block.json"], "--gaps <FIRST:LAST:COUNT>"),
        (&["sweep", "block.json", "--gaps", "-0.01:-0.10"], "FIRST:LAST:COUNT, as -0.01:-0.10:10"),
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
fn exit_code_3_means_that_there_is_no_one_solution() {
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
    // What is left of the error is rounding of the displacement to doubles, and the report says so.
    let strict = strict.ends_with(0);
    assert!(strict.stdout.contains("certified to 1.0e-30"), "{}", strict.stdout);
    assert!(strict.stdout.contains("explained by rounding the displacement to double precision"), "{}", strict.stdout);
    let loose = ["--method", "penalty", "--tolerance", "1e-12"];
    let loose = desk.run(&[&["solve", &example("indentation")][..], &loose].concat());
    let loose = loose.fails_with(4, &["not certified: ", "above the tolerance 1.0e-12"]);
    assert!(loose.stdout.contains("NOT certified to 1.0e-12"), "{}", loose.stdout);
}

#[test]
fn failures_in_json_are_one_object_with_status_and_message() {
    let desk = Desk::new();
    desk.write("bad.json", "{");
    let indefinite = crate::program::matrix("symmetric", "2 2", &["1 1 1", "2 1 -3", "2 2 1"]);
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

#[test]
fn no_arguments_show_the_help() {
    let run = Desk::new().run(&[]).ends_with(2);
    for command in COMMANDS {
        assert!(run.stderr.contains(command), "{}", run.stderr);
    }
    assert!(run.stderr.contains("Exit codes: 0 certified, 1 bad input or file, 2 usage"));
}

#[test]
fn help_of_every_command_names_its_arguments() {
    let desk = Desk::new();
    let common = ["--tolerance <T>", "--out <DIR>", "--format <FORMAT>", "[default: 1e-9]"];
    for (command, arguments) in [
        ("solve", &["<INPUT>", "--method <METHOD>", "active-set", "penalty"][..]),
        ("compare", &["<INPUT>"]),
        ("sweep", &["<SCENE>", "--gaps <FIRST:LAST:COUNT>"]),
        ("export", &["<SCENE>", "<DIRECTORY>"]),
        ("verify", &["<DIRECTORY>", "--displacement <u.mtx>", "--multiplier <lambda.mtx>", "--tolerance <T>"]),
        ("schema", &[]),
    ] {
        let help = desk.run(&[command, "--help"]).ends_with(0).stdout;
        let shared = if ["solve", "compare", "sweep"].contains(&command) { &common[..] } else { &[] };
        for argument in arguments.iter().chain(shared) {
            assert!(help.contains(argument), "{command}: {help}");
        }
    }
    assert!(desk.run(&["--version"]).ends_with(0).stdout.contains(env!("CARGO_PKG_VERSION")));
}

/// Does `value` have the form of `schema`? As far as the words that the schema of a scene uses.
fn conforms(value: &Value, schema: &Value, root: &Value) -> Result<(), String> {
    let keys = |value: &Value| value.as_object().map(|map| map.keys().cloned().collect::<Vec<_>>()).unwrap_or_default();
    for word in keys(schema) {
        let known = [
            "$defs",
            "$ref",
            "$schema",
            "title",
            "description",
            "default",
            "format",
            "minimum",
            "type",
            "const",
            "enum",
            "oneOf",
            "anyOf",
            "items",
            "minItems",
            "maxItems",
            "properties",
            "required",
            "additionalProperties",
        ];
        assert!(known.contains(&word.as_str()), "the test does not know the word `{word}`");
    }
    if let Some(reference) = schema["$ref"].as_str() {
        let target = root.pointer(reference.trim_start_matches('#')).ok_or("a reference to nothing")?;
        conforms(value, target, root)?;
    }
    if let Some(kinds) = schema.get("type") {
        let is = |kind: &Value| match kind.as_str() {
            Some("object") => value.is_object(),
            Some("array") => value.is_array(),
            Some("string") => value.is_string(),
            Some("number") => value.is_number(),
            Some("integer") => value.is_u64(),
            Some("null") => value.is_null(),
            _ => false,
        };
        if !kinds.as_array().map_or_else(|| is(kinds), |kinds| kinds.iter().any(is)) {
            return Err(format!("{value} is not of type {kinds}"));
        }
    }
    if schema.get("const").is_some_and(|constant| constant != value) {
        return Err(format!("{value} is not {}", schema["const"]));
    }
    if schema["enum"].as_array().is_some_and(|choices| !choices.contains(value)) {
        return Err(format!("{value} is none of {}", schema["enum"]));
    }
    for (word, allowed) in [("oneOf", 1..=1), ("anyOf", 1..=usize::MAX)] {
        if let Some(choices) = schema[word].as_array() {
            let fitting = choices.iter().filter(|choice| conforms(value, choice, root).is_ok()).count();
            if !allowed.contains(&fitting) {
                return Err(format!("{value} fits {fitting} of {word}"));
            }
        }
    }
    if let (Some(items), Some(of)) = (value.as_array(), schema.get("items")) {
        items.iter().try_for_each(|item| conforms(item, of, root))?;
        let bounds = [schema["minItems"].as_u64().unwrap_or(0), schema["maxItems"].as_u64().unwrap_or(u64::MAX)];
        if !(bounds[0]..=bounds[1]).contains(&(items.len() as u64)) {
            return Err(format!("{value} has {} items", items.len()));
        }
    }
    let mut required = schema["required"].as_array().filter(|_| value.is_object()).into_iter().flatten();
    if let Some(missing) = required.find(|key| value.get(key.as_str().unwrap()).is_none()) {
        return Err(format!("{missing} is missing"));
    }
    for key in keys(value) {
        match schema["properties"].get(&key) {
            Some(of) => conforms(&value[&key], of, root).map_err(|error| format!("{key}: {error}"))?,
            None if schema["additionalProperties"] == false => return Err(format!("unknown {key}")),
            None => {}
        }
    }
    Ok(())
}

#[test]
fn every_example_conforms_to_the_printed_schema_and_a_misspelt_one_does_not() {
    let schema = Desk::new().run(&["schema"]).ends_with(0).json();
    for name in examples() {
        let scene: Value = serde_json::from_str(&fs::read_to_string(example(&name)).unwrap()).unwrap();
        conforms(&scene, &schema, &schema).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    conforms(&scene(), &schema, &schema).unwrap();
    for (pointer, value) in [
        ("/material", json!({"young": 1e7, "nu": 0.3})),
        ("/body", json!({"blob": {}})),
        ("/supports/0/on", json!("bottom")),
        ("/obstacles/0/approach", json!("up")),
        ("/loads/0", json!({"traction": {"boundary": "top"}})),
        ("/gap", json!("0")),
    ] {
        let mut wrong = scene();
        *wrong.pointer_mut(pointer).unwrap() = value;
        assert!(conforms(&wrong, &schema, &schema).is_err(), "{pointer}");
    }
}

#[test]
fn a_schema_address_a_byte_order_mark_and_standard_input_are_accepted() {
    let desk = Desk::new();
    let mut addressed = scene();
    addressed["$schema"] = json!("scene.schema.json");
    desk.write("addressed.json", format!("\u{feff}{addressed}"));
    desk.run(&["solve", "addressed.json"]).ends_with(0);
    #[cfg(unix)]
    {
        let stdin = fs::File::open(desk.path("addressed.json")).unwrap();
        assert!(desk.command(&["solve", "/dev/stdin"]).stdin(stdin).output().unwrap().status.success());
    }
}

#[test]
fn a_title_cannot_steer_the_terminal() {
    let desk = Desk::new();
    let mut loud = scene();
    loud["title"] = json!("red \u{1b}[31m\nand\u{7} loud");
    loud["units"] = json!({"length": "m\n", "force": "N"});
    desk.write("loud.json", loud.to_string());
    for arguments in
        [&["solve", "loud.json"][..], &["compare", "loud.json"], &["sweep", "loud.json", "--gaps", "0:0:1"]]
    {
        let text = desk.run(arguments).ends_with(0).stdout;
        assert!(text.starts_with("red \\u{1b}[31m\\nand\\u{7} loud\n"), "{text:?}");
        assert!(!text.chars().any(|character| character.is_control() && character != '\n'), "{text:?}");
    }
}

#[test]
fn a_reader_that_goes_away_makes_no_panic() {
    let desk = Desk::new();
    for arguments in [&["schema"][..], &["solve", &example("indentation"), "--format", "json"], &["--help"], &[]] {
        let mut child = desk.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut stderr = String::new();
        child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        let code = child.wait().unwrap().code();
        assert_eq!(code, Some(if arguments.is_empty() { 2 } else { 0 }), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_reported_with_exit_code_1() {
    let desk = Desk::new();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = desk.command(&["schema"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stderr).unwrap().starts_with("error: cannot write to standard output: "));
}
