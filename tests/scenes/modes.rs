//! GOAL: natural vibrations about a contact state are those of closed forms, and none is missed.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};
use signorini::scene::ModalAnalysis;
use signorini::{Scene, Settings};
use support::modal::{Checked, checked};
use support::{axis_scenes, key_scenes, pair_scenes, plane_scenes, space_scenes};

fn modes(scene: &Value, count: usize) -> ModalAnalysis {
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    let found = scene.modal_analysis(count, &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(found.is_complete);
    found
}

fn refusal(scene: &Value, count: usize) -> String {
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    scene.modal_analysis(count, &Settings::default()).map(|_| ()).unwrap_err().to_string()
}

/// A bar of length, modulus, density and area 1, held on the left and pulled with `force` towards a wall at the
/// distance `gap`.
fn bar(cells: usize, gap: f64, force: f64) -> Value {
    json!({
        "model": "bar", "gap": gap,
        "body": {"bar": {"area": 1, "x": {"points": [0, 1], "divisions": [cells]}}},
        "material": {"young": 1, "poisson": 0, "density": 1},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"traction": {"boundary": "right", "value": [force]}}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [1], "normal": [1]}}}]
    })
}

/// A strip of length 1 without a motion across it: a bar of elements in the plane.
fn strip(cells: usize, element: &str) -> Value {
    json!({
        "model": "plane-stress",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [cells]}, "y": {"points": [0, 0.1], "divisions": [1]},
            "element": element}},
        "material": {"young": 1, "poisson": 0, "density": 1},
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "top"}, "y": 0}]
    })
}

/// GOAL: frequencies converge with twice the order of the elements.
/// CONDITIONS: a strip that vibrates as a bar, 6 and 12 cells; T3, Q4, T6, Q8.
/// REFERENCE: the frequency 3/4 of its second mode, (2n - 1)/4 with n = 2; the order 2p of eigenvalues by elements of
/// order p.
#[test]
fn frequencies_converge_with_the_order_of_the_elements() {
    for (element, order) in [("t3", 2.0), ("q4", 2.0), ("t6", 4.0), ("q8", 4.0)] {
        let off = |cells: usize| (modes(&strip(cells, element), 2).modes[1].frequency / 0.75 - 1.0).abs();
        let rate = (off(6) / off(12)).log2();
        assert!((rate - order).abs() < 0.25, "{element}: {rate}");
    }
}

/// GOAL: longitudinal vibrations of a bar.
/// CONDITIONS: the bar touches the wall, or does not.
/// REFERENCE: f = n/2 between two walls, (2n - 1)/4 with a free end; the force of the mode `a sin(n pi x)` on the wall
/// is `a n pi`.
#[test]
fn a_bar_vibrates_as_its_end_does() {
    let closed = modes(&bar(200, 0.01, 0.03), 3);
    assert!(closed.undecided.is_empty() && closed.unproven.is_none());
    assert_eq!(closed.closed, [0]);
    for (number, mode) in (1..).zip(&closed.modes) {
        let exact = f64::from(number) / 2.0;
        // The error of linear elements: (n pi h)^2 / 24.
        assert!((mode.frequency / exact - 1.0).abs() < (PI * f64::from(number) / 200.0).powi(2) / 20.0);
        // The wall takes 0.03 - 0.01.
        let opens = mode.opens.unwrap();
        assert!((opens.amplitude * f64::from(number) * PI / 0.02 - 1.0).abs() < 1e-3, "{opens:?}");
        assert_eq!((opens.row, opens.obstacle, mode.closes), (0, 0, None));
    }
    let open = modes(&bar(200, 0.01, 0.004), 3);
    assert!(open.closed.is_empty() && open.unproven.is_none());
    for (number, mode) in (1..).zip(&open.modes) {
        let exact = f64::from(2 * number - 1) / 4.0;
        assert!((mode.frequency / exact - 1.0).abs() < (TAU * exact / 200.0).powi(2) / 20.0);
        // The end moves most; 0.006 of the gap are left.
        assert!((mode.closes.unwrap().amplitude / 0.006 - 1.0).abs() < 1e-6 && mode.opens.is_none());
        // A sine of (2n - 1) pi / 2: 8 / (2n - 1)^2 pi^2 of the mass.
        let share = 8.0 / (f64::from(2 * number - 1) * PI).powi(2);
        assert!((mode.effective_mass[0] / share - 1.0).abs() < 1e-3);
    }
    // A bar that just touches may do both.
    let between = modes(&bar(50, 0.25, 0.25), 2);
    assert_eq!(between.undecided, [0]);
    let frequencies: Vec<[f64; 2]> =
        between.modes.iter().map(|mode| [mode.frequency_open.unwrap(), mode.frequency]).collect();
    assert!(
        frequencies
            .iter()
            .flatten()
            .zip([0.25, 0.5, 0.75, 1.0])
            .all(|(found, exact)| (found / exact - 1.0).abs() < 2e-3)
    );
}

