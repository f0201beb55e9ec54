//! Measures derivatives: `cargo run --release --example derivatives [-- kinks [PROBLEMS] | path [SCENES] | scenes
//! [SCENES] | cost]`.
//!
//! `kinks`: random problems, a third at a kink, a third near one, against exact arithmetic. `path`: derivatives with
//! respect to gaps against the slopes of the exact path. `scenes`: all numbers of random scenes against differences of
//! whole answers. `cost`: seconds of all derivatives of one output, over one linear solve, and by multigrid over the
//! contact solve. The exit code is 1 if a derivative that is called proven, or one-sided, is wrong.

#[path = "../contact_cost/linear.rs"]
mod linear;

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::Instant;

use serde_json::json;
use signorini::scene::{ByParameter, Sensitivities};
use signorini::{Method, Prepared, Scene, Settings};
use support::draws::Draws;
use support::oracles::exact::kinks::{Kink, Place};
use support::slopes::{off_path, wrong_slopes};
use support::{axis_scenes, key_scenes, plane_scenes, space_scenes};

/// Runs of a derivative, of which the fastest counts.
const RUNS: usize = 3;

/// The random scene of a seed, with the name of its elements.
type Random = fn(u64) -> (Scene, &'static str);

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1);
    let what = words.next();
    let count = words.next().and_then(|word| word.parse().ok());
    let wrong = match what.as_deref() {
        None | Some("kinks") => kinks(count.unwrap_or(1000)),
        Some("path") => path(count.unwrap_or(50)),
        Some("scenes") => scenes(count.unwrap_or(200)),
        Some("cost") => {
            cost();
            0
        }
        Some(other) => {
            eprintln!("there is no study `{other}`; there are `kinks`, `path`, `scenes` and `cost`");
            return ExitCode::from(2);
        }
    };
    ExitCode::from(u8::from(wrong > 0))
}

fn kinks(count: u64) -> usize {
    let mut counts = BTreeMap::<(Place, String), usize>::new();
    let mut wrong = 0;
    for number in 0..count {
        let kink = Kink::of(1, number);
        let mut draws = Draws(number);
        let [by_u, by_lambda] = [kink.case.dofs(), kink.case.rows()]
            .map(|count| (0..count).map(|_| f64::from(draws.between(-8, 8))).collect::<Vec<f64>>());
        let judged = kink.judged(&by_u, &by_lambda);
        if let Some(reason) = judged.wrong {
            println!("problem {number}, {:?}: {reason}", kink.place);
            wrong += 1;
        }
        *counts.entry((kink.place, judged.verdict)).or_default() += 1;
    }
    println!("{count} problems, {wrong} wrong");
    counts.iter().for_each(|((place, verdict), count)| println!("{place:?}, {verdict}: {count}"));
    wrong
}

fn path(count: u64) -> usize {
    let mut worst = 0.0_f64;
    let (mut compared, mut seed) = (0, 0);
    while compared < count {
        seed += 1;
        let kind = [plane_scenes::scene, axis_scenes::scene][seed as usize % 2];
        if let Some(off) = off_path(&kind(seed).0) {
            worst = worst.max(off);
            compared += 1;
        }
    }
    println!("{compared} scenes of {seed}: largest difference from the slope of the path, relative: {worst:.1e}");
    usize::from(worst > 1e-10)
}

fn scenes(count: u64) -> usize {
    let kinds: [(&str, Random); 4] = [
        ("plane", plane_scenes::scene),
        ("axis", axis_scenes::scene),
        ("space", space_scenes::scene),
        ("keys", key_scenes::scene),
    ];
    let (mut compared, mut all, mut wrong) = (0, 0, 0);
    let mut verdicts = BTreeMap::<&'static str, usize>::new();
    for number in 0..count {
        let (name, scene) = kinds[number as usize % kinds.len()];
        let seed = 1 + number / kinds.len() as u64;
        let (scene, _) = scene(seed);
        let found = wrong_slopes(&scene);
        all += found.all.len();
        compared += found.all.iter().filter(|slope| slope.difference.is_some() && slope.found.is_finite()).count();
        found.all.iter().for_each(|slope| *verdicts.entry(slope.verdict).or_default() += 1);
        for slope in &found.wrong {
            println!("{name} {seed}: {slope:?}");
            wrong += 1;
        }
    }
    println!("{count} scenes, {all} derivatives, {compared} beside differences, {wrong} wrong; {verdicts:?}");
    wrong
}

