//! Compares the cost of a contact solve by multigrid with that of one linear solve by the same hierarchy, and with that
//! of a factorisation: `cargo run --release --example multigrid [-- --out DIR] [--most-dofs N]`. With `--bodies` other
//! bodies are measured, with `--scene SCENE.json` a given scene.
//!
//! `cargo run --release --example multigrid threads CASE RUNS` runs two threads and one thread alternately in one
//! process (case 1 has 104,544 dofs, case 3 has 811,200). Its result is meaningful only on a machine without other
//! work.
//!
//! Every case runs in a process of its own. Seconds are processor seconds of all threads together; only the column of
//! two threads is wall-clock time. With a folder, the table as Markdown and JSON and the plot of the growth are written
//! into it.

mod bodies;
mod case;
mod growth;
mod measure;

use std::path::Path;
use std::process::ExitCode;

use case::{CASES, Case};
use serde_json::json;
use signorini::Scene;
use signorini::output::write_files;
use support::process::{Failure, child, ended, option};

/// Largest number of dofs for which the factorisation is measured. Beyond it the factor would take tens of gigabytes.
const MOST_DIRECT: usize = 120_000;

fn main() -> ExitCode {
    ended(run)
}

fn run(words: &[&str]) -> Result<(), Failure> {
    match *words {
        ["iterative", index, threads] => {
            println!("{}", measure::iterative(&CASES[index.parse::<usize>()?].model()?, threads.parse()?)?);
        }
        ["threads", index, runs] => {
            println!("{:#}", measure::threads(&CASES[index.parse::<usize>()?].model()?, runs.parse()?)?);
        }
        ["direct", index] => println!("{}", measure::direct(&CASES[index.parse::<usize>()?].model()?)?),
        ["body", index] => {
            let (name, scene) = bodies::bodies().swap_remove(index.parse()?);
            println!("{}", measure::iterative(&Scene::from_json(&scene.to_string(), name)?.build()?, 1)?);
        }
        ["--bodies"] => {
            println!("{}", growth::BODIES_HEAD);
            for (index, (name, _)) in bodies::bodies().iter().enumerate() {
                println!("{}", growth::body_line(name, &child(&["body", &index.to_string()])?));
            }
        }
        _ => match option(words, "--scene") {
            Some(scene) => {
                let model = Scene::read(Path::new(scene))?.build()?;
                println!("{}\n{}", growth::BODIES_HEAD, growth::body_line(scene, &measure::iterative(&model, 1)?));
            }
            None => measure_all(option(words, "--out"), option(words, "--most-dofs").unwrap_or("1000000").parse()?)?,
        },
    }
    Ok(())
}

fn measure_all(out: Option<&str>, most_dofs: usize) -> Result<(), Failure> {
    let dofs = |case: &Case| 3 * (case.cells + 1).pow(2) * case.cells;
    let mut measured = Vec::new();
    for (index, case) in CASES.iter().enumerate().filter(|entry| dofs(entry.1) <= most_dofs) {
        eprintln!("{} dofs ...", dofs(case));
        let index = index.to_string();
        let mut of_case = child(&["iterative", &index, "1"])?;
        of_case["two_threads"] = child(&["iterative", &index, "2"])?["wall"].take();
        of_case["radius"] = json!(case.radius);
        if dofs(case) <= MOST_DIRECT {
            let direct = child(&["direct", &index])?;
            of_case["same_set"] = json!(direct["closed_rows"] == of_case["closed_rows"]);
            of_case["direct"] = direct;
        }
        measured.push(of_case);
    }
    let text = growth::table(&measured);
    print!("{text}");
    if let Some(folder) = out.map(Path::new) {
        let json = format!("{:#}\n", json!({ "cases": measured }));
        write_files(folder, &[("multigrid.md", text), ("multigrid.json", json)])?;
        growth::plot(&measured).write(folder, "multigrid")?;
    }
    Ok(())
}
