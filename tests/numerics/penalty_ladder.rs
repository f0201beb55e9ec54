//! The penalty ladder with a requested accuracy.

use signorini::qp::{Condense, Error, Method, Settings};
use signorini::{ContactProblem, Penalty, Solution, solve};
use support::endings::best;
use support::program::examples;
use support::scenes::built_example;

/// The scenes whose stiffness is positive definite without contact, and small enough for a solve on all dofs.
fn problems() -> Vec<(String, ContactProblem)> {
    let problem = |name: String| (built_example(&name).problem().clone(), name);
    let all = examples().into_iter().map(problem).map(|(problem, name)| (name, problem));
    let definite = |problem: &ContactProblem| {
        problem.prove(&exact(problem).displacement, &exact(problem).multiplier).unwrap().is_some()
    };
    all.filter(|(_, problem)| problem.dofs() < 5000 && definite(problem)).collect()
}

fn exact(problem: &ContactProblem) -> Solution {
    solve(problem, &Settings::with_method(Method::ActiveSet)).unwrap()
}

fn penalty(problem: &ContactProblem, change: impl Fn(&mut Settings)) -> Solution {
    let mut settings = Settings::with_method(Method::penalty());
    change(&mut settings);
    best(solve(problem, &settings))
}

fn error(problem: &ContactProblem, found: &Solution, exact: &Solution) -> f64 {
    let energy =
        |u: &[f64]| u.iter().zip(problem.stiffness().mul(u)).map(|(u, force)| u * force).sum::<f64>().max(0.0).sqrt();
    let away: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(u, v)| u - v).collect();
    energy(&away) / energy(&found.displacement)
}

fn last_penalty(found: &Solution) -> f64 {
    found.history.last().map_or(0.0, |step| step.penalty)
}

#[test]
fn the_ladder_ends_on_the_first_rung_with_the_requested_accuracy() {
    for (name, problem) in problems() {
        let exact = exact(&problem);
        for condense in [Condense::Auto, Condense::Never] {
            let mut last = 0.0;
            for accuracy in [1e-1, 1e-3, 1e-5] {
                let found = penalty(&problem, |settings| {
                    (settings.accuracy, settings.condense) = (Some(accuracy), condense);
                });
                let bound = found.certificate.energy_error_bound;
                assert!(bound <= accuracy, "{name}, {condense:?}: {bound:e}");
                assert!(error(&problem, &found, &exact) <= bound * (1.0 + 1e-6) + 1e-12);
                let penalty = last_penalty(&found);
                assert!(penalty > last, "{name}: a tighter accuracy must take a larger penalty");
                last = penalty;
                if penalty > 1.0 {
                    // The rung before is not accurate enough.
                    let ladder = Penalty { last: penalty / 10.0, penetration_threshold: 0.0, ..Penalty::default() };
                    let before = self::penalty(&problem, |settings| {
                        (settings.method, settings.condense) = (Method::Penalty(ladder), condense);
                    });
                    let without = before.certificate.energy_error_bound;
                    assert!(without > accuracy, "{name}, {condense:?}, {accuracy:e}: {bound:e} instead of {without:e}");
                }
            }
        }
    }
}

#[test]
fn the_ladder_ends_with_an_error_at_the_accuracy_that_rounding_allows() {
    for (name, problem) in problems() {
        let ladder = Penalty { last: 1e18, ..Penalty::default() };
        let settings = Settings::with_method(Method::Penalty(ladder)).with_accuracy(1e-15);
        match solve(&problem, &settings) {
            Err(Error::NotCertified { solution, condition, value, tolerance }) => {
                assert!(["energy_error_bound", "penetration"].contains(&condition), "{name}: {condition}");
                assert_eq!(tolerance, 1e-15);
                assert!(value < 1e-6 && solution.certificate.energy_error_bound < 1e-6, "{name}: floor {value:e}");
                // The ladder ends at the penalty from which on more penalty only adds rounding, long before the last
                // rung.
                assert!(last_penalty(&solution) <= 1e14, "{name}: {:e}", last_penalty(&solution));
            }
            // A penalty answer without penetration is exact.
            Ok(solution) => assert!(solution.certificate.energy_error_bound <= 1e-15, "{name}"),
            Err(error) => panic!("{name}: {error}"),
        }
    }
}
