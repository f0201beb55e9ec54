//! Temperatures and initial stresses in scenes: supported and free bodies, a bimetal strip, a thick ring, refused
//! input.

use crate::materials::{answer, changed, refused};
use serde_json::{Value, json};

const ROUNDING: f64 = 1e-10;

/// A bar of 2 m with E A = 100 x 0.5, between two walls or in front of one.
fn bar(supports: Value) -> Value {
    json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 2], "divisions": [5]}, "area": 0.5}},
        "material": {"young": 100, "poisson": 0.3, "expansion": 1e-3},
        "temperature": [{"value": 30}],
        "supports": supports
    })
}

/// GOAL: a heated bar between fixed ends.
/// CONDITIONS: a bar with nothing but its temperature.
/// REFERENCE: the stress -E alpha T.
#[test]
fn a_heated_clamped_bar_has_the_stress_e_alpha_t() {
    let answer = answer(&bar(json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0}])));
    for stress in &answer.stress().unwrap().nodes {
        assert!((stress.sigma_xx + 3.0).abs() < ROUNDING, "{stress:?}");
    }
    let forces = answer.forces().unwrap();
    assert!((forces.reactions[0] - 1.5).abs() < ROUNDING && (forces.reactions[5] + 1.5).abs() < ROUNDING, "{forces:?}");
    assert!(forces.balance < ROUNDING, "{forces:?}");
}

/// Half of the length is warmer by 30, half by 50: the stress is that of the mean, and the jump of temperature causes
/// no error of the mesh.
#[test]
fn the_last_temperature_of_an_element_applies() {
    let mut scene = bar(json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0}]));
    scene["body"]["bar"]["x"]["divisions"] = json!([4]);
    scene["temperature"] = json!([{"value": 30}, {"box": {"min": [1], "max": [2]}, "value": 50}]);
    let answer = answer(&scene);
    for stress in &answer.stress().unwrap().elements {
        assert!((stress.sigma_xx + 4.0).abs() < ROUNDING, "{stress:?}");
    }
    assert!((answer.displacement()[2] + 0.01).abs() < ROUNDING, "{:?}", answer.displacement());
    assert!(answer.discretisation_error().unwrap() < ROUNDING);
}

/// GOAL: a heated bar against a wall.
/// CONDITIONS: the free end would move by 0.06 and meets the wall at 0.02; EA/L = 25.
/// REFERENCE: a spring of stiffness 25, compressed by the difference.
#[test]
fn a_heated_bar_is_compressed_by_its_expansion_beyond_the_gap() {
    let mut scene = bar(json!([{"on": {"boundary": "left"}, "x": 0}]));
    scene["obstacles"] =
        json!([{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2.02], "normal": [1]}}}]);
    let answer = answer(&scene);
    assert!((answer.multiplier()[0] + 25.0 * 0.04).abs() < ROUNDING, "{:?}", answer.multiplier());
    assert!((answer.forces().unwrap().reactions[0] - 1.0).abs() < ROUNDING);
}

/// GOAL: a body on statically determinate supports under a temperature and an initial stress.
/// CONDITIONS: plane stress; three pins; uniform warming, a temperature gradient and a uniform initial stress.
/// REFERENCE: the body deforms freely: no stress, no reaction.
#[test]
fn a_heated_body_on_statically_determinate_pins_has_neither_stress_nor_reactions() {
    let answer = answer(&json!({
        "model": "plane-stress",
        "body": {"rectangle": {
            "x": {"points": [0, 2], "divisions": [3]}, "y": {"points": [0, 1], "divisions": [2]}, "element": "q8"
        }},
        "material": {"young": 200, "poisson": 0.3, "expansion": 1e-3},
        "temperature": [{"value": 5}, {"value": 10, "gradient": [1, -30]}],
        "initial-stress": [{"xx": 4, "xy": -1}],
        "supports": [{"on": {"point": [0, 0]}, "x": 0, "y": 0}, {"on": {"point": [2, 0]}, "y": 0}]
    }));
    for stress in &answer.stress().unwrap().nodes {
        assert!(stress.von_mises < ROUNDING, "{stress:?}");
    }
    let forces = answer.forces().unwrap();
    assert!(forces.reactions.iter().all(|force| *force == 0.0) && forces.balance < ROUNDING, "{forces:?}");
    assert_eq!(answer.discretisation_error().unwrap(), 0.0);
}

