//! Invalid motions are refused before the first step, or at the step whose values overflow.

use signorini::motion::{DynamicProblem, Integrator, Scheme, TimeFunction};
use signorini::{ContactProblem, Settings, SparseMatrix, SymmetricMatrix, qp::Error};

fn symmetric(dofs: usize, entries: &[(usize, usize, f64)]) -> SymmetricMatrix {
    SparseMatrix::from_triplets(dofs, dofs, entries).and_then(SymmetricMatrix::from_lower).unwrap()
}

/// Two masses on springs, the second in front of a wall at distance 1.
fn contact() -> ContactProblem {
    let row = SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)]).unwrap();
    let stiffness = symmetric(2, &[(0, 0, 3.0), (1, 0, -1.0), (1, 1, 1.0)]);
    ContactProblem::new(stiffness, vec![0.0, 0.0], row, vec![1.0]).unwrap()
}

fn with_mass(entries: &[(usize, usize, f64)]) -> DynamicProblem {
    DynamicProblem::new(contact(), symmetric(2, entries)).unwrap()
}

const LUMPED: [(usize, usize, f64); 2] = [(0, 0, 1.0), (1, 1, 1.0)];
const EXPLICIT: Scheme = Scheme::CentralDifference { restitution: 0.0 };

#[track_caller]
fn refused<T>(result: Result<T, Error>, code: &str, phrases: &[&str]) {
    let error = result.map(drop).unwrap_err();
    assert_eq!(error.code(), code, "{error}");
    phrases.iter().for_each(|phrase| assert!(error.to_string().contains(phrase), "{phrase}: {error}"));
}

fn integrator(problem: DynamicProblem, scheme: Scheme, step: f64) -> Result<Integrator, Error> {
    Integrator::new(problem, scheme, step, &Settings::default())
}

#[test]
fn masses_and_initial_states_of_wrong_size_or_sign_are_refused() {
    refused(DynamicProblem::new(contact(), symmetric(1, &[(0, 0, 1.0)])), "shape", &["mass is 1 x 1", "2 x 2"]);
    let negative = symmetric(2, &[(0, 0, 1.0), (1, 1, -2.0)]);
    refused(DynamicProblem::new(contact(), negative), "setting", &["diagonal entry of the mass is -2"]);
    let problem = || with_mass(&LUMPED);
    refused(problem().starting_from(vec![0.0], vec![0.0; 2]), "length", &["initial displacement", "1", "2 dofs"]);
    refused(problem().starting_from(vec![0.0; 2], vec![0.0; 3]), "length", &["initial velocity", "3", "2 dofs"]);
    refused(problem().starting_from(vec![0.0; 2], vec![0.0, f64::NAN]), "not-finite", &["velocity", "NaN at entry 1"]);
    refused(problem().with_damping(f64::NAN, 0.0), "setting", &["mass damping is NaN"]);
    refused(problem().with_load(TimeFunction::Ramp { start: 0.0, end: 1.0 }, vec![1.0]), "length", &["load vector"]);
}

#[test]
fn steps_and_schemes_that_the_motion_does_not_allow_are_refused() {
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(integrator(with_mass(&LUMPED), Scheme::Midpoint, step), "setting", &["step is", "positive and finite"]);
    }
    let inside = with_mass(&LUMPED).starting_from(vec![0.0, 1.25], vec![0.0; 2]).unwrap();
    refused(integrator(inside, Scheme::Midpoint, 0.1), "setting", &["initial penetration is 0.25"]);
    let massless = [(0, 0, 1.0)];
    refused(integrator(with_mass(&massless), Scheme::Trapezoidal, 0.1), "setting", &["mass of a dof", "midpoint rule"]);
    assert!(integrator(with_mass(&massless), Scheme::Midpoint, 0.1).is_ok());
    refused(with_mass(&massless).stable_step(), "setting", &["mass of a dof is 0", "explicit"]);
    let consistent = [(0, 0, 1.0), (1, 0, 0.25), (1, 1, 1.0)];
    refused(with_mass(&consistent).stable_step(), "setting", &["beside its diagonal is 0.25", "lumped"]);
    let most = with_mass(&LUMPED).stable_step().unwrap();
    assert!(integrator(with_mass(&LUMPED), EXPLICIT, most).is_ok());
    refused(integrator(with_mass(&LUMPED), EXPLICIT, 1.01 * most), "numerical", &["beyond the largest stable one"]);
}

