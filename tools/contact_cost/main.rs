//! Compares the cost of a contact solve with that of one linear solve of the same stiffness, on one thread:
//! `cargo run --release --example contact_cost [-- --out DIR] [--only "Q4 64,Hex8 6"] [--rounds N]`.
//!
//! Every case is timed in a process of its own. Each round runs all its tasks once; the smallest time of each task over
//! all rounds counts. The peak memory is measured in one more process for each task, which builds the model and does
//! the task once.

mod case;
mod linear;
mod measure;
mod table;

use std::path::Path;
use std::process::ExitCode;

use case::{CASES, Case};
use linear::Ordering;
use measure::{Bench, TASKS};
use serde_json::{Map, Value, json};
use signorini::output::write_files;
use support::process::{Failure, child, ended, option, peak_bytes};

/// Number of rounds of every case. The smallest time of each task counts.
const ROUNDS: usize = 4;

fn main() -> ExitCode {
    ended(|words| match *words {
        ["time", name, rounds] => answer(&time(&known(name)?, rounds.parse()?)?),
        ["memory", name, task] => answer(&memory(&known(name)?, task)?),
        _ => measure_all(words),
    })
}

fn known(name: &str) -> Result<Case, Failure> {
    Case::named(name).ok_or_else(|| format!("no case is named `{name}`").into())
}

fn answer(value: &Value) -> Result<(), Failure> {
    println!("{value}");
    Ok(())
}

fn measure_all(words: &[&str]) -> Result<(), Failure> {
    let only = option(words, "--only").map(|list| list.split(',').collect::<Vec<_>>());
    let default_rounds = ROUNDS.to_string();
    let rounds = option(words, "--rounds").unwrap_or(&default_rounds);
    let mut cases = Vec::new();
    for case in CASES.iter().filter(|case| only.as_ref().is_none_or(|names| names.contains(&case.name))) {
        eprintln!("{} ...", case.name);
        let mut measured = child(&["time", case.name, rounds])?;
        for (task, entry) in measured["tasks"].as_object_mut().into_iter().flatten() {
            entry["peak_bytes"] = child(&["memory", case.name, task])?;
        }
        cases.push(measured);
    }
    let text = table::text(&cases, rounds);
    print!("{text}");
    if let Some(folder) = option(words, "--out") {
        let json = format!("{:#}\n", json!({"rounds": rounds.parse::<usize>()?, "cases": cases}));
        write_files(Path::new(folder), &[("contact_cost.md", text), ("contact_cost.json", json)])?;
    }
    Ok(())
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
    let entries: Map<String, Value> =
        tasks.iter().zip(least).map(|(task, seconds)| (task.name.to_string(), json!({"seconds": seconds}))).collect();
    let factor = bench.factor_bytes(Ordering::Amd);
    Ok(json!({"case": case.name, "dofs": case.dofs(), "rows": bench.rows(), "condensed_dofs": bench.condensed_dofs()?,
              "linear_factor_bytes": factor, "factor_bytes": bench.contact_factor_bytes()?, "tasks": entries}))
}

fn memory(case: &Case, name: &str) -> Result<Value, Failure> {
    let task = TASKS.iter().find(|task| task.name == name).ok_or("no such task")?;
    task.seconds(case, &Bench::of(case)?)?;
    Ok(json!(peak_bytes()))
}
