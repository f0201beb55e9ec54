//! GOAL: bodies that are thrown or dropped hit the wall and bounce back in agreement with the waves in them.
//!
//! CONDITIONS: a block with lateral supports that is thrown at a wall; a bar that is dropped onto it.
//!
//! REFERENCE: `closed_forms::ImpactingBar`, in a block with the modulus of its lateral supports; a falling bar, whose
//! contact is the sum of the impact wave and of the wave of a weight that is applied at once (K. F. Graff, *Wave Motion
//! in Elastic Solids*, Oxford, 1975, section 2.4).

use serde_json::{Value, json};
use signorini::motion::{Integrator, Observation};
use signorini::{Scene, Settings};
use support::closed_forms::ImpactingBar;

/// Accuracy of the default scheme at its default step, a Courant number of 0.5, on 100 cells along the wave.
const ENERGY: f64 = 2e-3;

/// Energy that the contact of a bar of 50 cells takes, most of it for as long as it lasts.
const TAKEN: f64 = 2.5e-2;
const PRESSURE: f64 = 5e-3;
const SPREAD: f64 = 1e-2;
const REBOUND: f64 = 1e-2;
const PENETRATION: f64 = 1e-10;

/// A wave front is some cells wide when it returns: contact ends earlier or later by this share.
const CONTACT_TIME: f64 = 1e-2;

/// Gravity times length, divided by wave speed and by speed at the wall: the share of the time of flight that contact
/// takes.
const SOFTNESS: f64 = 0.05;

/// Error of the time at which a vibrating bar hits the wall, relative to its flight: its end vibrates by 2 `SOFTNESS` v
/// L/c, and the vibration changes the speed of the centre of mass at each contact.
const FLIGHT: f64 = 1e-2;

/// Largest change of energy by a flat impact: each of the few steps in which contact begins or ends has an error below
/// 1e-5.
const BLOW: f64 = 1e-4;

/// Energy that the contact keeps while it lasts, on 100 cells: up to one and a half times that of the contact node.
/// Rounding of a change.
const STOPPED: f64 = 0.0076;
const ROUNDING: f64 = 1e-10;

/// Observations of a body after each step.
struct Seen {
    step: f64,
    all: Vec<Observation>,
    /// Displacement and velocity of the centre of mass along the first axis.
    centre: Vec<[f64; 2]>,
}

fn motion(scene: &Value) -> Seen {
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    let model = scene.build().unwrap();
    let dynamics = scene.dynamics(&model).unwrap().unwrap();
    let mut integrator =
        Integrator::new(dynamics.problem, dynamics.scheme, dynamics.step, &Settings::default()).unwrap();
    let dimension = model.mesh().dimension();
    let along =
        (0..model.mesh().nodes().len() * dimension).map(|dof| f64::from(dof % dimension == 0)).collect::<Vec<_>>();
    let inertia = integrator.problem().mass().mul(&model.dofs().restrict(&along).unwrap());
    let mass: f64 = inertia.iter().zip(model.dofs().restrict(&along).unwrap()).map(|(m, x)| m * x).sum();
    let mean = |values: &[f64]| inertia.iter().zip(values).map(|(m, value)| m * value).sum::<f64>() / mass;
    let (mut all, mut centre) = (vec![integrator.observe()], Vec::new());
    for _ in 0..=dynamics.steps {
        let state = integrator.state();
        centre.push([mean(&state.displacement), mean(&state.velocity)]);
        integrator.advance().unwrap();
        all.push(integrator.observe());
    }
    all.pop();
    Seen { step: dynamics.step, all, centre }
}

