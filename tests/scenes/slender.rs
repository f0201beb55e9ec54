//! GOAL: slender bodies in bending are certified, for every element, mesh and method.
//!
//! CONDITIONS: a cantilever under a uniform load on a stop or on a floor, L/h from 10 to 1000; a quarter of a ring
//! between rigid plates, t/R from 0.1 to 0.01.
//!
//! REFERENCE: beam theory in closed form; the answers of four settings of the solver.

use signorini::{Condense, Method, Settings, Solution, qp, solve};
use std::f64::consts::PI;
use support::scenes::{build, built};

use serde_json::{Value, json};
use signorini::output::InWords;
use signorini::scene::{Answer, Units};
use signorini::study::Summary;

const PLANE: [&str; 4] = ["q4", "q8", "t3", "t6"];
const ALL: [&str; 5] = ["q4", "q8", "t3", "t6", "hex8"];
const SLENDERNESS: [f64; 4] = [10.0, 20.0, 50.0, 100.0];

/// Numbers of cells along the axis and through the thickness.
const MESHES: [(usize, usize); 2] = [(20, 1), (50, 3)];

/// Tolerance of every certificate.
const TOLERANCE: f64 = 1e-9;

/// Largest relative difference of the forces of the settings: the answers are certified to 1e-9 in energy, and single
/// forces have larger errors.
const AGREE: f64 = 1e-6;

/// Load per length of beam; all beams have E = 1, h = 1 and width 1, thus EI = 1/12.
const LOAD: f64 = 1e-9;
const BENDING: f64 = 1.0 / 12.0;

fn is_quadratic(element: &str) -> bool {
    matches!(element, "q8" | "t6")
}

/// The four settings of the solver for each scene.
fn ways() -> [Settings; 4] {
    let with = Settings::with_method;
    let mut never = Settings::default();
    never.condense = Condense::Never;
    [Settings::default(), never, with(Method::qp()), with(Method::ActiveSet)]
}

fn answer(scene: &Value, settings: &Settings) -> Result<Solution, qp::Error> {
    let model = build(scene).unwrap();
    solve(model.problem(), settings)
}

/// The contact force of a scene; asserts that all settings certify it with a bound on the error.
fn certified_force(name: &str, scene: &Value) -> f64 {
    let forces = ways().map(|settings| {
        let found = answer(scene, &settings).unwrap_or_else(|e| panic!("{name}, {:?}: {e}", settings.method));
        let certificate = &found.certificate;
        assert!(certificate.meets(TOLERANCE) && certificate.has_bound(), "{name}: {certificate:?}");
        assert!(
            certificate.energy_error_bound < 1e-7 && certificate.part_error_bound < 1e-7,
            "{name}: {certificate:?}"
        );
        assert_eq!(certificate.parts, 1, "{name}");
        found.contact_force()
    });
    assert!(forces[0] > 0.0, "{name}: no contact");
    for force in forces {
        assert!((force / forces[0] - 1.0).abs() < AGREE, "{name}: {forces:?}");
    }
    forces[0]
}

#[track_caller]
fn close(name: &str, force: f64, expected: f64, tolerance: f64) {
    assert!((force / expected - 1.0).abs() < tolerance, "{name}: {force:e} instead of {expected:e}");
}