/// GOAL: the bound of the stable step, without and with damping.
/// CONDITIONS: two masses on springs of stiffness 2 and 1.
/// REFERENCE: 2 (sqrt(xi^2 + 1) - xi)/omega with the larger frequency omega^2 = 2 + sqrt(2) and its damping ratio xi.
#[test]
fn the_stable_step_of_two_masses_follows_from_their_larger_frequency_and_falls_with_damping() {
    // det(K - omega^2) = (3 - w)(1 - w) - 1: w = 2 +- sqrt(2). The bound uses the magnitudes of K, which have the same
    // largest eigenvalue.
    let omega = (2.0 + 2.0_f64.sqrt()).sqrt();
    let free = with_mass(&LUMPED).stable_step().unwrap();
    assert!((free * omega / 2.0 - 1.0).abs() < 1e-6, "{free}");
    let damped = with_mass(&LUMPED).with_damping(0.4, 0.1).unwrap().stable_step().unwrap();
    let xi = 0.4 / (2.0 * omega) + 0.1 * omega / 2.0;
    assert!((damped / free - (xi.hypot(1.0) - xi)).abs() < 1e-6, "{damped}");
}

#[test]
fn a_motion_that_overflows_double_precision_is_an_error_at_its_step() {
    // A mass flies away on a spring of almost no stiffness: 5e307 after the first step of 1, beyond double precision
    // after the fourth.
    let no_rows = SparseMatrix::from_triplets(0, 1, &[]).unwrap();
    let contact = ContactProblem::new(symmetric(1, &[(0, 0, 1e-300)]), vec![0.0], no_rows, vec![]).unwrap();
    let problem = DynamicProblem::new(contact, symmetric(1, &[(0, 0, 1.0)])).unwrap();
    let problem = problem.starting_from(vec![0.0], vec![5e307]).unwrap();
    let mut flight = integrator(problem, Scheme::CentralDifference { restitution: 0.0 }, 1.0).unwrap();
    for _ in 0..3 {
        flight.advance().unwrap();
    }
    refused(flight.advance().map(drop), "numerical", &["the motion has the value inf after step 4"]);
    // The last valid state is kept.
    assert_eq!((flight.state().displacement[0], flight.state().steps), (1.5e308, 3));
}

#[test]
fn the_state_of_another_problem_is_not_resumed() {
    let mut one = integrator(with_mass(&LUMPED), Scheme::Midpoint, 0.1).unwrap();
    assert_eq!((one.step(), one.time(), one.problem().statics().dofs()), (0.1, 0.0, 2));
    let mut state = one.state().clone();
    state.velocity.pop();
    refused(one.resume(state), "length", &["velocity has length 1", "2 dofs"]);
    let mut state = one.state().clone();
    state.kept = vec![0.0; 3];
    refused(one.resume(state), "length", &["kept energy has length 3"]);
}

#[test]
fn factors_over_time_have_the_described_values() {
    let table = TimeFunction::Table(vec![(1.0, 2.0), (3.0, -2.0)]);
    let sine = TimeFunction::Sine { frequency: 0.25, phase: 0.0 };
    let ramp = TimeFunction::Ramp { start: 1.0, end: 3.0 };
    let pulse = TimeFunction::Pulse { start: 1.0, end: 3.0 };
    for (factor, expected) in [
        (table, [2.0, 2.0, 1.0, 0.0, -2.0, -2.0]),
        (sine, [0.0, 1.0, 0.5_f64.sqrt(), 0.0, -1.0, 0.0]),
        (ramp, [0.0, 0.0, 0.25, 0.5, 1.0, 1.0]),
        (pulse, [0.0, 0.0, 0.5_f64.sqrt(), 1.0, 0.0, 0.0]),
    ] {
        factor.check().unwrap();
        for (t, value) in [0.0, 1.0, 1.5, 2.0, 3.0, 4.0].into_iter().zip(expected) {
            assert!((factor.at(t) - value).abs() < 1e-15, "{factor:?} at {t}: {}", factor.at(t));
        }
    }
    assert_eq!(TimeFunction::Table(Vec::new()).at(1.0), 1.0);
}

#[test]
fn invalid_factors_over_time_are_refused() {
    let table = |points: &[(f64, f64)]| TimeFunction::Table(points.to_vec());
    for (factor, phrase) in [
        (table(&[]), "number of times is 0"),
        (table(&[(0.0, 1.0), (0.0, 2.0)]), "time of a table is 0"),
        (table(&[(f64::NAN, 1.0)]), "time of a table is NaN"),
        (table(&[(0.0, f64::INFINITY)]), "factor of a table is inf"),
        (TimeFunction::Sine { frequency: 0.0, phase: 0.0 }, "frequency is 0"),
        (TimeFunction::Sine { frequency: 1.0, phase: f64::NAN }, "phase is NaN"),
        (TimeFunction::Ramp { start: f64::NAN, end: 1.0 }, "start is NaN"),
        (TimeFunction::Pulse { start: 1.0, end: 1.0 }, "end is 1"),
    ] {
        refused(factor.check(), "setting", &[phrase]);
    }
}
