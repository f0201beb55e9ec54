//! A time limit is kept; it includes failed attempts, which the report names.
#![cfg(target_os = "linux")]

use signorini::{ContactProblem, Method, Settings, Watch, qp, solve};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use support::cases;
use support::endings::best;
use support::scenes::built;

use crate::blocks::{block, cube, pressed, pressed_on_a_plane, strip};
use serde_json::{Value, json};
use support::program::Desk;

#[test]
fn a_step_with_a_longer_estimate_than_the_time_left_does_not_begin() {
    let watch = Watch::default();
    // Without a deadline every step may begin.
    assert!(watch.allows(1e9) && watch.keeping(1e9).time_left().is_none());
    let hour = watch.within(3600.0);
    assert!(hour.allows(3000.0) && !hour.allows(4000.0));
    // An hour minus ten minutes that are kept for one more step.
    let left = hour.keeping(600.0).time_left().unwrap();
    assert!(left <= 3000.0, "{left}");
    assert!(hour.keeping(4000.0).is_over() && !hour.is_over());
    // After a step that took at least a hundred times its estimate, all later estimates are multiplied by this ratio.
    hour.timed(0.001, || std::thread::sleep(Duration::from_millis(100)));
    assert!(hour.needed(1.0) >= 100.0 && !hour.allows(36.0) && !watch.within(3600.0).allows(36.0));
    assert!(hour.unhurried().allows(1e9));
}

#[test]
fn no_method_begins_a_step_for_which_its_time_does_not_suffice() {
    let model = built(&block([60, 60], "q4"));
    for method in [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp] {
        for condense in [signorini::qp::Condense::Auto, signorini::qp::Condense::Never] {
            // A day suffices on every machine, and for no step of one that is ten billion times slower.
            let day = Duration::from_secs(24 * 3600);
            let mut settings = Settings::within(day);
            (settings.method, settings.condense, settings.tolerance) = (method, condense, Some(1e-6));
            let fast = solve(model.problem(), &settings).unwrap();
            assert!(fast.iterations > 0);
            settings.watch = Watch::default();
            settings.watch.learn(1e10);
            settings.time = Some(day);
            match solve(model.problem(), &settings) {
                Err(qp::Error::NotCertified { solution, .. }) => {
                    assert_eq!((solution.method.as_str(), solution.iterations), ("none", 0));
                    let cut = solution.cut_short.unwrap();
                    assert!(cut.starts_with("the time does not suffice"), "{cut}");
                }
                other => panic!("{method:?}: {:?}", other.map(|found| found.method)),
            }
        }
    }
}

/// The steps of a solve, each with its first iteration, in order.
fn steps(problem: &ContactProblem) -> Vec<String> {
    let steps = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&steps);
    let watch = Watch::observed(move |watch| seen.lock().unwrap().push(watch.activity().to_string()));
    solve(problem, &Settings::default().watched(&watch)).unwrap();
    let mut steps = steps.lock().unwrap().clone();
    steps.dedup();
    steps
}

/// In each step the time runs out once: whatever is left undone by then, the error says that the time ended.
#[test]
fn wherever_the_time_ends_the_error_says_so_and_claims_nothing() {
    let scenes = [
        pressed(cube(8, "hex8"), 2.0),
        pressed(block([30, 30], "q4"), 20.0),
        pressed_on_a_plane([30, 30]),
        pressed(strip(60), 1e-3),
        block([30, 30], "q4"),
    ];
    let (mut cut, time) = (0, Duration::from_millis(cases(50, 400)));
    for scene in scenes {
        let problem = built(&scene).problem().clone();
        for step in steps(&problem) {
            let late = step.clone();
            let watch = Watch::observed(move |watch| {
                if watch.activity().to_string() == late {
                    std::thread::sleep(time);
                }
            });
            let mut settings = Settings::default().watched(&watch);
            settings.time = Some(time);
            let Err(error) = solve(&problem, &settings) else { continue };
            let said = error.to_string();
            assert!(said.starts_with("not certified: the time "), "{step}: {said}");
            for word in ["convex", "slender", "factorisation (s)", " inf", "NaN", "rechecked"] {
                assert!(!said.contains(word), "{step}: {said}");
            }
            let best = error.into_best().unwrap();
            assert!(best.cut_short.is_some() && !best.reason.contains("convex"), "{step}");
            cut += 1;
        }
    }
    assert!(cut > 20, "{cut}");
}

