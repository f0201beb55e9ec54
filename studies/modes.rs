//! Natural vibrations beside a dense solver, and their cost.

use std::collections::BTreeMap;

use clap::{Args, Subcommand};
use serde_json::json;
use signorini::Scene;
use signorini::Settings;
use signorini::fem::MassForm;
use signorini::qp::{Cholesky, Watch};
use support::modal::{Checked, checked};

use crate::block::axis;
use crate::clock::fastest;
use crate::process::{Failure, no_faults};
use crate::random;
use crate::table::{heading, row};

/// Modes of each scene.
const COUNT: usize = 12;

/// Runs of the computation of the modes, of which the fastest counts.
const RUNS: usize = 3;

/// Natural vibrations beside a dense solver, and their cost; without a part, `scenes`
#[derive(Args)]
pub struct Options {
    #[command(subcommand)]
    part: Option<Part>,
}

#[derive(Subcommand)]
enum Part {
    /// The first modes of random scenes beside a dense solver
    Scenes {
        #[arg(default_value_t = 200)]
        scenes: u64,
    },
    /// Seconds of twenty modes over those of one factorisation with its analysis
    Cost,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    match options.part {
        None => scenes(200),
        Some(Part::Scenes { scenes: count }) => scenes(count),
        Some(Part::Cost) => cost(),
    }
}

fn scenes(count: u64) -> Result<(), Failure> {
    let (mut number, mut compared, mut modes, mut wrong, mut worst) = (0, 0, 0, 0, 0.0_f64);
    let (mut left, mut verdicts) = (BTreeMap::<String, usize>::new(), BTreeMap::<String, usize>::new());
    while compared < count {
        let (name, seed, scene) = random::scene(number, 5);
        number += 1;
        match checked(&scene, COUNT, seed) {
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
    no_faults(wrong, "scenes have a missed or wrong mode")
}

fn cost() -> Result<(), Failure> {
    print!("{}", heading("body | dofs | factorisation | twenty modes | ratio"));
    for (name, cells, size) in [("block", [256, 256], [1.0, 1.0]), ("cantilever", [512, 128], [1.0, 0.02])] {
        for is_held in [true, false] {
            let supports = if is_held { json!([{"on": {"boundary": "left"}, "x": 0, "y": 0}]) } else { json!([]) };
            let scene: Scene = serde_json::from_value(json!({
                "body": {"rectangle": {"x": axis(size[0], cells[0]), "y": axis(size[1], cells[1])}},
                "material": {"young": 1e7, "poisson": 0.3, "density": 1000},
                "supports": supports,
                "analysis": {"modes": {"count": 20}}
            }))?;
            let model = scene.build()?;
            let (problem, threads) = (model.problem(), Settings::threads_of_machine());
            let mass = model.mass(MassForm::Consistent)?;
            let sum = problem.stiffness().combined(1.0, 1.0, &mass)?;
            let (_, factor) = fastest(RUNS, || Cholesky::on(&sum, threads))?;
            let (_, modes) = fastest(RUNS, || problem.modes(&mass, (&[], &[]), 20, threads, &Watch::default()))?;
            let held = if is_held { "held" } else { "free" };
            let (dofs, ratio) = (problem.dofs(), modes / factor);
            print!("{}", row(&format!("{name}, {held} | {dofs} | {factor:.2} | {modes:.2} | {ratio:.2}")));
        }
    }
    Ok(())
}
