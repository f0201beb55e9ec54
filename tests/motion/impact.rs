//! GOAL: bars in impact move in agreement with the closed forms, and every scheme behaves as described.
//!
//! CONDITIONS: a free bar that flies against a wall, and a held bar that bounces on it with the period 3; 50 to 400
//! cells.
//!
//! REFERENCE: waves in bars (`closed_forms::ImpactingBar`, `closed_forms::BouncingBar`).

use signorini::motion::{DynamicProblem, Integrator, Scheme, SchemeSpec, TimeFunction};
use signorini::{ContactProblem, Scene, Settings, SparseMatrix, SymmetricMatrix, qp};
use support::impact::cases::cases;
use support::impact::measure::run;

/// Accuracy of the midpoint rule at a Courant number of 0.5, on 100 cells.
const ENERGY: f64 = 1e-3;
const PRESSURE: f64 = 5e-3;
const REBOUND: f64 = 1e-2;
const PENETRATION: f64 = 1e-10;

#[test]
fn the_midpoint_rule_has_exact_energy_pressure_and_rebound_without_penetration() {
    for case in &cases() {
        for courant in [0.5, 1.0, 1.5] {
            let run = run(case, SchemeSpec::Midpoint, courant, 100).unwrap();
            for energy in run.energy {
                assert!((energy - 1.0).abs() <= ENERGY, "{}, {courant}: energy {energy}", case.name);
            }
            assert!((run.pressure[0] / case.pressure - 1.0).abs() <= PRESSURE, "{}: {:?}", case.name, run.pressure);
            assert!(run.penetration <= PENETRATION, "{}: penetration {}", case.name, run.penetration);
            if let Some(speed) = case.rebound.filter(|_| courant == 0.5) {
                assert!((run.rebound / speed - 1.0).abs() <= REBOUND, "rebound {}", run.rebound);
                assert!(run.pressure[1] <= 1e-2 * case.pressure, "the pressure oscillates: {}", run.pressure[1]);
            }
        }
    }
}

#[test]
fn the_displacement_error_of_the_midpoint_rule_falls_with_cell_and_step() {
    // The velocity jumps at the wave fronts: there, the error of a scheme of second order falls with the power 2/3.
    for case in &cases() {
        let error = |cells| run(case, SchemeSpec::Midpoint, 1.0, cells).unwrap().displacement_error;
        let rate = (error(50) / error(400)).log2() / 3.0;
        assert!((0.6..0.8).contains(&rate), "{}: rate {rate}", case.name);
    }
}

#[test]
fn contact_stabilised_steps_never_gain_energy() {
    for case in &cases() {
        for courant in [0.5, 1.0, 1.5] {
            let run = run(case, SchemeSpec::ContactStabilised, courant, 100).unwrap();
            let [end, most] = run.energy;
            assert!(most <= 1.0 + 1e-12 && (0.98..1.0).contains(&end), "{}, {courant}: {:?}", case.name, run.energy);
        }
    }
}

#[test]
fn the_schemes_that_warn_of_energy_growth_gain_energy() {
    let case = &cases()[0];
    for (scheme, least) in [(SchemeSpec::Trapezoidal, 10.0), (SchemeSpec::Hht, 1.1), (SchemeSpec::Penalty, 1.2)] {
        let run = run(case, scheme, 0.5, 100).unwrap();
        assert!(run.scheme.gains_energy() && run.energy[1] > least, "{scheme:?}: {:?}", run.energy);
    }
    let kept = [
        Scheme::FoxGoodwin,
        Scheme::Midpoint,
        Scheme::ContactStabilised,
        Scheme::CentralDifference { restitution: 0.0 },
    ];
    for scheme in kept {
        assert!(!scheme.gains_energy());
    }
}

#[test]
fn central_differences_have_the_exact_pressure_and_no_penetration() {
    for case in &cases() {
        let run = run(case, SchemeSpec::CentralDifference, 0.9, 100).unwrap();
        assert!((run.pressure[0] / case.pressure - 1.0).abs() <= PRESSURE && run.penetration <= PENETRATION);
        assert!((0.98..1.0 + ENERGY).contains(&run.energy[0]), "{:?}", run.energy);
    }
}

