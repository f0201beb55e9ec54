//! Every answer of `cargo run --release --example studies -- verification` has at most the error stated here.
//!
//! GOAL        classical contact problems, with the scenes of the command itself
//! CONDITIONS  those of `tests/support/verification`
//! REFERENCE   closed forms of `tests/support/closed_forms`

use serde_json::json;
use support::closed_forms::PointContact;
use support::verification::answer::{Answer, Solved};
use support::verification::contact_patch::{VARIANTS, contact_patch};
use support::verification::round_bodies::{self, half_ball_about_the_axis, quarter_ball};
use support::verification::{closed_forms, punches};

/// The elements are exact; rounding is multiplied by the condition number of the stiffness, below 1e4.
const EXACT: f64 = 1e-12;

/// Error of the punches, by the cells at the edge of the contact, a thirtieth to a thousandth of it, and by the size of
/// the block, 500 radii.
const PUNCH: f64 = 0.005;

/// Error of the force of a half cylinder of quadratic elements; the theory assumes a small contact.
const CYLINDER_FORCE: f64 = 1e-3;

/// Error of the largest nodal pressure of quadratic elements, which is a mean over a cell, an eighth of the contact.
const CYLINDER_PRESSURE: f64 = 1e-2;

/// Error of an axisymmetric half ball with five quadratic cells along the radius of the contact.
const BALL: f64 = 0.005;

/// Error of linear cells in space: seven are along the radius of the contact, and they grow from shell to shell.
const BALL_IN_SPACE: f64 = 0.03;

#[track_caller]
fn check(answers: &[Answer], tolerance: f64) {
    assert!(!answers.is_empty());
    for Answer { case, element, quantity, ours, exact, .. } in answers {
        let error = (ours / exact - 1.0).abs();
        assert!(error < tolerance, "{case}, {element}, {quantity}: {ours:e}, exact {exact:e}, error {error:.1e}");
    }
}

#[test]
fn a_uniformly_compressed_block_is_exact_on_distorted_meshes_of_every_element() {
    for (kind, formulation, integration) in VARIANTS {
        let worst = contact_patch(kind, formulation, integration).unwrap().worst();
        assert!(worst < EXACT, "{kind:?}, {formulation:?}, {integration:?}: {worst:e}");
    }
}

#[test]
fn bars_transfer_the_rest_of_their_load_to_the_wall() {
    check(&closed_forms::bars().unwrap(), EXACT);
}

#[test]
fn a_string_is_exact_and_a_membrane_converges() {
    let answers = closed_forms::obstacle_problems().unwrap();
    // With 2000 cells the string has a condition number of 4e6. The error of the membrane is h^2 = 1.6e-6 times a
    // number below one.
    check(&answers[..1], 1e-11);
    check(&answers[1..], 1e-6);
}

#[test]
fn forces_agree_with_the_stored_answers() {
    // The answers are stored in double precision; the independent solvers agree with each other to 1e-8.
    check(&closed_forms::stored_answers().unwrap(), 1e-8);
}

#[test]
fn punches_have_the_pressure_and_the_force_of_the_half_space() {
    check(&punches::punches().unwrap(), PUNCH);
}

#[test]
fn half_cylinders_have_the_force_and_the_pressure_of_hertz() {
    let answers = round_bodies::half_cylinders().unwrap();
    let (forces, pressures): (Vec<_>, Vec<_>) = answers.into_iter().partition(|answer| answer.quantity == "force");
    check(&forces, CYLINDER_FORCE);
    check(&pressures, CYLINDER_PRESSURE);
}

#[test]
fn a_half_ball_has_the_force_and_the_pressure_of_hertz_axisymmetric_and_in_space() {
    // The shells grow by a factor of two, so that there are fewer than in the table: 2.6 % in the force, in a tenth of
    // the time.
    let answers = round_bodies::half_balls(&quarter_ball(8, 2.0)).unwrap();
    let (in_space, about_axis): (Vec<_>, Vec<_>) = answers.into_iter().partition(|answer| answer.element == "Hex8");
    check(&about_axis, BALL);
    check(&in_space, BALL_IN_SPACE);
    assert!(about_axis[0].unknowns * 15 < in_space[0].unknowns);
}

/// A quarter of a half ball of 20-node bricks. The rows are for coefficients, so that pressures at corners and mid-side
/// nodes are on one curve.
#[test]
fn quadratic_bricks_have_the_pressure_of_hertz_at_every_node_of_a_ball() {
    let point = PointContact { modulus: 1.0 / 0.91, radius: 1.0 };
    let mut scene = quarter_ball(6, 2.0);
    scene["body"]["half-ball"]["element"] = "hex20".into();
    let solved = Solved::of(&scene).unwrap();
    let force = 4.0 * solved.force();
    let (off, peak) = (force / point.force(2.5e-5) - 1.0, solved.peak_pressure() / point.peak_pressure(force) - 1.0);
    assert!(off.abs() < BALL && peak.abs() < 0.01, "force {off:.2e}, peak {peak:.2e}");
    let radius = point.contact_radius(force);
    let mut inside = 0;
    for ([x, y, _], pressure) in solved.pressures() {
        let r = x.hypot(y);
        if r < 0.8 * radius {
            let error = pressure / point.pressure(force, r) - 1.0;
            assert!(error.abs() < 0.03, "at r = {r:.2e}: {error:.2e}");
            inside += 1;
        }
    }
    assert!(inside > 40, "{inside}");
}

/// The corner on the axis has almost no tributary area if the edge is curved, so that its pressure is not lambda
/// divided by that area.
#[test]
fn quadratic_elements_have_the_pressure_of_hertz_at_the_pole_of_a_ball() {
    let point = PointContact { modulus: 1.0 / 0.91, radius: 1.0 };
    for element in ["t6", "q8"] {
        for divisions in [5, 10, 20] {
            let mut scene = half_ball_about_the_axis();
            scene["supports"][0]["y"] = (-0.01).into();
            scene["body"]["half-disc"]["element"] = element.into();
            scene["body"]["half-disc"]["zone"] = json!({"width": 0.12, "divisions": divisions});
            let solved = Solved::of(&scene).unwrap();
            let ratio = solved.peak_pressure() / point.peak_pressure(solved.force());
            // It has the pressure of the next node, at most half a cell or 0.12 of the contact away.
            assert!((ratio - 1.0).abs() < 0.02, "{element}, {divisions}: {ratio}");
        }
    }
}

#[test]
fn mean_dilatation_gives_the_force_of_a_nearly_incompressible_ball() {
    // As in space at nu = 0.3, with shells that grow by a factor of two: 2.6 % in the force.
    check(&round_bodies::nearly_incompressible_half_balls().unwrap(), 0.05);
}
