//! The cost of a contact solve beside that of one linear solve of the same stiffness, on one thread.
//!
//! Every case is timed in a process of its own. Each round runs all its tasks once; the smallest time of each task over
//! all rounds counts. The peak memory is measured in one more process for each task, which builds the model and does
//! the task once.

mod case;
mod measure;
mod ratios;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::{Map, Value, json};

use crate::process::{Failure, child, peak_bytes};
use crate::table::show;
use case::{CASES, Case};
use measure::{Bench, TASKS, Task};

/// Cost of a contact solve beside one linear solve
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    alone: Option<Alone>,
    /// Folder for the tables, also as JSON
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Only the cases of these names, such as "Q4 64,Hex8 6"
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Option<Vec<String>>,
    /// Rounds of every case; the smallest time of each task counts
    #[arg(long, value_name = "N", default_value_t = 4)]
    rounds: usize,
}

/// What a process of its own measures.
#[derive(Subcommand)]
enum Alone {
    #[command(hide = true)]
    Time { case: String, rounds: usize },
    #[command(hide = true)]
    Memory { case: String, task: String },
}

pub fn run(options: &Options) -> Result<(), Failure> {
    match &options.alone {
        None => return measure_all(options),
        Some(Alone::Time { case, rounds }) => println!("{}", time(&Case::named(case)?, *rounds)?),
        Some(Alone::Memory { case, task }) => println!("{}", memory(&Case::named(case)?, task)?),
    }
    Ok(())
}

fn measure_all(options: &Options) -> Result<(), Failure> {
    let (only, rounds) = (options.only.as_ref(), options.rounds.to_string());
    let mut cases = Vec::new();
    for case in CASES.iter().filter(|case| only.is_none_or(|names| names.iter().any(|name| name == case.name))) {
        eprintln!("{} ...", case.name);
        let mut measured = child(&["contact_cost", "time", case.name, &rounds])?;
        for (task, entry) in measured["tasks"].as_object_mut().into_iter().flatten() {
            entry["peak_bytes"] = child(&["contact_cost", "memory", case.name, task])?;
        }
        cases.push(measured);
    }
    let text = ratios::text(&cases, options.rounds);
    let json = format!("{:#}\n", json!({"rounds": options.rounds, "cases": cases}));
    Ok(show(&text, options.out.as_deref(), "contact_cost.md", &[("contact_cost.json".to_string(), json)])?)
}

fn time(case: &Case, rounds: usize) -> Result<Value, Failure> {
    let bench = Bench::of(case)?;
    let tasks: Vec<_> = TASKS.iter().filter(|task| task.runs(case)).collect();
    let mut least = vec![f64::INFINITY; tasks.len()];
    for round in 0..rounds {
        for (task, least) in tasks.iter().zip(&mut least) {
            if round == 0 || !task.is_slow() {
                *least = least.min(task.seconds(case, &bench)?);
            }
        }
    }
    let entry = |(task, seconds): (&&Task, f64)| (task.name.to_string(), json!({"seconds": seconds}));
    let mut measured = bench.sizes()?;
    measured["case"] = json!(case.name);
    measured["tasks"] = tasks.iter().zip(least).map(entry).collect::<Map<_, _>>().into();
    Ok(measured)
}

fn memory(case: &Case, name: &str) -> Result<Value, Failure> {
    let task = TASKS.iter().find(|task| task.name == name).ok_or("no such task")?;
    task.seconds(case, &Bench::of(case)?)?;
    Ok(json!(peak_bytes()))
}
