//! GOAL: an obstacle that a force presses is solved by multigrid, at about the price of one at a prescribed place.
//!
//! CONDITIONS: a clamped block of Hex8 under a sphere, which a force presses or a gap places; two pressed obstacles;
//! nodes whose dofs are all held, so that their rows bound the travel alone. REFERENCE: the method with a factor, and
//! the force that a gap gives.

use serde_json::{Value, json};
use signorini::qp::Estimate;
use signorini::{Method, Settings, Solution, solve};
use support::bodies::clamped_block;
use support::scenes::built;

/// Both methods are certified to 1e-9 in the energy norm; single values are less accurate.
const AGREED: f64 = 1e-6;

/// Cycles of a pressed obstacle over those of one at rest: one cycle for each face finds how the travel moves the body.
const MORE_CYCLES: f64 = 1.6;

/// A clamped block of n^3 cells under a sphere that `force` presses.
fn pressed(n: usize, force: f64) -> Value {
    let mut scene = clamped_block(n, 0.0);
    scene["obstacles"][0]["force"] = json!(force);
    scene
}

fn by(method: Method, scene: &Value) -> Solution {
    solve(built(scene).problem(), &Settings::with_method(method)).unwrap()
}

/// The largest difference of displacements, travels included, relative to the largest one.
fn differ(a: &Solution, b: &Solution) -> f64 {
    let size = a.displacement.iter().fold(0.0_f64, |size, u| size.max(u.abs()));
    a.displacement.iter().zip(&b.displacement).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max)
}

#[test]
fn a_force_costs_hardly_more_cycles_than_a_gap_and_gives_its_travel() {
    let placed = by(Method::Mprgp, &clamped_block(14, -0.01));
    let force = -placed.multiplier.iter().sum::<f64>();
    let found = by(Method::Mprgp, &pressed(14, force));
    let travel = found.displacement[found.displacement.len() - 1];
    assert!((travel / 0.01 - 1.0).abs() < AGREED, "{travel}");
    assert_eq!(found.contact_set, placed.contact_set);
    let times = found.iterations as f64 / placed.iterations as f64;
    assert!(times <= MORE_CYCLES, "{} and {} cycles", found.iterations, placed.iterations);
    assert!(found.certificate.energy_error_bound < 1e-9 && found.certificate.bound_is_measured);
}

#[test]
fn forces_over_four_decades_give_the_answer_of_a_factor() {
    for force in [1e2, 1e4, 1e6] {
        let scene = pressed(10, force);
        let (iterated, direct) = (by(Method::Mprgp, &scene), by(Method::ActiveSet, &scene));
        assert_eq!(iterated.contact_set, direct.contact_set, "{force}");
        assert!(differ(&direct, &iterated) < AGREED, "{force}: {:e}", differ(&direct, &iterated));
    }
}

#[test]
fn two_pressed_obstacles_and_a_load_give_the_answer_of_a_factor() {
    let mut scene = pressed(10, 2e4);
    scene["obstacles"].as_array_mut().unwrap().push(json!({"boundary": "right", "approach": "+x", "force": 1e4,
        "shape": {"sphere": {"apex": [1, 0.5, 0.5], "radius": 1}}}));
    scene["loads"] = json!([{"body-force": [5e3, 0, -2e4]}]);
    let (iterated, direct) = (by(Method::Mprgp, &scene), by(Method::ActiveSet, &scene));
    assert_eq!(iterated.contact_set, direct.contact_set);
    assert!(differ(&direct, &iterated) < AGREED, "{:e}", differ(&direct, &iterated));
}

/// A held node beside the apex stops the sphere: it takes most of the force, and its row has no dof but the travel.
#[test]
fn the_row_of_a_held_node_bounds_the_travel() {
    let mut scene = pressed(8, 1e6);
    scene["supports"].as_array_mut().unwrap().push(json!({"on": {"point": [0.625, 0.5, 1]}, "x": 0, "y": 0, "z": 0}));
    let (iterated, direct) = (by(Method::Mprgp, &scene), by(Method::ActiveSet, &scene));
    let travel = |found: &Solution| found.displacement[found.displacement.len() - 1];
    // The sphere of radius 2 is this far above the held node.
    let exact = 2.0 - (4.0_f64 - 0.125 * 0.125).sqrt();
    for found in [&iterated, &direct] {
        assert!((travel(found) / exact - 1.0).abs() < AGREED, "{}", travel(found));
    }
    assert!(differ(&direct, &iterated) < AGREED);
}

#[test]
fn multigrid_is_chosen_for_a_force_as_for_a_gap() {
    let estimate = |scene: &Value| Estimate::of(built(scene).problem());
    let (placed, force) = (estimate(&clamped_block(16, -0.01)), estimate(&pressed(16, 2e4)));
    assert!((force.multigrid_seconds / placed.multigrid_seconds - 1.0).abs() < 0.01, "{force:?}");
    assert!(placed.prefers_multigrid(f64::INFINITY) && force.prefers_multigrid(f64::INFINITY));
}

/// Contact alone holds the body along z: there is no bound without a factor, so that the plan takes one.
#[test]
fn a_pressed_body_that_contact_alone_holds_takes_a_factor() {
    let mut scene = pressed(16, 2e4);
    scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}]);
    scene["obstacles"].as_array_mut().unwrap().push(json!({"boundary": "bottom", "approach": "-z",
        "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}}));
    assert!(!Estimate::of(built(&scene).problem()).prefers_multigrid(f64::INFINITY));
}
