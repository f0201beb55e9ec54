//! Derivatives: their verdicts at kinks, their values beside differences, and their cost.

use std::collections::BTreeMap;

use clap::{Args, Subcommand};
use serde_json::json;
use signorini::scene::{ByParameter, Sensitivities};
use signorini::{Method, Prepared, Scene, Settings};
use support::draws::Draws;
use support::oracles::exact::kinks::{Kink, Place};
use support::slopes::{off_path, wrong_slopes};
use support::{axis_scenes, plane_scenes};

use crate::block::block;
use crate::clock::fastest;
use crate::linear::{self, Ordering};
use crate::process::{Failure, no_faults};
use crate::random;

/// Runs of a derivative, of which the fastest counts.
const RUNS: usize = 3;

/// Derivatives beside exact arithmetic and differences, and their cost; without a part, `kinks`
#[derive(Args)]
pub struct Options {
    #[command(subcommand)]
    part: Option<Part>,
}

#[derive(Subcommand)]
enum Part {
    /// Random problems, a third at a kink, a third near one, beside exact arithmetic
    Kinks {
        #[arg(default_value_t = 1000)]
        problems: u64,
    },
    /// Derivatives with respect to gaps beside the slopes of the exact path
    Path {
        #[arg(default_value_t = 50)]
        scenes: u64,
    },
    /// All numbers of random scenes beside differences of whole answers
    Scenes {
        #[arg(default_value_t = 200)]
        scenes: u64,
    },
    /// Seconds of all derivatives of one output over one linear solve, and by multigrid over the contact solve
    Cost,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let wrong = match options.part {
        None => kinks(1000),
        Some(Part::Kinks { problems }) => kinks(problems),
        Some(Part::Path { scenes }) => path(scenes),
        Some(Part::Scenes { scenes: count }) => scenes(count),
        Some(Part::Cost) => return cost(),
    };
    no_faults(wrong, "derivatives that are called proven, or one-sided, are wrong")
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
    let (mut compared, mut all, mut wrong) = (0, 0, 0);
    let mut verdicts = BTreeMap::<&'static str, usize>::new();
    for number in 0..count {
        let (kind, seed, scene) = random::scene(number, 4);
        let found = wrong_slopes(&scene);
        all += found.all.len();
        compared += found.all.iter().filter(|slope| slope.difference.is_some() && slope.found.is_finite()).count();
        found.all.iter().for_each(|slope| *verdicts.entry(slope.verdict).or_default() += 1);
        found.wrong.iter().for_each(|slope| println!("{kind} {seed}: {slope:?}"));
        wrong += found.wrong.len();
    }
    println!("{count} scenes, {all} derivatives, {compared} beside differences, {wrong} wrong; {verdicts:?}");
    wrong
}

fn cost() -> Result<(), Failure> {
    let loaded = |mut scene: serde_json::Value| {
        scene["loads"] = json!([{"pressure": {"boundary": "left", "value": 1e3}}]);
        Scene::from_json(&scene.to_string(), "block")
    };
    let numbers =
        |scene: &Scene| -> Vec<String> { scene.parameters().into_iter().filter(|name| name != "nodes").collect() };
    // Seconds of the fastest derivative of the force with respect to these parameters, and the last answer.
    let derived =
        |scene: &Scene, parameters: &[String], settings: &Settings| -> Result<(f64, Sensitivities), Failure> {
            let parameters: Vec<&str> = parameters.iter().map(String::as_str).collect();
            let runs = (0..RUNS).map(|_| scene.sensitivity(&["force"], &parameters, settings));
            let mut runs = runs.collect::<Result<Vec<_>, _>>()?;
            let least = runs.iter().map(|run| run.seconds).fold(f64::INFINITY, f64::min);
            Ok((least, runs.swap_remove(RUNS - 1)))
        };
    let scene = loaded(block([1.0; 2], [256; 2], "q4", 1.0, -0.01))?;
    let model = scene.build()?;
    let problem = model.problem();
    let mut linear = f64::INFINITY;
    for ordering in [Ordering::Amd, Ordering::NestedDissection(2)] {
        let solve = || linear::solve(problem.stiffness(), problem.load(), ordering).ok_or("no factor");
        linear = linear.min(fastest(RUNS, solve)?.1);
    }
    let of_plane = numbers(&scene);
    let (by_numbers, _) = derived(&scene, &of_plane, &Settings::default())?;
    let (by_places, _) = derived(&scene, &["nodes".to_string()], &Settings::default())?;
    println!("{} dofs, one linear solve: {linear:.3} s", problem.dofs());
    println!("one output, {} parameters: {by_numbers:.3} s, {:.2} of it", of_plane.len(), by_numbers / linear);
    println!("one output, places of all nodes: {by_places:.3} s, {:.2} of it", by_places / linear);

    let scene = loaded(block([1.0; 3], [32; 3], "hex8", 1.0, -0.01))?;
    let settings = Settings::with_method(Method::Mprgp);
    let model = scene.build()?;
    let problem = model.problem();
    let contact = || Prepared::for_gaps(problem, 1, &settings).and_then(|prepared| prepared.solve(problem.gap()));
    let (_, solve) = fastest(RUNS, contact)?;
    let of_space = numbers(&scene);
    let (by_cycles, found) = derived(&scene, &of_space, &settings)?;
    let (_, exact) = derived(&scene, &of_space, &Settings::with_method(Method::ActiveSet))?;
    let pairs = found.outputs[0].by.iter().zip(&exact.outputs[0].by);
    // Derivatives that symmetry makes zero have no relative error.
    let share = |row: &ByParameter| row.relative.as_ref().and_then(|relative| relative.proven()).copied();
    let error = pairs
        .filter(|(_, exact)| share(exact).is_some_and(|share| share.abs() > 1e-9))
        .filter_map(|(a, b)| Some((a.derivative.proven()? / b.derivative.proven()? - 1.0).abs()))
        .fold(0.0_f64, f64::max);
    println!("{} dofs by multigrid: the contact solve takes {solve:.3} s", problem.dofs());
    println!(
        "one output, {} parameters: {by_cycles:.3} s, {:.2} of it; off by {error:.1e}",
        of_space.len(),
        by_cycles / solve
    );
    Ok(())
}
