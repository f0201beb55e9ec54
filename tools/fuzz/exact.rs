//! The target `exact`: random contact problems, for which every answer of the program is compared with exact
//! arithmetic.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use signorini::qp::read_problem;

use super::desk::save;
use support::oracles::exact::case::Case;
use support::oracles::exact::judge::Fault;
use support::oracles::exact::problem::Exact;
use support::oracles::exact::stiffness::KINDS;
use support::oracles::exact::table::Table;
use support::oracles::exact::trial::{Trial, draw};

/// The options of `fuzz exact`.
struct Options {
    problems: u64,
    seed: u64,
    kind: Option<String>,
    save: Option<PathBuf>,
    only: Option<u64>,
    all: bool,
}

fn options(arguments: &[String]) -> Option<Options> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |since| since.as_nanos() as u64 % 1_000_000_007);
    let mut options = Options { problems: 0, seed: now, kind: None, save: None, only: None, all: false };
    let (mut words, mut plain) = (arguments.iter(), 0);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--kind" => {
                options.kind = Some(words.next().filter(|name| KINDS.iter().any(|kind| kind.0 == **name))?.clone())
            }
            "--save" => options.save = Some(words.next()?.into()),
            "--only" => options.only = Some(words.next()?.parse().ok()?),
            "--all" => options.all = true,
            _ => {
                let number = word.parse().ok()?;
                *[&mut options.problems, &mut options.seed].into_iter().nth(plain)? = number;
                plain += 1;
            }
        }
    }
    (plain > 0).then_some(options)
}

/// Runs the problems, prints the table, and returns a failure if an answer contradicts exact arithmetic.
pub fn run(arguments: &[String]) -> ExitCode {
    if let [word, directory] = arguments
        && word == "--answer"
    {
        return match read_problem(Path::new(directory)) {
            Ok(problem) => {
                let case = Case::of(&problem);
                println!("{:#}", Exact::new(&case).json(&case));
                ExitCode::SUCCESS
            }
            Err(error) => {
                eprintln!("{error}");
                ExitCode::FAILURE
            }
        };
    }
    let Some(options) = options(arguments) else {
        let kinds: Vec<&str> = KINDS.iter().map(|kind| kind.0).collect();
        eprintln!(
            "usage: fuzz exact PROBLEMS [SEED] [--kind NAME] [--only NUMBER] [--save FOLDER] [--all]\n       fuzz exact --answer DIRECTORY\nkinds: {}",
            kinds.join(" ")
        );
        return ExitCode::from(2);
    };
    let (mut table, mut saved, start) = (Table::default(), BTreeSet::new(), Instant::now());
    let mut exact_seconds = 0.0;
    println!("seed {}", options.seed);
    // A panic is counted together with its problem; its own message would only disturb the table.
    std::panic::set_hook(Box::new(|_| {}));
    let numbers = options.only.map_or(0..options.problems, |number| number..number + 1);
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
            if let Some(folder) = options.save.as_ref().filter(|_| is_first)
                && let Err(error) = keep(&folder.join(place), &trial, fault, number, options.seed)
            {
                eprintln!("{}: {error}", folder.display());
                return ExitCode::FAILURE;
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!("\n{}\n{seconds:.0} s, of which {exact_seconds:.0} s exact; seed {}", table.text(), options.seed);
    let failures = table.failures();
    failures.iter().for_each(|failure| println!("must not be: {failure}"));
    if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
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
