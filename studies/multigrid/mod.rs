//! The cost of a contact solve by multigrid beside that of one linear solve by the same hierarchy, and that of a
//! factorisation.
//!
//! Every case runs in a process of its own. Seconds are processor seconds of all threads together; only the column of
//! two threads is wall-clock time.

mod bodies;
mod case;
mod growth;
mod measure;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::json;
use signorini::Scene;

use crate::process::{Failure, child};
use crate::table::{heading, row, show};
use case::{CASES, model};

/// Largest number of dofs for which the factorisation is measured. Beyond it the factor would take tens of gigabytes.
const MOST_DIRECT: usize = 120_000;

/// Cost of a contact solve by multigrid beside one linear solve and a factorisation
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    alone: Option<Alone>,
    /// Folder for the table, also as JSON, and a plot of the growth
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Leave out larger blocks
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    most_dofs: usize,
    /// Other bodies instead
    #[arg(long, conflicts_with = "scene")]
    bodies: bool,
    /// This scene instead
    #[arg(long, value_name = "SCENE.json")]
    scene: Option<PathBuf>,
}

/// What this process measures by itself.
#[derive(Subcommand)]
enum Alone {
    /// Two threads and one alternately, which means something only without other work; case 3 has 811,200 dofs
    Threads { case: usize, runs: usize },
    #[command(hide = true)]
    Iterative { case: usize, threads: usize },
    #[command(hide = true)]
    Direct { case: usize },
    #[command(hide = true)]
    Body { number: usize },
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let block = |case: usize| model(&CASES[case].scene());
    match options.alone {
        Some(Alone::Threads { case, runs }) => println!("{:#}", measure::threads(&block(case)?, runs)?),
        Some(Alone::Iterative { case, threads }) => println!("{}", measure::iterative(&block(case)?, threads)?),
        Some(Alone::Direct { case }) => println!("{}", measure::direct(&block(case)?)?),
        Some(Alone::Body { number }) => {
            println!("{}", measure::iterative(&model(&bodies::bodies().swap_remove(number).1)?, 1)?);
        }
        None => match &options.scene {
            Some(scene) => {
                let measured = measure::iterative(&Scene::read(scene)?.build()?, 1)?;
                print!("{}", heading(growth::OF_BODY) + &row(&growth::of_body(&scene.to_string_lossy(), &measured)));
            }
            None if options.bodies => {
                print!("{}", heading(growth::OF_BODY));
                for (index, (name, _)) in bodies::bodies().iter().enumerate() {
                    let measured = child(&["multigrid", "body", &index.to_string()])?;
                    print!("{}", row(&growth::of_body(name, &measured)));
                }
            }
            None => measure_all(options)?,
        },
    }
    Ok(())
}

fn measure_all(options: &Options) -> Result<(), Failure> {
    let mut measured = Vec::new();
    for (index, case) in CASES.iter().enumerate().filter(|(_, case)| case.dofs() <= options.most_dofs) {
        eprintln!("{} dofs ...", case.dofs());
        let index = index.to_string();
        let mut of_case = child(&["multigrid", "iterative", &index, "1"])?;
        of_case["two_threads"] = child(&["multigrid", "iterative", &index, "2"])?["wall"].take();
        of_case["radius"] = json!(case.radius);
        if case.dofs() <= MOST_DIRECT {
            let direct = child(&["multigrid", "direct", &index])?;
            of_case["same_set"] = json!(direct["closed_rows"] == of_case["closed_rows"]);
            of_case["direct"] = direct;
        }
        measured.push(of_case);
    }
    let json = format!("{:#}\n", json!({ "cases": measured }));
    let files = [("multigrid.json".to_string(), json)];
    show(&growth::of_cases(&measured), options.out.as_deref(), "multigrid.md", &files)?;
    if let Some(folder) = &options.out {
        growth::plot(&measured).write(folder, "multigrid")?;
    }
    Ok(())
}
