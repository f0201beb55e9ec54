//! GOAL: the closed forms of `tests/support/closed_forms` are right.
//!
//! CONDITIONS: bar and patch test with the contact replaced by a support; bars, Hertz contacts, punches, obstacle
//! problems, bars in impact and exact blocks at single places.
//!
//! REFERENCE: linear solves for bar and patch test; numbers that can be checked by hand.

use serde_json::{Value, json};
use signorini::fem::{ElementKind, Integration};
use signorini::qp::Cholesky;
use support::closed_forms::manufactured::{ContactSolution, GenericEdge, HertzBlock, PlaneElasticity, Smooth};
use support::closed_forms::{
    Bar, BouncingBar, Cone, ContactPatch, DiscMembrane, FlatDisc, FlatStrip, ImpactingBar, LineContact, ObstacleString,
    PointContact, Sides, Wedge,
};
use support::manufactured::solve_block;
use support::scenes::built;

/// Tolerance of the bar and of the patch test, relative to the largest value: the elements are exact, so only rounding
/// remains.
const EXACT: f64 = 1e-11;

#[test]
fn a_bar_stopped_by_a_wall_transfers_the_rest_of_its_load_to_it() {
    let bar = Bar { length: 2.0, axial_stiffness: 1e4, gap: 1e-3 };
    // EA = E x height 0.1 x thickness 0.1; F = 20 exceeds EA g/L = 5, so that the bar reaches the wall.
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
    // Distributed load: a body force of 1000 per volume on an area of 0.01 is q = 10.
    scene["loads"] = json!([{"body-force": [1000, 0]}]);
    assert_eq!(bar.reaction_to_distributed_load(10.0), 5.0);
    check(&scene, 5.0, &|x| bar.displacement_under_distributed_load(10.0, x));
}

#[test]
fn a_bar_that_just_touches_has_no_reaction() {
    let bar = Bar { length: 2.0, axial_stiffness: 10.0, gap: 0.1 };
    assert_eq!(bar.reaction_to_distributed_load(2.0 * 10.0 * 0.1 / 4.0), 0.0);
    assert_eq!(bar.reaction_to_end_force(0.5), 0.0);
    assert!((bar.displacement_under_end_force(0.5, 2.0) - 0.1).abs() < 1e-16);
    assert!((bar.displacement_under_end_force(0.25, 2.0) - 0.05).abs() < 1e-16);
    assert!((bar.displacement_under_end_force(100.0, 2.0) - 0.1).abs() < 1e-15);
}

#[test]
fn a_uniformly_compressed_block_has_the_strains_of_the_patch_test() {
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
            // A prescribed top displacement of -eyy H + g over a gap g gives the same pressure.
            assert!((patch.pressure(1.0, 0.01 - eyy, 0.01) - pressure).abs() < EXACT * pressure);
        }
    }
    let patch = ContactPatch { young: 1000.0, poisson: 0.3, sides: Sides::Confined };
    assert_eq!(patch.pressure(1.0, 0.01, 0.02), 0.0, "the plane is out of reach");
}

#[test]
fn a_bar_and_a_block_have_the_reaction_and_the_modulus_of_their_formulas() {
    let bar = Bar { length: 2.0, axial_stiffness: 10.0, gap: 0.1 };
    assert_eq!(bar.reaction_to_end_force(1.5), 1.0);
    let patch = ContactPatch { young: 3.0, poisson: 0.5, sides: Sides::PlaneStrain };
    assert_eq!(patch.modulus(), 4.0);
}

#[test]
fn hertz_contacts_have_the_size_and_the_pressure_of_their_formulas() {
    let contact = LineContact { modulus: 1.0 / 0.91, radius: 1.0 };
    assert!((contact.half_width(4.983922e-3) - 0.075990864).abs() < 1e-8);
    assert!((contact.peak_pressure(4.983922e-3) - 0.041753222).abs() < 1e-8);
    let contact = PointContact { modulus: 1.0 / 0.91, radius: 1.0 };
    assert!((contact.force(0.01) - 1.465201465e-3).abs() < 1e-12);
    assert!((contact.contact_radius(1.465201465e-3) - 0.1).abs() < 1e-10);
    assert!((contact.peak_pressure(1.465201465e-3) - 6.995821674e-2).abs() < 1e-10);
}

