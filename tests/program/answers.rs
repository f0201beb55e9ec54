//! Output of solve, compare, sweep and export: text, JSON and files.

use crate::promised::{has, is_answer, vectors};
use serde_json::{Value, json};
use support::program::{Desk, Problem, example, examples, scene};

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
fn solve_of_a_problem_directory_gives_the_answer_computed_by_hand() {
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
fn each_answer_names_its_method() {
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
fn text_reports_show_shortening_and_tension_of_a_bolt() {
    let block = |y: [f64; 2]| json!({"rectangle": {"x": {"points": [0, 1], "divisions": [2]}, "y": {"points": y, "divisions": [2]}}});
    let steel = json!({"young": 200, "poisson": 0});
    let scene = json!({
        "model": "plane-stress", "body": block([0.0, 2.0]), "material": steel,
        "further-bodies": [{"name": "far", "body": block([2.0, 5.0]), "material": steel}],
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "far.top"}, "x": 0, "y": 0}],
        "ties": [{"preload": {"boundary": "top", "to": "far.bottom", "force": 3}}], "loads": [],
    });
    let desk = Desk::new();
    desk.write("bolt.json", scene.to_string());
    let text = desk.run(&["solve", "bolt.json"]).ends_with(0).stdout;
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("shortening 7.500000e-2 m, tension 3.000000e0 N"), "{text}");
}

#[test]
fn condensed_and_full_problems_give_the_same_force_and_report_their_sizes() {
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
        "7 closed rows, sum of multipliers 7.077361e4 N per metre",
        "peak pressure 5.040723e5 ± 2.2e4 Pa",
        "certified to 1.0e-9",
        "K u - f - B' lambda",
    ] {
        assert!(run.stdout.contains(phrase), "{}\ndoes not contain {phrase:?}", run.stdout);
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
    assert_eq!(
        gaps,
        [-0.01, -0.02, -0.03, -0.04, -0.05, -0.06, -0.07, -0.08, -0.09, -0.1],
        "the gaps are printed as written"
    );
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

/// GOAL: a sweep by any method finds the same contact sets, with and without a factor.
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

/// GOAL: `--accuracy exact` makes the program choose a factor, and gives a warning if it has no effect.
#[test]
fn an_exact_accuracy_chooses_the_active_set_and_warns_if_the_method_is_given() {
    let desk = Desk::new();
    let scene = example("indentation");
    let solve = ["solve", &scene, "--format", "json", "--accuracy", "exact"];
    let exact = desk.run(&solve).ends_with(0);
    assert!(exact.stderr.is_empty() && exact.json()["method"].as_str().unwrap().starts_with("active-set"));
    let warned = desk.run(&[&solve[..], &["--method", "mprgp"]].concat()).ends_with(0);
    assert!(warned.stderr.contains("--accuracy exact changes nothing: the method is mprgp"), "{}", warned.stderr);
    let refused = desk.run(&["solve", &scene, "--accuracy", "exactly"]).ends_with(2).stderr;
    assert!(refused.contains("at most 0.1, such as 1e-3, or `exact`"), "{refused}");
}

/// GOAL: the time of the proof is reported separately, and the proof can be omitted.
#[test]
fn the_time_of_a_proof_is_reported_separately_and_the_proof_can_be_omitted() {
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
fn an_obstacle_out_of_reach_gives_a_certified_answer_without_contact() {
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
        let of_scene = desk
            .run(&["solve", &example(&name), "--format", "json", "--out", "scene", "--pictures", "none"])
            .ends_with(0)
            .json();
        let exported = desk.run(&["export", &example(&name), &name]).ends_with(0);
        assert!(exported.stdout.contains(" dofs and ") && exported.stderr.lines().count() == 1, "{}", exported.stdout);
        let of_files = desk.run(&["solve", &name, "--format", "json", "--out", "files"]).ends_with(0).json();
        assert_eq!(vectors(&desk, "scene"), vectors(&desk, "files"), "{name}");
        assert_eq!(of_scene["contact"]["force"], of_files["contact"]["force"]);
    }
}

/// The parabola is pressed 0.01 into the block at the middle of its top: nothing moves more.
#[test]
fn the_largest_displacement_has_its_place() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let report = desk.run(&["solve", "block.json", "--format", "json"]).ends_with(0).json();
    let largest = &report["largest_displacement"];
    assert_eq!((&largest["axis"], &largest["node"], &largest["place"]), (&json!(1), &json!(12), &json!([0.5, 0.5])));
    assert!((largest["value"].as_f64().unwrap() + 0.01).abs() < 1e-12, "{largest}");
    let text = desk.run(&["solve", "block.json"]).ends_with(0).stdout;
    let line = "  displacement  largest -1.000000e-2 m along y, at node 12, (5.0000e-1, 5.0000e-1) m\n";
    assert!(text.contains(line), "{text}");
}

#[test]
fn solve_and_sweep_tell_the_same_width() {
    let desk = Desk::new();
    let mut block = scene();
    block["body"]["rectangle"]["x"]["divisions"] = json!([40]);
    desk.write("block.json", block.to_string());
    let report = desk.run(&["solve", "block.json", "--format", "json"]).ends_with(0).json();
    let width = report["contact"]["estimate"]["width"].as_f64().unwrap();
    let table = desk.run(&["sweep", "block.json", "--gaps", "-0.01:-0.01:1"]).ends_with(0).stdout;
    assert!(table.contains("estimated width [m]") && table.contains(&format!(" {width:.6} ")), "{width} {table}");
    assert!((width - report["contact"]["width"].as_f64().unwrap()).abs() > 1e-3, "{report}");
}

/// Rows between meshes that do not match hold means: the report and the page say so where they speak of closed rows,
/// and nowhere else.
#[test]
fn closed_and_open_are_said_of_mean_gaps_where_rows_hold_means() {
    let block = |y: f64, cells: usize| json!({"rectangle": {"x": {"points": [0, 1], "divisions": [cells]}, "y": {"points": [y, y + 1.0], "divisions": [2]}}});
    let scene = |cells: usize| {
        let material = json!({"young": 1, "poisson": 0.3});
        json!({"body": block(1.0, 3), "material": material,
               "further-bodies": [{"name": "base", "body": block(0.0, cells), "material": material}],
               "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "left"}, "x": 0}],
               // Without a spring the upper block would float, and nothing could be proven.
               "springs": [{"on": {"boundary": "top"}, "y": 0.01}],
               "loads": [{"pressure": {"boundary": "top", "value": 0.01}}],
               "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"body": {"boundary": "base.top"}}}]})
    };
    let desk = Desk::new();
    for (cells, are_means) in [(3, false), (4, true)] {
        desk.write("blocks.json", scene(cells).to_string());
        let text = desk.run(&["solve", "blocks.json", "--out", "answer", "--pictures", "none"]).ends_with(0).stdout;
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let between = "Rows between the meshes of `base.top` and `bottom` hold means: closed and open belong to the mean \
                       gap over the area of a node, not to the gap at the node.";
        let between = between.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(" proven closed"), "{text}");
        assert_eq!(text.contains(&between), are_means, "{text}");
        let page = std::fs::read_to_string(desk.path("answer/report.html")).unwrap();
        assert_eq!(page.contains(&between), are_means, "{cells} cells");
        assert_eq!(page.contains("\"means\":{"), are_means, "the page marks the rows of means");
    }
}
