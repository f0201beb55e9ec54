//! GOAL: every derivative of an output of a scene with respect to its parameters is that of the answer.
//!
//! REFERENCE: differences of whole answers inside one proven contact set. A short form of
//! `cargo run --release --example derivatives -- scenes 200`.

use signorini::Scene;
use support::program::example;
use support::slopes::{Slope, slopes};
use support::{axis_scenes, key_scenes, plane_scenes, space_scenes};

/// Largest error, relative to the largest derivative of the same output and unit of parameter.
const MOST: f64 = 1e-6;

/// The outputs that a scene has, as far as they are smooth in general.
fn outputs(scene: &Scene) -> Vec<String> {
    let dimension = scene.build().unwrap().mesh().dimension();
    let (low, high) = {
        let model = scene.build().unwrap();
        let (a, b) = model.mesh().extent();
        (a, b)
    };
    let place: Vec<String> = (0..dimension).map(|axis| format!("{}", 0.47 * low[axis] + 0.53 * high[axis])).collect();
    let at = |name: &str| name.replace(["X,Y,Z", "X,Y", "X"][3 - dimension], &place.join(","));
    let named = scene.outputs().unwrap();
    let mut all: Vec<String> = named.iter().map(|name| at(name)).collect();
    all.extend(
        named.iter().filter(|name| name.starts_with("stress")).map(|name| at(name).replace(":xx", ":von-mises")),
    );
    all
}

/// The slopes whose derivative is off, or not proven.
fn wrong(scene: &Scene) -> (usize, Vec<Slope>) {
    let (outputs, parameters) = (outputs(scene), scene.parameters());
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let parameters: Vec<&str> =
        parameters.iter().map(String::as_str).filter(|name| *name != "nodes").take(14).collect();
    let model = scene.build().unwrap();
    let all = slopes(scene, &outputs, &parameters, model.mesh().size());
    let mut off = Vec::new();
    for slope in &all {
        let of_output = all.iter().filter(|other| other.output == slope.output && other.parameter == slope.parameter);
        let size = of_output.map(|other| other.difference.map_or(0.0, |d| d.0.abs())).fold(1e-300, f64::max);
        if slope.verdict == "unknown" || slope.error(size).is_some_and(|error| error > MOST) {
            off.push(slope.clone());
        }
    }
    (all.len(), off)
}

#[test]
fn examples_have_the_derivatives_that_differences_show() {
    for name in ["indentation", "bar", "between", "block", "circle", "inclined", "ball"] {
        let scene = Scene::read(example(name)).unwrap();
        let (count, off) = wrong(&scene);
        println!("{name}: {count}, {} off", off.len());
        off.iter().take(12).for_each(|slope| println!("   {slope:?}"));
    }
}

#[test]
fn random_scenes_have_the_derivatives_that_differences_show() {
    let kinds: [(&str, fn(u64) -> (Scene, &'static str)); 4] = [
        ("plane", plane_scenes::scene),
        ("axis", axis_scenes::scene),
        ("space", space_scenes::scene),
        ("keys", key_scenes::scene),
    ];
    for (name, scene) in kinds {
        for seed in 1..=3 {
            let (scene, _) = scene(seed);
            let (count, off) = wrong(&scene);
            println!("{name} {seed}: {count}, {} off", off.len());
            off.iter().take(12).for_each(|slope| println!("   {slope:?}"));
        }
    }
}