/// A block of 100 x 2 cells that flies along x against a wall; its sides are free or on rollers.
fn block(poisson: f64, rollers: bool, wall: f64, duration: f64) -> Value {
    let side = |name: &str| json!({"on": {"boundary": name}, "y": 0});
    json!({
        "model": "plane-strain",
        "body": {"rectangle": {
            "x": {"points": [0, 10], "divisions": [100]}, "y": {"points": [0, 1], "divisions": [2]}}},
        "material": {"young": 900, "poisson": poisson, "density": 1},
        "supports": if rollers { vec![side("bottom"), side("top")] } else { vec![] },
        "obstacles": [
            {"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [wall, 0], "normal": [1, 0]}}}],
        "analysis": {"dynamic": {"duration": duration, "initial": [{"velocity": {"value": [10, 0]}}]}}
    })
}

#[test]
fn a_block_in_plane_strain_has_the_impact_of_a_bar_of_its_modulus() {
    for (poisson, rollers) in [(0.0, false), (0.3, true)] {
        let modulus = 900.0 * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let bar = ImpactingBar { length: 10.0, axial_stiffness: modulus, line_density: 1.0, speed: 10.0, gap: 1.0 };
        let [begin, end] = bar.contact();
        let seen = motion(&block(poisson, rollers, 11.0, end + 0.1));
        let margin = 0.1 * (end - begin);
        let inside = |seen: &&Observation| (begin + margin..end - margin).contains(&seen.time);
        let forces: Vec<f64> = seen.all.iter().filter(inside).map(|seen| seen.force).collect();
        let mean = forces.iter().sum::<f64>() / forces.len() as f64;
        let contact = seen.all.iter().filter(|seen| seen.force > 0.0).count() as f64 * seen.step;
        let impulse: f64 = seen.all.iter().map(|seen_at| seen_at.force * seen.step).sum();
        let (first, last) = (seen.all[0], seen.all[seen.all.len() - 1]);
        let speed = -seen.centre[seen.centre.len() - 1][1];
        eprintln!(
            "nu {poisson}: {mean} {contact} {impulse} {speed} {} ; {} {} {}",
            last.energy() / first.energy(),
            bar.force(),
            end - begin,
            bar.impulse()
        );
        assert!((mean / bar.force() - 1.0).abs() <= PRESSURE, "{mean}");
        let spread = (forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / forces.len() as f64).sqrt();
        assert!(spread <= SPREAD * mean, "the pressure oscillates: {spread} of {mean}");
        assert!((contact / (end - begin) - 1.0).abs() <= CONTACT_TIME, "{contact}");
        assert!((impulse / bar.impulse() - 1.0).abs() <= REBOUND / 2.0, "{impulse}");
        assert!((speed / bar.speed - 1.0).abs() <= REBOUND, "{speed}");
        assert!((last.energy() / first.energy() - 1.0).abs() <= ENERGY, "{}", last.energy());
        assert!(seen.all.iter().all(|seen| seen.penetration <= PENETRATION));
    }
}

#[test]
fn a_dropped_bar_bounces_in_agreement_with_waves_and_gravity() {
    // Length, modulus and density are 1, so that a wave takes the time 1; the bar hits the wall, 10 v below,
    // with v = 0.1.
    let (speed, gravity) = (0.1, 0.1 * SOFTNESS);
    let height = speed * speed / (2.0 * gravity);
    let (fall, contact) = (speed / gravity, 2.0);
    let period = 2.0 * fall + contact;
    let seen = motion(&json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 1], "divisions": [50]}}},
        "material": {"young": 1, "poisson": 0, "density": 1},
        "loads": [{"body-force": [-gravity]}],
        "obstacles": [
            {"boundary": "left", "approach": "-x", "shape": {"plane": {"point": [-height], "normal": [-1]}}}],
        "analysis": {"dynamic": {"duration": fall + 3.0 * period + 10.0, "initial": []}}
    }));
    // A contact is a sequence of steps with a force; an interruption shorter than three times that of a wave belongs to
    // it.
    let mut contacts: Vec<[f64; 3]> = Vec::new();
    for at in seen.all.iter().filter(|at| at.force > 0.0) {
        let middle = at.time - seen.step / 2.0;
        match contacts.last_mut() {
            Some([_, end, impulse]) if middle - *end < 3.0 => {
                (*end, *impulse) = (middle, *impulse + at.force * seen.step)
            }
            _ => contacts.push([middle, middle, at.force * seen.step]),
        }
    }
    assert_eq!(contacts.len(), 4);
    let [begin, end, impulse] = contacts[0];
    assert!((begin - fall).abs() <= seen.step, "{begin}");
    // The first and the last step with a force.
    assert!((end - begin - contact).abs() <= CONTACT_TIME * contact + 2.0 * seen.step, "{}", end - begin);
    // The centre of mass departs with the speed of its arrival, lower by twice the static compression under the weight.
    assert!((impulse / (2.0 * speed + gravity * contact) - 1.0).abs() <= REBOUND / 2.0, "{impulse}");
    let left = ((fall + contact) / seen.step).round() as usize + 20;
    let [place, velocity] = seen.centre[left];
    let later = left as f64 * seen.step - fall - contact;
    let exact = -height - 2.0 * gravity / 3.0 + speed * later - gravity * later * later / 2.0;
    assert!((velocity / (speed - gravity * later) - 1.0).abs() <= REBOUND, "{velocity}");
    assert!((place - exact).abs() <= 0.1 * gravity, "{place}, expected {exact}");
    for (number, [begin, ..]) in contacts.iter().enumerate() {
        let expected = fall + number as f64 * period;
        assert!(
            (begin - expected).abs() <= FLIGHT * number as f64 * period + seen.step,
            "{begin}, expected {expected}"
        );
    }
    // The change of energy over all contacts, relative to the energy of the fall.
    let start = seen.all[0].energy();
    let scale = speed * speed / 2.0;
    let most = seen.all.iter().map(|at| (at.energy() - start).abs() / scale).fold(0.0, f64::max);
    assert!(most <= TAKEN, "{most}");
    assert!(seen.all.iter().all(|at| at.penetration <= PENETRATION));
}