/// A flat strip of Q8 cells with all rows closed: the bound on its boundary takes longer than all other steps.
fn touching(cells: usize) -> Value {
    let mut scene = block([cells, 2], "q8");
    scene["obstacles"][0]["shape"] = json!({"plane": {"point": [0, 1], "normal": [0, 1]}});
    scene
}

#[test]
fn a_stopped_certificate_returns_no_smaller_bound() {
    let model = built(&touching(300));
    let solved = |stops: bool| {
        let mut settings = Settings::with_method(Method::ActiveSet);
        settings.watch = Watch::observed(move |watch| {
            if stops && watch.activity().step == "certificate" {
                watch.stop();
            }
        });
        best(solve(model.problem(), &settings))
    };
    let (whole, cut) = (solved(false), solved(true));
    assert_eq!((&cut.displacement, &cut.multiplier), (&whole.displacement, &whole.multiplier));
    assert!(cut.certificate.conditions_hold(1e-9), "{:?}", cut.certificate);
    let bounds = [&cut, &whole].map(|solution| solution.certificate.energy_error_bound);
    assert!(bounds[0] >= bounds[1], "{bounds:?}");
}

#[test]
fn whatever_the_time_limit_an_answer_is_certified_or_said_not_to_be() {
    let desk = Desk::new();
    desk.write("touching.json", touching(1000).to_string());
    desk.write("fine.json", block([120, 120], "q8").to_string());
    desk.write("strip.json", strip(1000).to_string());
    let scenes = ["touching.json", "fine.json", "strip.json"];
    let runs = scenes.iter().flat_map(|scene| ["0.1", "1", "5"].map(|time| (scene, time)));
    // Every fourth run has another scene and another time.
    for (scene, time) in runs.step_by(cases(4, 1)) {
        let run = desk.run(&["solve", scene, "--time", time, "--format", "json"]);
        let status = run.json()["status"].clone();
        assert!(
            [(0, json!("certified")), (4, json!("not_certified"))].contains(&(run.code, status)),
            "{scene}: {}",
            run.stderr
        );
    }
}

#[test]
fn a_failed_attempt_is_reported_with_its_time_and_its_reason() {
    let desk = Desk::new();
    // The forces of a body a million times wider than it is high lose digits on the contact boundary alone.
    let (width, cells) = (1e6, |last: f64| json!({"points": [0, last], "divisions": [8]}));
    let wide = json!({
        "body": {"rectangle": {"x": cells(width), "y": cells(1.0)}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0},
                     {"on": {"boundary": "right"}, "x": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}}],
        "gap": -0.01
    });
    desk.write("wide.json", wide.to_string());
    let arguments = ["solve", "wide.json", "--method", "penalty", "--tolerance", "1e-6"];
    let text = desk.run(&arguments).ends_with(0).stdout;
    assert!(text.contains("also tried: penalty-dual, "), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let report = desk.run(&[&arguments[..], &["--format", "json"]].concat()).ends_with(0).json();
    let attempt = &report["attempts"][0];
    assert!(attempt["method"] == "penalty-dual" && attempt["reason"].as_str().unwrap().contains("condensed dofs"));
    let seconds = |value: &Value| value.as_f64().unwrap();
    assert!(seconds(&report["seconds"]["total"]) > seconds(&attempt["seconds"]), "{report}");
    // A solve without a failed attempt reports no attempts.
    desk.write("strip.json", strip(300).to_string());
    let report = desk.run(&["solve", "strip.json", "--format", "json"]).ends_with(0).json();
    assert!(report.get("attempts").is_none(), "{report}");
}