/// GOAL: bending vibrations of a cantilever.
/// CONDITIONS: a steel beam of 1 m and 2 cm under its weight, with a stop under its end or below it.
/// REFERENCE: Euler and Bernoulli: `f = (b / L)^2 sqrt(E I / rho A) / 2 pi` with b = 3.926602 and 7.068583 on the stop,
/// 1.875104 and 4.694091 without it.
#[test]
fn a_cantilever_on_a_stop_is_stiffer_than_one_above_it() {
    let beam = |gap: f64| {
        json!({
            "model": "plane-stress", "thickness": 0.01, "gap": gap,
            "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [40]}, "y": {"points": [0, 0.02], "divisions": [1]}, "element": "q8"}},
            "material": {"young": 2.1e11, "poisson": 0.3, "density": 7850},
            "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
            "loads": [{"gravity": [0, -9.81]}],
            "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"wedge": {"apex": [1, 0], "slope": 1}}}]
        })
    };
    let unit = 0.02 / 12.0_f64.sqrt() * (2.1e11_f64 / 7850.0).sqrt() / TAU;
    for (gap, roots) in [(0.0, [3.926602, 7.068583]), (0.01, [1.875104, 4.694091])] {
        let found = modes(&beam(gap), 2);
        assert!(found.undecided.is_empty() && found.unproven.is_none());
        assert_eq!(found.closed.len(), usize::from(gap == 0.0));
        for (mode, root) in found.modes.iter().zip(roots) {
            let exact = root * root * unit;
            // Shear and rotary inertia take 0.1 to 0.4 %.
            assert!((mode.frequency / exact - 1.0).abs() < 5e-3, "{} {exact}", mode.frequency);
        }
    }
}

/// GOAL: bending vibrations of a ring.
/// CONDITIONS: a thin free ring.
/// REFERENCE: R. Hoppe, 1871: `w_n^2 = n^2 (n^2 - 1)^2 / (n^2 + 1) E I / (rho A R^4)`, each twice; three rigid motions.
#[test]
fn a_free_ring_has_three_rigid_motions_and_every_frequency_twice() {
    let ring = json!({
        "model": "plane-stress",
        "body": {"ring": {"radius": {"points": [0.99, 1.01], "divisions": [1]}, "angle": {"points": [0, 360], "divisions": [160]}, "element": "q8"}},
        "material": {"young": 1, "poisson": 0.3, "density": 1}
    });
    let found = modes(&ring, 9);
    assert!(found.solution.is_none());
    assert_eq!(found.rigid_motions.len(), 3);
    assert!(found.modes[..3].iter().all(|mode| mode.frequency == 0.0), "{:?}", found.modes[2].frequency);
    for (place, n) in [(3, 2.0_f64), (5, 3.0), (7, 4.0)] {
        let exact = n * (n * n - 1.0) / (n * n + 1.0).sqrt() * 0.02 / 12.0_f64.sqrt() / TAU;
        for mode in &found.modes[place..place + 2] {
            assert!((mode.frequency / exact - 1.0).abs() < 5e-3, "{n}: {} {exact}", mode.frequency);
        }
    }
}

