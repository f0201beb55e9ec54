//! The program chooses the method for a requested accuracy or time; the answer meets the request or states what it
//! reached.

use serde_json::json;
use signorini::qp::{Condense, Method, Prepared, Settings};
use signorini::{ContactProblem, Solution, qp, solve};
use std::time::Duration;
use support::program::{Desk, example, examples};
use support::scenes::built_example;

fn problem(name: &str) -> ContactProblem {
    built_example(name).problem().clone()
}

fn error(problem: &ContactProblem, found: &Solution, exact: &Solution) -> f64 {
    let energy =
        |u: &[f64]| u.iter().zip(problem.stiffness().mul(u)).map(|(u, force)| u * force).sum::<f64>().max(0.0).sqrt();
    let away: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(u, v)| u - v).collect();
    energy(&away) / energy(&found.displacement)
}

#[test]
fn an_accuracy_is_reached_and_certified() {
    for name in examples() {
        let problem = problem(&name);
        let exact = solve(&problem, &Settings::with_method(Method::ActiveSet)).unwrap();
        for accuracy in [1e-1, 1e-2, 1e-4, 1e-8, 1e-12] {
            let found = solve(&problem, &Settings::for_accuracy(accuracy)).unwrap();
            let bound = found.certificate.energy_error_bound;
            // If no bound is known, the conditions decide, to the tolerance.
            assert!(bound <= accuracy || (bound.is_infinite() && found.certificate.meets(1e-9)), "{name}");
            assert!(error(&problem, &found, &exact) <= accuracy, "{name}, {accuracy:e}");
        }
    }
}

#[test]
fn an_accuracy_below_rounding_is_met_as_exactly_as_doubles_hold_the_answer() {
    let problem = problem("indentation");
    let solution = solve(&problem, &Settings::for_accuracy(1e-30)).unwrap();
    assert_eq!(solution.certificate.met(), Some("rounding"));
    assert!(solution.certificate.met_tolerance < 1e-12 && solution.certificate.met_tolerance > 1e-30);
}

#[test]
fn enough_time_gives_the_exact_answer_and_no_time_gives_one_that_is_not_certified() {
    let problem = problem("indentation");
    let exact = solve(&problem, &Settings::default()).unwrap();
    let mut enough = Settings::within(Duration::from_secs(1_000_000));
    for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
        enough.method = method;
        let found = solve(&problem, &enough).unwrap();
        assert!(error(&problem, &found, &exact) < 1e-12 && found.contact_set == exact.contact_set);
    }
    for method in [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty()] {
        let mut settings = Settings::within(Duration::ZERO);
        settings.method = method;
        match solve(&problem, &settings) {
            Err(qp::Error::NotCertified { solution, .. }) => {
                let cut = solution.cut_short.as_ref().unwrap();
                assert!(cut.starts_with("the time does not suffice"), "{cut}");
                assert_eq!((solution.displacement.len(), solution.multiplier.len()), (problem.dofs(), problem.rows()));
            }
            other => panic!("{:?}", other.map(|found| found.certificate)),
        }
    }
    let none = Settings::within(Duration::ZERO);
    assert!(matches!(Prepared::new(&problem, &none), Err(qp::Error::OutOfTime { .. })));
}

#[test]
fn a_loop_without_time_does_not_begin_and_a_stopped_loop_ends_after_one_iteration() {
    // On all dofs every iteration needs a factorisation.
    let problem = problem("indentation");
    let prepared = Prepared::new(&problem, &Settings::default().with_condensation(Condense::Never)).unwrap();
    for method in [Method::ActiveSet, Method::penalty()] {
        let mut settings = Settings::with_method(method);
        settings.time = Some(Duration::ZERO);
        let Err(qp::Error::NotCertified { solution, .. }) =
            prepared.with_settings(&settings).unwrap().solve(problem.gap())
        else {
            panic!("{method:?}");
        };
        assert!(solution.cut_short.unwrap().starts_with("the time does not suffice"), "{method:?}");
        // A loop that is asked to stop ends after the current iteration.
        settings.time = None;
        settings.watch.stop();
        match prepared.with_settings(&settings).unwrap().solve(problem.gap()) {
            Err(qp::Error::NotCertified { solution, .. }) => assert_eq!(solution.iterations, 1, "{method:?}"),
            other => panic!("{:?}", other.map(|found| found.iterations)),
        }
    }
}

#[test]
fn invalid_accuracies_are_refused_by_name() {
    let problem = problem("bar");
    for wrong in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let refused = solve(&problem, &Settings::for_accuracy(wrong));
        assert!(
            matches!(refused, Err(qp::Error::Linear(qp::LinearError::Setting { name: "accuracy", .. }))),
            "{wrong}"
        );
    }
}

#[test]
fn the_command_line_takes_accuracy_time_and_precision() {
    let desk = Desk::new();
    let scene = example("indentation");
    let run = |options: &[&str]| desk.run(&[&["solve", &scene], options].concat());
    let text = run(&["--accuracy", "1e-4"]).ends_with(0).stdout;
    assert!(text.contains("certified to 1.0e-4, each relative"), "{text}");
    let json = run(&["--accuracy", "1e-4", "--format", "json"]).ends_with(0).json();
    assert_eq!((json["status"].as_str(), json["accuracy"].as_f64()), (Some("certified"), Some(1e-4)));
    run(&["--precision", "double"]).ends_with(0);
    let refused = run(&["--precision", "mixed"]).ends_with(2).stderr;
    assert!(refused.contains("single precision are gone") && refused.contains("take the method mprgp"), "{refused}");
    let text = run(&["--method", "penalty", "--accuracy", "1e-3"]).ends_with(0).stdout;
    assert!(text.contains("the penalty went up to"), "{text}");
    let refused = run(&["--method", "penalty", "--extrapolate"]).ends_with(2).stderr;
    assert!(refused.contains("the extrapolation of a penalty is gone: take the method active-set"), "{refused}");

    let short = run(&["--accuracy", "1e-30", "--format", "json"]).ends_with(0).json();
    assert_eq!((&short["status"], &short["certificate"]["met"]), (&json!("certified"), &json!("rounding")));
    let short = run(&["--accuracy", "1e-15", "--method", "penalty", "--format", "json"]);
    let short = short.fails_with(4, &["not certified", "; certified to"]);
    assert_eq!(short.json()["status"], "not_certified");
    let late = run(&["--time", "1e-12", "--format", "json"]).ends_with(4);
    assert_eq!(late.json()["status"], "not_certified");
    assert!(late.stderr.contains("the time does not suffice"), "{}", late.stderr);
    let same = run(&["--time-limit", "1e-12", "--format", "json"]).ends_with(4);
    assert_eq!(same.json()["status"], "not_certified");
    for option in ["--accuracy", "--time", "--time-limit"] {
        for wrong in ["0", "-1", "nan", "inf", "soon"] {
            run(&[option, wrong]).ends_with(2);
        }
    }
    run(&["--precision", "half"]).ends_with(2);
}
