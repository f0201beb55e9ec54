//! The factor in single precision: it gives the same answers in half the memory, and double precision replaces it if it
//! is not accurate enough.

use signorini::qp::{Condense, Error, Method, Precision, Prepared, Settings};
use signorini::{ContactProblem, Solution, solve};
use support::endings::best;
use support::problems::of_entries;
use support::random::springs;
use support::scenes::built_example;
use support::{cases, seed};

/// Two answers certified in double precision agree to this: rounding times the condition of the larger scenes.
const AGREEMENT: f64 = 1e-11;

fn with(method: Method, precision: Precision, accuracy: Option<f64>) -> Settings {
    let mut settings = Settings::with_method(method);
    (settings.precision, settings.accuracy) = (precision, accuracy);
    settings
}

fn energy(problem: &ContactProblem, u: &[f64]) -> f64 {
    u.iter().zip(problem.stiffness().mul(u)).map(|(u, force)| u * force).sum::<f64>().max(0.0).sqrt()
}

fn error(problem: &ContactProblem, found: &Solution, exact: &Solution) -> f64 {
    let away: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(u, v)| u - v).collect();
    energy(problem, &away) / energy(problem, &found.displacement)
}

#[test]
fn refined_answers_are_those_of_double_precision() {
    let mut refined = 0;
    for name in support::program::examples() {
        let model = built_example(&name);
        let problem = model.problem();
        for method in [Method::qp(), Method::ActiveSet] {
            let exact = solve(problem, &with(method, Precision::Double, None)).unwrap();
            assert!(!exact.single_precision && exact.refinements == 0);
            let found = solve(problem, &with(method, Precision::Mixed, None)).unwrap();
            assert!(found.certificate.meets(1e-9), "{name}");
            assert_eq!(found.contact_set, exact.contact_set, "{name}");
            assert!(error(problem, &found, &exact) <= AGREEMENT, "{name}, {}", error(problem, &found, &exact));
            refined += usize::from(found.single_precision);
        }
    }
    assert!(refined >= 8);
}

#[test]
fn a_requested_accuracy_is_reached_with_few_refinement_steps() {
    let model = built_example("indentation");
    let problem = model.problem();
    let exact = solve(problem, &with(Method::ActiveSet, Precision::Double, None)).unwrap();
    let mut steps = 0;
    for accuracy in [1e-2, 1e-6, 1e-10, 1e-13] {
        let found = solve(problem, &with(Method::ActiveSet, Precision::Mixed, Some(accuracy))).unwrap();
        let bound = found.certificate.energy_error_bound;
        assert!(bound <= accuracy);
        assert!(error(problem, &found, &exact) <= bound + 2.0 * exact.certificate.energy_error_bound);
        assert!(found.single_precision && found.refinements >= steps);
        steps = found.refinements;
    }
    assert!((2..=6).contains(&steps), "{steps}");
}

/// The widened bound holds even if the condition of the problem makes the measured contraction vary.
#[test]
fn the_bound_holds_for_a_factor_in_single_precision() {
    let (first, count) = (seed(0), cases(100, 1000));
    let (mut answers, mut worst) = (0, 0.0_f64);
    for seed in first..first + count {
        let problem = springs(seed);
        let exact = solve(&problem, &with(Method::ActiveSet, Precision::Double, None)).unwrap();
        for accuracy in [1e-2, 1e-8] {
            let found = solve(&problem, &with(Method::ActiveSet, Precision::Mixed, Some(accuracy))).unwrap();
            if !found.single_precision {
                continue;
            }
            answers += 1;
            let (error, bound) = (error(&problem, &found, &exact), found.certificate.energy_error_bound);
            assert!(error <= bound * (1.0 + 1e-6) + 1e-12, "seed {seed}: error {error:e}, bound {bound:e}");
            if error > 1e-12 {
                worst = worst.max(bound / error);
            }
        }
    }
    println!("{answers} answers, bound over error at most {worst:.3}");
    assert!(10 * answers > count);
    assert!(worst < 10.0);
}

