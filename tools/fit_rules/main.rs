//! Fits the rules of `Method::Auto` to measured times, and checks them on other scenes.
//!
//! `cargo run --release --example fit_rules` measures the training problems, writes `tools/fit_rules/measured.csv` and
//! fits the constants of `crates/qp/src/cost/fitted.rs` to it. With `-- --fit` it fits to the times in the existing
//! file; with `-- --check` it measures the other scenes.

mod fit;
mod measure;
mod training;

use std::fs;
use std::process::ExitCode;

const MEASURED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/fit_rules/measured.csv");
const FITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/qp/src/cost/fitted.rs");

/// The line with which the constants begin.
const FIRST_LINE: &str = "// Written by the fit.";

fn main() -> ExitCode {
    let argument = std::env::args().nth(1);
    let done = match argument.as_deref() {
        None => training().and_then(|()| fitted()),
        Some("--fit") => fitted(),
        Some("--check") => check(),
        Some(other) => Err(format!("{other}: it must be --fit, --check or nothing").into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

type Anything = Box<dyn std::error::Error>;

fn training() -> Result<(), Anything> {
    let mut table = measure::HEADING.to_string();
    for (name, problem) in training::training()? {
        let lines = measure::measured(&name, &problem)?;
        print!("{lines}");
        table += &lines;
    }
    fs::write(MEASURED, table)?;
    Ok(())
}

fn fitted() -> Result<(), Anything> {
    let points = measure::read(&fs::read_to_string(MEASURED)?)?;
    let text = fs::read_to_string(FITTED)?;
    let (by_hand, _) = text.split_once(FIRST_LINE).ok_or_else(|| format!("{FITTED} has no line `{FIRST_LINE}`"))?;
    fs::write(FITTED, format!("{by_hand}{FIRST_LINE}\n{}", fit::fitted(&points)))?;
    println!("{FITTED} is fitted to {} times", points.len());
    Ok(())
}

/// Compares `auto` with the fastest method that reaches the same accuracy, condensed or not.
fn check() -> Result<(), Anything> {
    println!(
        "| problem | dofs | rows | accuracy | best way | seconds | auto | seconds | ratio |\n|{}",
        "---|".repeat(9)
    );
    let mut worst = 0.0_f64;
    for (name, problem) in training::others()? {
        for accuracy in measure::ACCURACIES {
            let [(best, least), (auto, seconds)] = measure::best_and_auto(&problem, accuracy);
            let ratio = seconds / least;
            worst = worst.max(ratio);
            let (dofs, rows) = (problem.dofs(), problem.rows());
            println!(
                "| {name} | {dofs} | {rows} | {accuracy:.0e} | {best} | {least:.6} | {auto} | {seconds:.6} | {ratio:.2} |"
            );
        }
    }
    println!("\nauto takes at most {worst:.2} times as long as the best");
    Ok(())
}