#[test]
fn a_flat_impact_keeps_its_energy_at_any_time_within_a_step() {
    for (scheme, courant) in [("midpoint", 0.5), ("midpoint", 1.0), ("midpoint", 1.5), ("fox-goodwin", 1.0)] {
        let step = courant * 0.1 / 30.0;
        for arrival in [0.0, 0.25, 0.5, 0.75] {
            let wall = 10.0 + (20.0 + arrival) * 10.0 * step;
            let seen = motion(&json!({
                "model": "bar",
                "body": {"bar": {"x": {"points": [0, 10], "divisions": [100]}}},
                "material": {"young": 900, "poisson": 0, "density": 1},
                "obstacles": [
                    {"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [wall], "normal": [1]}}}],
                "analysis": {"dynamic": {
                    "duration": 0.9, "scheme": scheme, "step": step, "initial": [{"velocity": {"value": [10]}}]}}
            }));
            let change = |at: &Observation| at.energy() / seen.all[0].energy() - 1.0;
            let [least, most] = [f64::min, f64::max].map(|which| seen.all.iter().map(change).fold(0.0, which));
            let allowed = if scheme == "midpoint" { [BLOW; 2] } else { [STOPPED, ROUNDING] };
            assert!(-least <= allowed[0] && most <= allowed[1], "{scheme}, {courant}, {arrival}: {least}, {most}");
            let last = change(&seen.all[seen.all.len() - 1]).abs();
            assert!(last <= allowed[1], "{scheme}, {courant}, {arrival}: {last}");
            // A corrected force is still a pressure, and its impulse equals the change of momentum of the bar.
            let impulse: f64 = seen.all.iter().map(|at| at.force * seen.step).sum();
            let momentum = 10.0 * (10.0 - seen.centre[seen.centre.len() - 1][1]);
            assert!(seen.all.iter().all(|at| at.force >= 0.0) && (impulse / momentum - 1.0).abs() < 1e-10);
        }
    }
}
