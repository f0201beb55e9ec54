//! The closed forms of bar and patch, against linear solves in which the contact is written as a support.

use crate::bodies::built;
use serde_json::{Value, json};
use signorini::internals::Cholesky;
use signorini::internals::closed_forms::{Bar, ContactPatch, Sides};

/// Tolerance of the bar and of the patch test, relative to the largest value: elements are exact, rounding remains.
const EXACT: f64 = 1e-11;

#[test]
fn a_bar_stopped_by_a_wall_carries_the_rest_of_its_load_into_it() {
    let bar = Bar { length: 2.0, axial_stiffness: 1e4, gap: 1e-3 };
    // EA = E x height 0.1 x thickness 0.1; F = 20 exceeds EA g/L = 5, so that the wall is reached.
    let mut scene = json!({
        "model": "plane-stress", "thickness": 0.1,
        "body": {"rectangle": {"x": {"points": [0, 2], "divisions": [20]}, "y": {"points": [0, 0.1], "divisions": [1]}}},
        "material": {"young": 1e6, "poisson": 0},
        "supports": [
            {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0.001}, {"on": {"point": [0, 0]}, "y": 0}],
        "loads": [{"traction": {"boundary": "right", "value": [2000, 0]}}]
    });
    let check = |scene: &Value, reaction: f64, displacement: &dyn Fn(f64) -> f64| {
        let model = built(scene);
        let u = Cholesky::of(model.problem().stiffness()).unwrap().solve(model.problem().load());
        let (nodal, forces) = (model.nodal_displacement(&u).unwrap(), model.reactions(&u, &[]).unwrap());
        let mut wall = 0.0;
        for (node, &[x, ..]) in model.mesh().nodes().iter().enumerate() {
            assert!((nodal[2 * node] - displacement(x)).abs() < EXACT * 1e-3, "u({x})");
            wall -= if x == 2.0 { forces[2 * node] } else { 0.0 };
        }
        assert!((wall - reaction).abs() < EXACT * reaction.max(1.0), "{wall} {reaction}");
    };
    assert_eq!(bar.reaction_to_end_force(20.0), 15.0);
    check(&scene, 15.0, &|x| bar.displacement_under_end_force(20.0, x));
    // Distributed: body force 1000 per volume on an area of 0.01 is q = 10.
    scene["loads"] = json!([{"body-force": [1000, 0]}]);
    assert_eq!(bar.reaction_to_distributed_load(10.0), 5.0);
    check(&scene, 5.0, &|x| bar.displacement_under_distributed_load(10.0, x));
}

#[test]
fn a_bar_that_just_touches_feels_no_wall() {
    let bar = Bar { length: 2.0, axial_stiffness: 10.0, gap: 0.1 };
    assert_eq!(bar.reaction_to_distributed_load(2.0 * 10.0 * 0.1 / 4.0), 0.0);
    assert_eq!(bar.reaction_to_end_force(0.5), 0.0);
    assert!((bar.displacement_under_end_force(0.5, 2.0) - 0.1).abs() < 1e-16);
    assert!((bar.displacement_under_end_force(0.25, 2.0) - 0.05).abs() < 1e-16);
    assert!((bar.displacement_under_end_force(100.0, 2.0) - 0.1).abs() < 1e-15);
}

#[test]
fn a_uniformly_compressed_block_strains_as_the_patch_test_says() {
    let pressure = 3.0;
    for (model, sides) in
        [("plane-strain", Sides::PlaneStrain), ("plane-stress", Sides::PlaneStress), ("plane-strain", Sides::Confined)]
    {
        for element in ["t3", "q4"] {
            let patch = ContactPatch { young: 1000.0, poisson: 0.3, sides };
            let (exx, eyy) = patch.strains(pressure);
            let mut scene = json!({
                "model": model,
                "body": {"rectangle": {
                    "x": {"points": [0, 2], "divisions": [5], "ratios": [3]}, "y": {"points": [0, 1], "divisions": [3]},
                    "element": element}},
                "material": {"young": 1000, "poisson": 0.3},
                "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0}],
                "loads": [{"traction": {"boundary": "top", "value": [0, -pressure]}}]
            });
            if sides == Sides::Confined {
                scene["supports"].as_array_mut().unwrap().push(json!({"on": {"boundary": "right"}, "x": 0}));
            }
            let model = built(&scene);
            let u = Cholesky::of(model.problem().stiffness()).unwrap().solve(model.problem().load());
            let nodal = model.nodal_displacement(&u).unwrap();
            for (node, &[x, y, _]) in model.mesh().nodes().iter().enumerate() {
                let error = (nodal[2 * node] - exx * x).abs().max((nodal[2 * node + 1] - eyy * y).abs());
                assert!(error < EXACT * eyy.abs(), "{sides:?} {element}: {error:e}");
            }
            for stress in &model.stress(&u).unwrap().nodes {
                assert!((stress.sigma_yy + pressure).abs() < EXACT * pressure, "{sides:?} {element} {stress:?}");
            }
            // A prescribed top displacement of -eyy H + g over a gap g gives the pressure back.
            assert!((patch.pressure(1.0, 0.01 - eyy, 0.01) - pressure).abs() < EXACT * pressure);
        }
    }
    let patch = ContactPatch { young: 1000.0, poisson: 0.3, sides: Sides::Confined };
    assert_eq!(patch.pressure(1.0, 0.01, 0.02), 0.0, "out of reach");
}