/// A cantilever of length L; a floor at the distance `gap` below it stops the nodes of `boundary`.
fn cantilever(element: &str, length: f64, (along, through): (usize, usize), boundary: &str, gap: f64) -> Value {
    let axis = |end: f64, divisions: usize| json!({"points": [0, end], "divisions": [divisions]});
    let is_solid = element == "hex8";
    let (body, model, down, support) = if is_solid {
        let sides = json!({"x": axis(length, along), "y": axis(1.0, 1), "z": axis(1.0, through), "element": element});
        (json!({"box": sides}), "space", "-z", json!({"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}))
    } else {
        let sides = json!({"x": axis(length, along), "y": axis(1.0, through), "element": element});
        (json!({"rectangle": sides}), "plane-stress", "-y", json!({"on": {"boundary": "left"}, "x": 0, "y": 0}))
    };
    let vertical = |value: f64| if is_solid { json!([0, 0, value]) } else { json!([0, value]) };
    json!({
        "model": model, "body": body, "material": {"young": 1.0, "poisson": 0.0}, "supports": [support],
        "loads": [{"traction": {"boundary": "top", "value": vertical(-LOAD)}}],
        "obstacles": [{"boundary": boundary, "approach": down,
                       "shape": {"plane": {"point": vertical(-gap), "normal": vertical(-1.0)}}}],
    })
}

/// GOAL: a propped cantilever under a uniform load.
/// CONDITIONS: every element and mesh, L/h from 10 to 1000; the force does not depend on the bending stiffness, so that
/// locking has no effect.
/// REFERENCE: beam theory: the prop carries 3/8 of the load.
#[test]
fn a_cantilever_on_a_stop_is_certified_and_has_three_eighths_of_its_load_on_the_stop() {
    // Error by shear, at h/L = 0.1, and by twenty linear elements; the stop also carries the load of its node.
    const PROP: f64 = 0.04;
    for element in ALL {
        for length in SLENDERNESS {
            for mesh in MESHES {
                let name = format!("{element}, L/h = {length}, {mesh:?}");
                let force = certified_force(&name, &cantilever(element, length, mesh, "right", 0.0));
                close(&name, force, 3.0 / 8.0 * LOAD * length, PROP);
            }
        }
    }
}

/// Over a floor at the distance g the beam is free up to a, a^4 = 72 EI g / q, and its clamp carries 2/3 q a.
#[test]
fn a_cantilever_on_a_floor_is_certified_with_the_force_of_beam_theory() {
    // The point of first contact is between two of forty nodes.
    const FLOOR: f64 = 0.03;
    for element in ALL {
        for length in SLENDERNESS {
            let free = 0.6 * length;
            let gap = LOAD * free.powi(4) / (72.0 * BENDING);
            for mesh in [(40, 1), (80, 2)] {
                let name = format!("{element}, L/h = {length}, {mesh:?}");
                let force = certified_force(&name, &cantilever(element, length, mesh, "bottom", gap));
                let expected = LOAD * (length - 2.0 / 3.0 * free);
                if is_quadratic(element) {
                    close(&name, force, expected, FLOOR);
                } else {
                    // Linear elements lock: the beam is too stiff, and a longer part is free.
                    assert!(force < (1.0 + FLOOR) * expected, "{name}: {force:e}, beam theory {expected:e}");
                }
            }
        }
    }
}

/// A quarter of a ring of radius 1; its plane of symmetry is moved down by 0.01 onto a rigid plate.
fn ring(element: &str, thickness: f64, (around, through): (usize, usize)) -> Value {
    let radius = json!({"points": [1.0 - thickness / 2.0, 1.0 + thickness / 2.0], "divisions": [through]});
    let angle = json!({"points": [-90, 0], "divisions": [around]});
    json!({
        "model": "plane-stress", "body": {"ring": {"radius": radius, "angle": angle, "element": element}},
        "material": {"young": 1.0, "poisson": 0.0},
        "supports": [{"on": {"boundary": "start"}, "x": 0}, {"on": {"boundary": "end"}, "y": -0.01}],
        "obstacles": [{"boundary": "outer", "approach": "-y",
                       "shape": {"plane": {"point": [0, -1.0 - thickness / 2.0], "normal": [0, -1]}}}],
    })
}

/// Two opposite forces P shorten a thin ring by (pi/4 - 2/pi) P R^3 / EI.
#[test]
fn a_ring_between_plates_is_certified_with_the_stiffness_of_a_curved_beam() {
    // Error by the stretching and shear that curved beam theory omits at t/R = 0.1, and by twenty quadratic elements at
    // 0.01.
    const CURVED: f64 = 0.05;
    for element in PLANE {
        for thickness in [0.1, 0.05, 0.02, 0.01_f64] {
            for mesh in MESHES {
                let name = format!("{element}, t/R = {thickness}, {mesh:?}");
                let force = certified_force(&name, &ring(element, thickness, mesh));
                let expected = 0.01 * thickness.powi(3) / 12.0 / (PI / 4.0 - 2.0 / PI);
                if is_quadratic(element) {
                    close(&name, force, expected, CURVED);
                } else {
                    assert!(force > (1.0 - CURVED) * expected, "{name}: {force:e}, beam theory {expected:e}");
                }
            }
        }
    }
}

#[test]
fn a_clamped_body_a_thousand_times_as_long_as_thick_is_certified() {
    for element in ALL {
        for mesh in [(20, 1), (100, 2)] {
            for boundary in ["right", "bottom"] {
                let name = format!("{element}, {mesh:?}, {boundary}");
                let scene = cantilever(element, 1000.0, mesh, boundary, 0.0);
                let found = answer(&scene, &Settings::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
                assert!(found.certificate.meets(TOLERANCE), "{name}: {:?}", found.certificate);
            }
        }
    }
}

/// The softest motion of this beam has 1e-24 of the stiffness of its elements.
#[test]
fn a_stiffness_without_digits_is_reported_with_bending_as_the_reason() {
    let error = answer(&cantilever("q4", 1e7, (1000, 1), "right", 0.0), &Settings::default());
    let text = error.as_ref().map_or_else(|error| error.to_string(), |found| format!("{:?}", found.certificate));
    assert!(matches!(error, Err(qp::Error::NotCertified { .. })), "{text}");
    assert!(text.contains("the stiffness has lost digits to rounding (smallest pivot"), "{text}");
    assert!(text.contains("bending") && text.contains("fewer elements along the thickness"), "{text}");
}

/// The answer is exact for the rounded entries of K, but has few digits for the beam, and the report says so.
#[test]
fn a_certified_answer_whose_stiffness_has_few_digits_has_a_warning() {
    let block = |height: f64| {
        let axis = |length: f64| json!({"points": [0, length], "divisions": [8]});
        let scene = json!({
            "body": {"rectangle": {"x": axis(1.0), "y": axis(height), "element": "q4"}},
            "material": {"young": 1, "poisson": 0.3},
            "supports": [
                {"on": {"boundary": "bottom"}, "y": 0},
                {"on": {"boundary": "left"}, "x": 0},
                {"on": {"boundary": "right"}, "x": 0}
            ],
            "obstacles": [{"boundary": "top", "approach": "+y",
                           "shape": {"plane": {"point": [0, height], "normal": [0, 1]}}}],
            "gap": -0.01 * height
        });
        let model = built(&scene);
        let solution = solve(model.problem(), &Settings::default()).unwrap_or_else(|e| panic!("{height:e}: {e}"));
        let error = (solution.contact_force() / (0.7 / (1.3 * 0.4) * 0.01) - 1.0).abs();
        let digits = solution.digits_of_stiffness();
        let answer = Answer::of(model.into(), &solution).unwrap();
        (error, Summary::of_answer(&answer, solution, TOLERANCE, 0.0).unwrap(), digits)
    };
    let (error, summary, digits) = block(1e6);
    let digits = digits.unwrap();
    assert!(summary.is_certified() && error <= 10.0_f64.powi(1 - digits as i32), "{error:e}, {digits} digits");
    let report = json!(summary);
    let warning = &report["warnings"][0];
    assert_eq!((&warning["code"], report["warnings"].as_array().unwrap().len()), (&json!("lost-digits"), 1));
    let message = warning["message"].as_str().unwrap();
    assert!(message.contains(&format!("{digits} digit")) && message.contains("smallest pivot"), "{message}");
    assert!(message.contains("bending") && message.contains("contrast"), "{message}");
    let text = summary.text("block", &Units::default());
    assert!(text.contains("  warning       the entries of the stiffness"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let (_, summary, digits) = block(1.0);
    assert!(digits.is_none() && json!(summary).get("warnings").is_none());
    assert!(!summary.text("block", &Units::default()).contains("warning"));
}