#[test]
fn the_stable_step_of_a_bar_is_the_time_of_a_wave_through_a_cell() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/studies/impact/bar.json")).unwrap();
    let text = text.replace("\"dynamic\": {", "\"dynamic\": {\"scheme\": \"central-difference\",");
    let scene = Scene::from_json(&text, "scene").unwrap();
    let dynamics = scene.dynamics(&scene.build().unwrap()).unwrap().unwrap();
    assert!((dynamics.problem.stable_step().unwrap() * 300.0 - 1.0).abs() < 1e-10);
}

#[test]
fn invalid_steps_and_steps_beyond_the_stable_one_are_refused() {
    let settings = Settings::default();
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let refused = Integrator::new(oscillator(0.0), Scheme::Midpoint, step, &settings).err().unwrap();
        assert!(matches!(refused, qp::Error::Linear(qp::LinearError::Setting { name: "step", .. })), "{refused}");
    }
    // The angular frequency is 2, so that steps up to 2/2 are stable.
    let explicit = Scheme::CentralDifference { restitution: 0.0 };
    assert!(Integrator::new(oscillator(0.0), explicit, 1.0, &settings).is_ok());
    let refused = Integrator::new(oscillator(0.0), explicit, 1.01, &settings).err().unwrap();
    assert!(refused.to_string().contains("beyond the largest stable one, 1e0"), "{refused}");
}

/// One mass of 1 on a spring of stiffness 4: its angular frequency is 2.
fn oscillator(load: f64) -> DynamicProblem {
    let one =
        |value| SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]).unwrap()).unwrap();
    let no_rows = SparseMatrix::from_triplets(0, 1, &[]).unwrap();
    DynamicProblem::new(ContactProblem::new(one(4.0), vec![load], no_rows, vec![]).unwrap(), one(1.0)).unwrap()
}

fn displacement_at(problem: DynamicProblem, scheme: Scheme, time: f64, steps: usize) -> f64 {
    let mut integrator = Integrator::new(problem, scheme, time / steps as f64, &Settings::default()).unwrap();
    for _ in 0..steps {
        integrator.advance().unwrap();
    }
    integrator.state().displacement[0]
}

#[test]
fn every_scheme_is_of_second_order_without_contact() {
    // A damped oscillator, x'' + 2 zeta omega x' + omega^2 x = 0 from (1, 0); zeta contains both parts of the damping.
    let (omega, [mass, stiffness]) = (2.0, [0.3, 0.05]);
    let zeta: f64 = (mass / omega + stiffness * omega) / 2.0;
    let (damped, t) = (omega * (1.0 - zeta * zeta).sqrt(), 3.0);
    let exact = (-zeta * omega * t).exp() * ((damped * t).cos() + zeta * omega / damped * (damped * t).sin());
    for scheme in [
        Scheme::FoxGoodwin,
        Scheme::Midpoint,
        Scheme::Trapezoidal,
        Scheme::ContactStabilised,
        Scheme::Hht { alpha: -0.1 },
        Scheme::Penalty { penalty: 10.0 },
        Scheme::PenaltyLoop { threshold: 1e-6 },
    ] {
        let error = |steps| {
            let problem = oscillator(0.0).with_damping(mass, stiffness).unwrap();
            let problem = problem.starting_from(vec![1.0], vec![0.0]).unwrap();
            (displacement_at(problem, scheme, t, steps) - exact).abs()
        };
        let rate = (error(100) / error(400)).log2() / 2.0;
        assert!((rate - 2.0).abs() < 0.1, "{scheme:?}: {rate}");
    }
    // Central differences use the damping force of the last half step; without damping they are of second order as
    // well.
    let error = |steps| {
        let problem = oscillator(0.0).starting_from(vec![1.0], vec![0.0]).unwrap();
        (displacement_at(problem, Scheme::CentralDifference { restitution: 0.0 }, t, steps) - (omega * t).cos()).abs()
    };
    assert!(((error(100) / error(400)).log2() / 2.0 - 2.0).abs() < 0.1);
}