/// GOAL: vibrations of a block on a plane.
/// CONDITIONS: a block without lateral strain rests on a plane under its weight.
/// REFERENCE: a column that stands on one end: f = c / 4 H, with 8 / pi^2 of the mass.
#[test]
fn a_block_on_a_plane_vibrates_as_a_column() {
    let block = json!({
        "model": "plane-strain",
        "body": {"rectangle": {"x": {"points": [0, 0.5], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [20]}}},
        "material": {"young": 1e6, "poisson": 0, "density": 1000},
        "supports": [{"on": {"point": [0, 0]}, "x": 0}],
        "loads": [{"gravity": [0, -10]}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]
    });
    let found = modes(&block, 10);
    assert_eq!(found.closed.len(), 5);
    // Contact alone carries the weight: what is closed follows from the answer, not from a proof.
    assert!(found.unproven.is_some());
    let exact = (1e6_f64 / 1000.0).sqrt() / 4.0;
    let column = found.modes.iter().find(|mode| mode.effective_mass[1] > 0.5 * found.mass).unwrap();
    assert!((column.frequency / exact - 1.0).abs() < 1e-3, "{} {exact}", column.frequency);
    assert!((column.effective_mass[1] / found.mass * PI * PI / 8.0 - 1.0).abs() < 2e-3);
    assert!((found.mass / 500.0 - 1.0).abs() < 1e-12);
}

#[test]
fn half_a_body_has_the_symmetric_modes_of_the_whole() {
    let block = |half: bool| {
        let mut scene = json!({
            "model": "plane-strain",
            "body": {"rectangle": {"x": {"points": [0, if half { 0.5 } else { 1.0 }], "divisions": [if half { 5 } else { 10 }]},
                "y": {"points": [0, 0.4], "divisions": [4]}}},
            "material": {"young": 1e6, "poisson": 0.3, "density": 1000},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
        });
        if half {
            scene["symmetry"] = json!(["x"]);
        }
        scene
    };
    let (half, whole) = (modes(&block(true), 4), modes(&block(false), 12));
    assert!((half.mass / whole.mass - 1.0).abs() < 1e-12);
    for mode in &half.modes {
        let same = whole.modes.iter().find(|other| (other.frequency / mode.frequency - 1.0).abs() < 1e-9).unwrap();
        assert!((same.effective_mass[1] - mode.effective_mass[1]).abs() < 1e-6 * whole.mass, "{same:?} {mode:?}");
        assert_eq!(mode.effective_mass[0], 0.0);
    }
}

#[test]
fn no_mode_of_random_scenes_is_missed_or_wrong() {
    let mut compared = 0;
    for seed in 1..4 {
        let scenes = [
            plane_scenes::scene(seed).0,
            axis_scenes::scene(seed).0,
            space_scenes::scene(seed).0,
            key_scenes::scene(seed).0,
            pair_scenes::scene(seed).0,
        ];
        for scene in &scenes {
            if let Checked::Compared { wrong, .. } = checked(scene, 8, seed) {
                assert!(wrong.is_empty(), "{seed}: {wrong:?}");
                compared += 1;
            }
        }
    }
    assert!(compared >= 8, "{compared}");
}

#[test]
fn what_has_no_modes_is_refused_in_one_sentence() {
    let mut weightless = bar(10, 0.0, 1.0);
    weightless["material"].as_object_mut().unwrap().remove("density");
    assert!(refusal(&weightless, 1).contains("an analysis needs a `density`"));
    for count in [0, 1001] {
        assert!(refusal(&bar(10, 0.0, 1.0), count).contains("it must be from 1 to 1000"));
    }
    // More modes than unknowns: as many as there are.
    assert_eq!(modes(&bar(4, 0.0, 1.0), 10).modes.len(), 3);
}