/// GOAL: the bimetal strip.
/// CONDITIONS: half of a strip of two metals, 40 times as long as thick, warmed uniformly: the curvature in its middle.
/// REFERENCE: S. Timoshenko, *Analysis of bi-metal thermostats*, J. Opt. Soc. Am. 11 (1925) 233-255, equation 4.
#[test]
fn a_bimetal_strip_has_the_curvature_of_timoshenko() {
    let (thin, thick, e1, e2, a1, a2, warmer) = (0.3, 0.7, 210.0, 100.0, 1.2e-5, 1.9e-5, 50.0);
    let (m, n): (f64, f64) = (thin / thick, e1 / e2);
    let whole = (1.0 + m).powi(2);
    let expected =
        6.0 * (a2 - a1) * warmer * whole / ((thin + thick) * (3.0 * whole + (1.0 + m * n) * (m * m + 1.0 / (m * n))));
    let answer = answer(&json!({
        "model": "plane-stress",
        "body": {"rectangle": {
            "x": {"points": [0, 20], "divisions": [40]}, "y": {"points": [0, thin, 1], "divisions": [2, 3]}, "element": "q8"
        }},
        "material": {"young": e2, "poisson": 0.2, "expansion": a2},
        "materials": [{"box": {"min": [0, 0], "max": [20, thin]}, "material": {"young": e1, "poisson": 0.3, "expansion": a1}}],
        "temperature": [{"value": warmer}],
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"point": [0, 0]}, "y": 0}]
    }));
    let node = answer.model().mesh().nodes().iter().position(|at| *at == [10.0, 0.0, 0.0]).unwrap();
    // The upper metal expands more, so that the strip bends down.
    let found = -2.0 * answer.displacement()[2 * node + 1] / 100.0;
    // Far from the ends the displacement is quadratic and exact; the measured error is 3e-9, the rounding of a slender
    // strip in bending.
    assert!((found / expected - 1.0).abs() < 1e-7, "{found} {expected}");
}

/// GOAL: thermal stresses of a thick ring.
/// CONDITIONS: free inside and outside, supported along its axis; the temperature grows linearly with the radius.
/// REFERENCE: S. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 3rd ed. 1970, article 151.
#[test]
fn a_thick_ring_with_a_linear_temperature_has_the_stresses_of_the_closed_form() {
    let (young, nu, expansion, slope, inner, outer) = (200.0, 0.3, 1e-3, 10.0, 1.0_f64, 2.0_f64);
    let scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {
            "x": {"points": [inner, outer], "divisions": [24]}, "y": {"points": [0, 0.1], "divisions": [1]}, "element": "q8"
        }},
        "material": {"young": young, "poisson": nu, "expansion": expansion},
        "temperature": [{"value": 0, "gradient": [slope, 0]}],
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "top"}, "y": 0}]
    });
    let factor = young * expansion / (1.0 - nu);
    // The integral of T r from the inner radius to r.
    let heat = |r: f64| slope * (r.powi(3) - inner.powi(3)) / 3.0;
    let answer = answer(&scene);
    let mut largest = 0.0_f64;
    for (stress, [r, ..]) in answer.stress().unwrap().nodes.iter().zip(answer.model().mesh().nodes()) {
        let share = |sign: f64| (r * r + sign * inner * inner) / (outer * outer - inner * inner) * heat(outer);
        let radial = factor / (r * r) * (share(-1.0) - heat(*r));
        let hoop = factor / (r * r) * (share(1.0) + heat(*r) - slope * r.powi(3));
        let along = nu * (radial + hoop) - young * expansion * slope * r;
        for (found, expected) in [(stress.sigma_xx, radial), (stress.sigma_zz, hoop), (stress.sigma_yy, along)] {
            largest = largest.max((found - expected).abs() / (factor * slope * outer));
        }
    }
    // The quadratic elements have a 24th of the width; measured 2e-4 at the nodes, relative to the stress of the fully
    // constrained outer temperature.
    assert!(largest < 4e-4, "{largest:e}");
}

#[test]
fn invalid_temperatures_and_initial_stresses_are_refused_at_their_path() {
    let right = bar(json!([{"on": {"boundary": "left"}, "x": 0}]));
    let stressed = |value: Value| changed(&right, "/initial-stress", json!([value]));
    let plane = json!({
        "model": "plane-stress",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [1]}, "y": {"points": [0, 1], "divisions": [1]}}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
    });
    let mut moving = changed(&right, "/analysis", json!({"dynamic": {"duration": 1}}));
    moving["material"]["density"] = json!(1);
    let orthotropic = json!({"orthotropic": {
        "young": [1, 1, 1], "poisson": [0, 0, 0], "shear": [1, 1, 1], "expansion": [1, 1, 1]
    }, "expansion": 1});
    let cases = [
        (
            changed(&right, "/material", json!({"young": 1, "poisson": 0})),
            "temperature[0]",
            "the material at (0.2) has no `expansion`",
        ),
        (changed(&right, "/temperature/0/gradient", json!([1, 2])), "temperature[0].gradient", "2 entries"),
        (changed(&right, "/temperature/0/group", json!("core")), "temperature[0].group", "`core`"),
        (changed(&right, "/temperature/0/box", json!({"min": [5], "max": [6]})), "temperature[0]", "no element"),
        (stressed(json!({"xx": 1, "yy": 2})), "initial-stress[0].yy", "a bar has no such stress; it has xx"),
        (changed(&plane, "/initial-stress", json!([{"zz": 1}])), "initial-stress[0].zz", "it has xx, yy, xy"),
        (changed(&right, "/material", orthotropic), "material", "`expansion` beside that of `orthotropic`"),
        (moving.clone(), "temperature", "a dynamic analysis has no `temperature`"),
        (
            changed(&changed(&moving, "/temperature", json!([])), "/initial-stress", json!([{"xx": 1}])),
            "initial-stress",
            "a dynamic analysis has no `initial-stress`",
        ),
    ];
    for (scene, path, phrase) in cases {
        refused(&scene, path, &[phrase]);
    }
}
