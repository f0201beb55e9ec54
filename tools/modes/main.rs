//! Measures natural vibrations: `cargo run --release --example modes [-- scenes [SCENES] | cost]`.
//!
//! `scenes`: the first modes of random scenes beside a dense solver; the exit code is 1 if one is missed or wrong.
//! `cost`: seconds of twenty modes over those of one factorisation with its analysis.

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::Instant;

use serde_json::json;
use signorini::Scene;
use signorini::qp::{Cholesky, Watch, threads_of_machine};
use support::modal::{Checked, checked};
use support::{axis_scenes, key_scenes, pair_scenes, plane_scenes, space_scenes};

/// Modes of each scene.
const COUNT: usize = 12;

/// Runs of the computation of the modes, of which the fastest counts.
const RUNS: usize = 3;

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1);
    let what = words.next();
    let count = words.next().and_then(|word| word.parse().ok());
    match what.as_deref() {
        None | Some("scenes") => ExitCode::from(u8::from(scenes(count.unwrap_or(200)) > 0)),
        Some("cost") => {
            cost();
            ExitCode::SUCCESS
        }
        Some(other) => {
            eprintln!("there is no study `{other}`; there are `scenes` and `cost`");
            ExitCode::from(2)
        }
    }
}

/// The random scene of a seed.
type SceneOf = fn(u64) -> Scene;

fn scenes(count: u64) -> usize {
    let kinds: [(&str, SceneOf); 5] = [
        ("plane", |seed| plane_scenes::scene(seed).0),
        ("axis", |seed| axis_scenes::scene(seed).0),
        ("space", |seed| space_scenes::scene(seed).0),
        ("keys", |seed| key_scenes::scene(seed).0),
        ("pairs", |seed| pair_scenes::scene(seed).0),
    ];
    let (mut number, mut compared, mut modes, mut wrong, mut worst) = (0, 0, 0, 0, 0.0_f64);
    let (mut left, mut verdicts) = (BTreeMap::<String, usize>::new(), BTreeMap::<String, usize>::new());
    while compared < count {
        let (name, scene) = kinds[number as usize % kinds.len()];
        let seed = 1 + number / kinds.len() as u64;
        number += 1;
        match checked(&scene(seed), COUNT, seed) {
            Checked::Left(reason) => *left.entry(format!("{name}: {reason}")).or_default() += 1,
            Checked::Compared { found, off, wrong: sentences } => {
                compared += 1;
                modes += found.modes.len();
                worst = worst.max(off);
                wrong += usize::from(!sentences.is_empty());
                sentences.iter().for_each(|sentence| println!("{name} {seed}: {sentence}"));
                let verdict = match (&found.unproven, found.undecided.is_empty()) {
                    (Some(_), _) => "not proven",
                    (None, true) => "proven",
                    (None, false) => "bracket",
                };
                *verdicts.entry(format!("{name} {verdict}")).or_default() += 1;
            }
        }
    }
    println!("{compared} scenes of {number}, {modes} modes, {wrong} scenes with a missed or wrong mode");
    println!("largest difference over what is allowed, 1e-8 of an eigenvalue and 1e-12 of the largest: {worst:.1e}");
    println!("rows: {verdicts:?}");
    println!("left out: {left:?}");
    wrong
}

/// Seconds of the fastest of some runs.
fn least<T>(mut work: impl FnMut() -> T) -> f64 {
    let run = |_| {
        let clock = Instant::now();
        work();
        clock.elapsed().as_secs_f64()
    };
    (0..RUNS).map(run).fold(f64::INFINITY, f64::min)
}

fn cost() {
    println!("| body | dofs | factorisation | twenty modes | ratio |\n| --- | --- | --- | --- | --- |");
    for (name, cells, size) in [("block", [256, 256], [1.0, 1.0]), ("cantilever", [512, 128], [1.0, 0.02])] {
        for is_held in [true, false] {
            let axis = |of: usize| json!({"points": [0.0, size[of]], "divisions": [cells[of]]});
            let supports = if is_held { json!([{"on": {"boundary": "left"}, "x": 0, "y": 0}]) } else { json!([]) };
            let scene: Scene = serde_json::from_value(json!({
                "body": {"rectangle": {"x": axis(0), "y": axis(1)}},
                "material": {"young": 1e7, "poisson": 0.3, "density": 1000},
                "supports": supports,
                "analysis": {"modes": {"count": 20}}
            }))
            .expect("a scene");
            let model = scene.build().expect("a model");
            let (problem, threads) = (model.problem(), threads_of_machine());
            let mass = model.mass(signorini::fem::MassForm::Consistent).expect("a density");
            let sum = problem.stiffness().combined(1.0, 1.0, &mass).expect("finite");
            let factor = least(|| Cholesky::on(&sum, threads).expect("a factor"));
            let modes = least(|| problem.modes(&mass, (&[], &[]), 20, threads, &Watch::default()).expect("modes"));
            let held = if is_held { "held" } else { "free" };
            println!(
                "| {name}, {held} | {} | {factor:.2} | {modes:.2} | {:.2} |",
                model.problem().dofs(),
                modes / factor
            );
        }
    }
}