fn cost() {
    let block = |cells: usize, element: &str| {
        let axis = json!({"points": [0, 1], "divisions": [cells]});
        let is_space = element == "hex8";
        let (model, body, apex, shape) = match is_space {
            true => ("space", "box", json!([0.5, 0.5, 1]), "sphere"),
            false => ("plane-strain", "rectangle", json!([0.5, 1]), "parabola"),
        };
        let mut sides = json!({"x": axis, "y": axis, "element": element});
        let mut support = json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0});
        if is_space {
            (sides["z"], support["z"]) = (axis, json!(0));
        }
        let text = json!({
            "model": model, "body": {body: sides}, "material": {"young": 1e7, "poisson": 0.3}, "supports": [support], "gap": -0.01,
            "loads": [{"pressure": {"boundary": "left", "value": 1e3}}],
            "obstacles": [{"boundary": "top", "approach": if is_space { "+z" } else { "+y" },
                           "shape": {shape: {"apex": apex, "radius": 1}}}]
        });
        Scene::from_json(&text.to_string(), "block").unwrap()
    };
    let least = |run: &mut dyn FnMut() -> f64| (0..RUNS).map(|_| run()).fold(f64::INFINITY, f64::min);
    let scene = block(256, "q4");
    let model = scene.build().unwrap();
    let problem = model.problem();
    let by = |ordering| {
        let clock = Instant::now();
        linear::solve(problem.stiffness(), problem.load(), ordering).unwrap();
        clock.elapsed().as_secs_f64()
    };
    let linear = least(&mut || by(linear::Ordering::Amd).min(by(linear::Ordering::NestedDissection(2))));
    let numbers: Vec<String> = scene.parameters().into_iter().filter(|name| name != "nodes").collect();
    let numbers: Vec<&str> = numbers.iter().map(String::as_str).collect();
    let derived = |parameters: &[&str], scene: &Scene, settings: &Settings| -> Sensitivities {
        scene.sensitivity(&["force"], parameters, settings).unwrap()
    };
    let by_numbers = least(&mut || derived(&numbers, &scene, &Settings::default()).seconds);
    let by_places = least(&mut || derived(&["nodes"], &scene, &Settings::default()).seconds);
    println!("{} dofs, one linear solve: {linear:.3} s", problem.dofs());
    println!("one output, {} parameters: {by_numbers:.3} s, {:.2} of it", numbers.len(), by_numbers / linear);
    println!("one output, places of all nodes: {by_places:.3} s, {:.2} of it", by_places / linear);
    let scene = block(32, "hex8");
    let settings = Settings::with_method(Method::Mprgp);
    let model = scene.build().unwrap();
    let solve = least(&mut || {
        let clock = Instant::now();
        let prepared = Prepared::for_gaps(model.problem(), 1, &settings).unwrap();
        prepared.solve(model.problem().gap()).unwrap();
        clock.elapsed().as_secs_f64()
    });
    let mut error = 0.0;
    let numbers: Vec<String> = scene.parameters().into_iter().filter(|name| name != "nodes").collect();
    let numbers: Vec<&str> = numbers.iter().map(String::as_str).collect();
    let by_cycles = least(&mut || {
        let found = derived(&numbers, &scene, &settings);
        let exact = derived(&numbers, &scene, &Settings::with_method(Method::ActiveSet));
        let pairs = found.outputs[0].by.iter().zip(&exact.outputs[0].by);
        // Derivatives that symmetry makes zero have no relative error.
        let share = |row: &ByParameter| row.relative.as_ref().and_then(|relative| relative.proven()).copied();
        error = pairs
            .filter(|(_, exact)| share(exact).is_some_and(|share| share.abs() > 1e-9))
            .filter_map(|(a, b)| Some((a.derivative.proven()? / b.derivative.proven()? - 1.0).abs()))
            .fold(0.0_f64, f64::max);
        found.seconds
    });
    println!("{} dofs by multigrid: the contact solve takes {solve:.3} s", model.problem().dofs());
    println!(
        "one output, {} parameters: {by_cycles:.3} s, {:.2} of it; off by {error:.1e}",
        numbers.len(),
        by_cycles / solve
    );
}
