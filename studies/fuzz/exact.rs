//! The target `exact`: random contact problems, for which every answer of the program is compared with exact
//! arithmetic.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use signorini::qp::read_problem;
use support::oracles::exact::case::Case;
use support::oracles::exact::judge::Fault;
use support::oracles::exact::problem::Exact;
use support::oracles::exact::stiffness::KINDS;
use support::oracles::exact::table::Table;
use support::oracles::exact::trial::{Trial, draw};

use super::desk::{save, seed};
use crate::process::{Failure, no_faults};

/// Every answer of the library beside exact arithmetic
#[derive(Args)]
pub struct Options {
    #[arg(required_unless_present = "answer")]
    problems: Option<u64>,
    /// By the clock if none is given
    #[arg(default_value_t = seed(), hide_default_value = true)]
    seed: u64,
    /// Only this kind of stiffness
    #[arg(long, value_name = "NAME", value_parser = KINDS.map(|kind| kind.0))]
    kind: Option<String>,
    /// Only the problem of this number
    #[arg(long, value_name = "NUMBER")]
    only: Option<u64>,
    /// Write the first problem of each sort of fault and kind of stiffness into this folder
    #[arg(long, value_name = "FOLDER")]
    save: Option<PathBuf>,
    /// Print every fault, not only the first of its sort and kind
    #[arg(long)]
    all: bool,
    /// Print the exact answer of the problem in this directory instead
    #[arg(long, value_name = "DIRECTORY", exclusive = true)]
    answer: Option<PathBuf>,
}

/// Runs the problems and prints the table. An answer that contradicts exact arithmetic is a fault.
pub fn run(options: &Options) -> Result<(), Failure> {
    if let Some(directory) = &options.answer {
        let case = Case::of(&read_problem(directory)?);
        println!("{:#}", Exact::new(&case).json(&case));
        return Ok(());
    }
    let (mut table, mut saved, start) = (Table::default(), BTreeSet::new(), Instant::now());
    let mut exact_seconds = 0.0;
    println!("seed {}", options.seed);
    // A panic is counted together with its problem; its own message would only disturb the table.
    std::panic::set_hook(Box::new(|_| {}));
    let numbers = options.only.map_or(0..options.problems.unwrap_or(0), |number| number..number + 1);
    for number in numbers {
        let trial = draw(options.seed, number, options.kind.as_deref());
        let report = trial.run();
        exact_seconds += report.exact_seconds;
        table.add(&trial, &report);
        for fault in &report.faults {
            let place = format!("{}-{}", fault.sort.name(), trial.kind);
            let is_first = saved.insert(place.clone());
            if is_first || options.all {
                println!("{number} ({}, {}): {}: {}", trial.kind, trial.rows, fault.sort.name(), fault.detail);
            }
            if let Some(folder) = options.save.as_ref().filter(|_| is_first) {
                keep(&folder.join(place), &trial, fault, number, options.seed)?;
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("\n{}\n{seconds:.0} s, of which {exact_seconds:.0} s exact; seed {}", table.text(), options.seed);
    let failures = table.failures();
    failures.iter().for_each(|failure| println!("must not be: {failure}"));
    no_faults(failures.len(), "sorts of fault must not be")
}

/// Writes the problem, its exact answer, and the faulty answer.
fn keep(folder: &Path, trial: &Trial, fault: &Fault, number: u64, seed: u64) -> std::io::Result<()> {
    let text = format!(
        "{}: {}\n\nstiffness {}, rows {}; problem {number} of seed {seed}: fuzz exact 1 {seed} --only {number}\n\nexact: {}\n",
        fault.sort.name(),
        fault.detail,
        trial.kind,
        trial.rows,
        Exact::new(&trial.case).json(&trial.case)
    );
    save(folder, &trial.case.problem().map_err(std::io::Error::other)?, fault.answer.as_ref(), &text)
}
