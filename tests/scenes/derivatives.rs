//! GOAL: every derivative of an output of a scene with respect to its numbers is that of the answer.
//!
//! REFERENCE: differences of whole answers inside one proven contact set, and the slope of the exact path. A short form of
//! `cargo run --release --example derivatives -- scenes 200`.

use signorini::Scene;
use support::program::example;
use support::slopes::{off_path, wrong_slopes};
use support::{axis_scenes, key_scenes, plane_scenes, space_scenes};

#[test]
fn examples_have_the_derivatives_that_differences_show() {
    let mut compared = 0;
    for name in ["indentation", "bar", "circle", "inclined"] {
        let found = wrong_slopes(&Scene::read(example(name)).unwrap());
        assert!(found.wrong.is_empty(), "{name}: {:#?}", found.wrong);
        compared += found.all.iter().filter(|slope| slope.difference.is_some() && slope.found.is_finite()).count();
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn random_scenes_have_the_derivatives_that_differences_show() {
    let kinds = [plane_scenes::scene, axis_scenes::scene, space_scenes::scene, key_scenes::scene];
    for (kind, scene) in kinds.into_iter().enumerate() {
        for seed in [2, 3] {
            let found = wrong_slopes(&scene(seed).0);
            assert!(found.wrong.is_empty(), "kind {kind}, seed {seed}: {:#?}", found.wrong);
        }
    }
}

#[test]
fn derivatives_with_respect_to_the_gap_are_the_slopes_of_the_exact_path() {
    let scenes = (1..=12).map(|seed| plane_scenes::scene(seed).0);
    let off: Vec<f64> = scenes.filter_map(|scene| off_path(&scene)).collect();
    assert!(off.len() >= 3 && off.iter().all(|&off| off <= 1e-10), "{off:?}");
}