#[test]
fn punches_have_the_force_and_the_pressure_of_their_formulas() {
    let pi = std::f64::consts::PI;
    assert!((FlatStrip { half_width: 5.0 }.pressure(4.0 * pi, 3.0) - 1.0).abs() < 1e-15);
    assert_eq!(FlatDisc { radius: 2.0, modulus: 3.0 }.force(0.5), 6.0);
    let wedge = Wedge { slope: 0.5, modulus: 3.0 };
    assert_eq!((wedge.half_width(3.0), wedge.pressure(3.0, 2.0)), (2.0, 0.0));
    let cone = Cone { slope: 0.5, modulus: 1.0 };
    assert!((cone.contact_radius(cone.force(0.3 * pi)) - 1.2).abs() < 1e-15);
}

#[test]
fn a_string_and_a_membrane_have_the_contact_force_of_their_formulas() {
    assert!((ObstacleString { load: 1.0, gap: 0.08 }.force() - 0.2).abs() < 1e-15);
    let membrane = DiscMembrane { load: 8.0, gap: 0.25 };
    assert!((membrane.radius() - 0.737351524416).abs() < 1e-12);
    assert!((membrane.force() - 13.6643514803).abs() < 1e-10);
}

#[test]
fn bars_in_impact_have_the_force_and_the_displacement_of_their_waves() {
    let bar = ImpactingBar { length: 10.0, axial_stiffness: 900.0, line_density: 1.0, speed: 10.0, gap: 5.0 };
    assert_eq!((bar.force(), bar.contact()[0], bar.impulse(), bar.energy()), (300.0, 0.5, 200.0, 500.0));
    let at = |t| BouncingBar.displacement(0.25, t);
    assert_eq!([at(0.0), at(0.5), at(1.5), at(3.0), at(5.75)], [0.375, 0.25, -0.125, 0.375, 0.375]);
}

#[test]
fn exact_blocks_have_the_pressure_and_the_displacement_of_their_formulas() {
    let elastic = PlaneElasticity::plane_strain(1.0, 0.25);
    assert_eq!((elastic.lambda, elastic.mu), (0.4, 0.4));
    assert!((elastic.contact_modulus() - 1.0 / (1.0 - 0.25 * 0.25)).abs() < 1e-15);

    let elasticity = PlaneElasticity::plane_strain(1.0, 0.3);
    let edge = GenericEdge { elasticity, edge: 0.53, pressure: 1.0 };
    assert!((edge.pressure(0.28) - 0.75).abs() < 1e-15);
    assert!((edge.stress([0.28, 0.0])[1] + 0.75).abs() < 1e-14);
    // (kappa + 1)/(4 mu) p0 (x - x0)^1.5 = 2/E* 0.25^1.5
    assert!((edge.displacement([0.78, 0.0])[1] - 0.91 * 0.25).abs() < 1e-15);

    let hertz = HertzBlock { elasticity, half_width: 0.5, peak_pressure: 1.0 };
    assert!((hertz.pressure(0.3) - 0.8).abs() < 1e-15);
    assert!((hertz.stress([0.3, 0.0])[1] + 0.8).abs() < 1e-14);
    assert!((hertz.displacement([0.3, 0.0])[1] + hertz.gap(0.3)).abs() < 1e-15);
    // p0/(E* a) x^2
    assert!((hertz.gap(0.3) - 0.91 * 2.0 * 0.09).abs() < 1e-15);

    let smooth = Smooth { elasticity, opening: 2.0, pressure: 4.0, edge: 0.5, power: 3 };
    assert_eq!(smooth.pressure(0.0), 0.5);
    assert!((smooth.stress([0.0, 0.0])[1] + 0.5).abs() < 1e-15);
    assert_eq!(smooth.displacement([1.0, 0.0]), [0.0, 0.25]);
}

#[test]
fn the_hertz_block_on_16_by_16_cells_has_the_recorded_error() {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.3);
    let exact = HertzBlock { elasticity, half_width: 0.53, peak_pressure: 1.0 };
    let block = solve_block(&exact, ElementKind::Q4, Integration::Standard, 16).unwrap();
    assert!((block.errors().energy / 5.357e-2 - 1.0).abs() < 1e-3);
}