/// GOAL: an oscillator of one dof under a harmonic load.
/// CONDITIONS: x'' + 4 x = sin t from rest, by the midpoint rule.
/// REFERENCE: x = sin(t)/3 - sin(2 t)/6.
#[test]
fn a_time_dependent_load_moves_an_oscillator_as_in_the_closed_form() {
    // x'' + 4 x = sin t from rest: x = sin(t)/3 - sin(2 t)/6.
    let factor = TimeFunction::Sine { frequency: 0.5 / std::f64::consts::PI, phase: 0.0 };
    let problem = oscillator(0.0).with_load(factor, vec![1.0]).unwrap();
    let t = 2.0_f64;
    let exact = t.sin() / 3.0 - (2.0 * t).sin() / 6.0;
    assert!((displacement_at(problem, Scheme::Midpoint, t, 2000) - exact).abs() < 1e-6);
}

#[test]
fn a_run_that_is_resumed_goes_on_bit_for_bit() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/studies/impact/bar.json");
    let scene = Scene::read(path).unwrap();
    let dynamics = scene.dynamics(&scene.build().unwrap()).unwrap().unwrap();
    let new =
        || Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, &Settings::default()).unwrap();
    let (mut whole, mut second) = (new(), new());
    // The bar touches the wall from step 150 to step 350.
    for _ in 0..225 {
        whole.advance().unwrap();
    }
    second.resume(whole.state().clone()).unwrap();
    for _ in 0..200 {
        whole.advance().unwrap();
        second.advance().unwrap();
    }
    assert_eq!(whole.state(), second.state());
}

#[test]
fn a_motion_goes_on_with_the_forces_of_the_displacement_and_velocity_of_its_state() {
    let mut integrator = Integrator::new(oscillator(0.0), Scheme::Midpoint, 0.1, &Settings::default()).unwrap();
    // A state from a file, with an elastic force and a momentum of another displacement and velocity.
    let mut state = serde_json::to_value(integrator.state()).unwrap();
    for (field, value) in [("displacement", 0.5), ("velocity", 3.0), ("elastic", 7.0), ("momentum", -7.0)] {
        state[field] = serde_json::json!([value]);
    }
    integrator.resume(serde_json::from_value(state).unwrap()).unwrap();
    let seen = integrator.observe();
    // 4 x 0.5^2 / 2 and 1 x 3^2 / 2.
    assert_eq!((seen.strain, seen.kinetic), (0.5, 4.5));
    // The midpoint rule preserves the energy from there on.
    integrator.advance().unwrap();
    assert!((integrator.observe().energy() - 5.0).abs() < 1e-14);
}

/// GOAL: a mass that bounces off a wall with a restitution.
/// CONDITIONS: a free mass of 1 flies with speed 1; central differences with a restitution of 0.5.
/// REFERENCE: Newton's law of impact: the speed -0.5 afterwards.
#[test]
fn a_mass_bounces_off_a_wall_with_the_given_restitution() {
    // A free mass of 1 flies with speed 1 towards a wall; central differences return it with half its speed.
    let rows = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap();
    let one =
        |value| SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]).unwrap()).unwrap();
    let contact = ContactProblem::new(one(0.0), vec![0.0], rows, vec![1.0]).unwrap();
    let problem = DynamicProblem::new(contact, one(1.0)).unwrap().starting_from(vec![0.0], vec![1.0]).unwrap();
    let scheme = Scheme::CentralDifference { restitution: 0.5 };
    let mut integrator = Integrator::new(problem, scheme, 0.3, &Settings::default()).unwrap();
    for _ in 0..10 {
        integrator.advance().unwrap();
    }
    assert!((integrator.state().velocity[0] + 0.5).abs() < 1e-14);
}