#[test]
fn the_factor_takes_half_the_memory() {
    let model = built_example("two_cylinders");
    let bytes = |precision| {
        let prepared = Prepared::new(model.problem(), &with(Method::ActiveSet, precision, None)).unwrap();
        assert_eq!(prepared.is_single(), precision == Precision::Mixed);
        prepared.factor_bytes()
    };
    assert_eq!(2 * bytes(Precision::Mixed), bytes(Precision::Double));
}

/// A chain of springs, held at one end, with a wall at the other: its condition number is the square of its length.
fn chain(dofs: usize, soft: f64) -> ContactProblem {
    let mut entries = Vec::new();
    for dof in 0..dofs {
        let (before, after) = (if dof == 0 { 1.0 } else { soft }, if dof + 1 == dofs { 0.0 } else { soft });
        entries.push((dof, dof, before + after));
        if dof > 0 {
            entries.push((dof, dof - 1, -soft));
        }
    }
    let mut load = vec![0.0; dofs];
    load[dofs - 1] = 1.0;
    of_entries(&entries, load, &[(0, dofs - 1, 1.0)], vec![0.5])
}

#[test]
fn an_ill_conditioned_stiffness_is_factorised_in_double_precision() {
    let answer = |problem: &ContactProblem, precision| best(solve(problem, &with(Method::ActiveSet, precision, None)));
    for problem in [chain(20_000, 1.0), chain(50, 1e6), chain(50, 1e9)] {
        let found = answer(&problem, Precision::Mixed);
        assert!(found.certificate.meets(1e-9), "{:?}", found.certificate);
        // This is the answer of double precision, bit by bit.
        let double = answer(&problem, Precision::Double);
        assert_eq!((found.displacement, found.multiplier), (double.displacement, double.multiplier));
    }
    // A prepared problem keeps its single-precision factor, and reports if it is not accurate enough.
    let settings = with(Method::ActiveSet, Precision::Mixed, None);
    let problem = chain(2_000, 1.0);
    let prepared = Prepared::new(&problem, &settings).unwrap();
    if prepared.is_single() {
        match prepared.solve(problem.gap()) {
            Err(Error::Numerical { reason, .. }) => assert!(reason.contains("double precision"), "{reason}"),
            Ok(solution) => assert!(solution.certificate.meets(1e-9)),
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn problems_on_all_dofs_and_bodies_held_by_contact_are_factorised_in_double_precision() {
    for (name, condense) in [("indentation", Condense::Never), ("block", Condense::Auto)] {
        let model = built_example(name);
        let mut settings = with(Method::ActiveSet, Precision::Mixed, None);
        settings.condense = condense;
        let found = solve(model.problem(), &settings).unwrap();
        assert!(!found.single_precision);
        assert!(found.certificate.meets(1e-9));
    }
}

#[test]
fn answers_for_next_gaps_and_loads_are_refined() {
    let model = built_example("indentation");
    let problem = model.problem();
    let settings = with(Method::ActiveSet, Precision::Mixed, None);
    let prepared = Prepared::new(problem, &settings).unwrap();
    let gap: Vec<f64> = problem.gap().iter().map(|gap| gap - 0.01).collect();
    let load: Vec<f64> = (0..problem.dofs()).map(|dof| (dof % 7) as f64 - 3.0).collect();
    let cases = [
        (problem.with_gap(gap.clone()).unwrap(), prepared.solve(&gap).unwrap()),
        (problem.with_load(load.clone()).unwrap(), prepared.solve_load(load).unwrap()),
    ];
    for (problem, found) in cases {
        let exact = solve(&problem, &with(Method::ActiveSet, Precision::Double, None)).unwrap();
        assert!(error(&problem, &found, &exact) <= AGREEMENT);
        assert_eq!(found.contact_set, exact.contact_set);
    }
    let boundary = prepared.boundary(&gap).unwrap();
    assert!(boundary.condensed_certificate.meets(1e-9));
    // The exact path needs the exact compliance.
    assert!(matches!(prepared.path(problem.gap(), problem.gap()), Err(Error::NotCondensed { .. })));
}
