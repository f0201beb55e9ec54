//! The target `promises`: what binaries of the program print about random problems, compared with exact arithmetic.
//!
//! Rows of the table are classes of problems (`trial.rs`), by their data and exact answer alone. Its columns count
//! problems: certified; `bound`, a printed bound below the error; `wrong`, certified and not right to 1e-9; `exact`,
//! the exact answer of a problem that moves is refused by `verify`; `mute`, a refusal without dof or digits; `lost`, a
//! right answer is refused that the other binary certifies.
//!
//! With `--against`, a second binary gets the same problems. Only the faults of the first one make the run fail; the
//! second one shows whether the problems are harsh enough, and which right answers the first one has lost.

mod table;

use std::collections::BTreeSet;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use rayon::prelude::*;
use signorini::ContactProblem;

use super::desk::{desk, save};
use support::oracles::promises::draw::chain;
use support::oracles::promises::program::{Program, write};
use support::oracles::promises::trial::{Fault, Findings, Trial};
use table::Table;

/// Number of problems after which faults are printed.
const AT_ONCE: u64 = 500;

const USAGE: &str =
    "usage: fuzz promises PROBLEMS [SEED] --program PATH [--against PATH] [--save FOLDER] [--only NUMBER]
       fuzz promises --chains PROBLEMS [SEED] --program PATH [--against PATH] [--save FOLDER] [--only NUMBER]";

/// The options of `fuzz promises`.
struct Options {
    problems: u64,
    seed: u64,
    /// The binary in question, and the other one.
    programs: Vec<Program>,
    chains: bool,
    save: Option<PathBuf>,
    only: Option<u64>,
}

fn options(arguments: &[String]) -> Option<Options> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |since| since.as_nanos() as u64 % 1_000_000_007);
    let (mut program, mut against, mut numbers) = (None, None, Vec::new());
    let mut options = Options { problems: 0, seed: now, programs: Vec::new(), chains: false, save: None, only: None };
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--program" => program = Some(Program(words.next()?.into())),
            "--against" => against = Some(Program(words.next()?.into())),
            "--save" => options.save = Some(words.next()?.into()),
            "--only" => options.only = Some(words.next()?.parse().ok()?),
            "--chains" => options.chains = true,
            _ => numbers.push(word.parse().ok()?),
        }
    }
    let ([problems] | [problems, _]) = numbers[..] else { return None };
    options.problems = problems;
    options.seed = numbers.get(1).copied().unwrap_or(now);
    options.programs = [Some(program?), against].into_iter().flatten().collect();
    Some(options)
}

impl Options {
    /// The numbers of the problems, a few at once.
    fn batches(&self) -> impl Iterator<Item = Range<u64>> {
        let all = self.only.map_or(0..self.problems, |number| number..number + 1);
        let end = all.end;
        all.step_by(AT_ONCE as usize).map(move |first| first..end.min(first + AT_ONCE))
    }

    /// The command that repeats one problem.
    fn again(&self, number: u64) -> String {
        let chains = if self.chains { "--chains " } else { "" };
        format!("problem {number} of seed {0}: fuzz promises {chains}1 {0} --only {number}", self.seed)
    }
}

/// Runs the problems, prints the table, and returns a failure if the first program breaks a promise.
pub fn run(arguments: &[String]) -> ExitCode {
    let Some(options) = options(arguments) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let start = Instant::now();
    let faults = desk().and_then(|desk| match options.chains {
        true => chains(&options, desk.path()),
        false => problems(&options, desk.path()),
    });
    match faults {
        Ok(faults) => {
            println!("{:.0} s; seed {}", start.elapsed().as_secs_f64(), options.seed);
            if faults == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Returns the number of faults of the first program.
fn problems(options: &Options, desk: &Path) -> io::Result<usize> {
    let (mut table, mut shown) = (Table::new(options.programs.len()), BTreeSet::new());
    for numbers in options.batches() {
        let judge = |number: u64| {
            let trial = Trial::draw(options.seed, number);
            let findings = trial.run(&options.programs, &desk.join(number.to_string()))?;
            Ok((trial, findings))
        };
        let judged: Vec<(Trial, Vec<Findings>)> =
            numbers.clone().into_par_iter().map(judge).collect::<io::Result<_>>()?;
        for (number, (trial, findings)) in numbers.zip(&judged) {
            table.add(trial.class, findings);
            for fault in &findings[0].faults {
                let place = format!("{}-{}", fault.sort.name(), trial.class.name().replace(' ', "-"));
                if shown.insert(place.clone()) {
                    println!("{number} ({}): {}: {}", trial.class.name(), fault.sort.name(), fault.detail);
                    options.save.as_ref().map_or(Ok(()), |folder| {
                        let text = about(trial, fault, &options.again(number));
                        let problem = trial.case.problem().map_err(io::Error::other)?;
                        save(&folder.join(place), &problem, fault.answer.as_ref(), &text)
                    })?;
                }
            }
        }
    }
    println!("{}", table.text(&options.programs));
    Ok(table.faults())
}

fn about(trial: &Trial, fault: &Fault, again: &str) -> String {
    let exact = trial.exact.json(&trial.case);
    format!("{}: {}\n\n{}, {again}\n\nexact: {exact}\n", fault.sort.name(), fault.detail, trial.class.name())
}

/// Counts the chains that each program refuses. Returns the count of the first one.
fn chains(options: &Options, desk: &Path) -> io::Result<usize> {
    let mut refused = vec![0; options.programs.len()];
    for numbers in options.batches() {
        let ask = |number: u64| {
            let problem = chain(options.seed, number).map_err(io::Error::other)?;
            let directory = desk.join(number.to_string());
            write(&directory, &problem)?;
            let endings = options.programs.iter().map(|program| program.solve(&directory));
            let endings = endings.collect::<io::Result<Vec<_>>>()?;
            std::fs::remove_dir_all(directory)?;
            Ok((problem, endings))
        };
        let asked: Vec<(ContactProblem, Vec<_>)> =
            numbers.clone().into_par_iter().map(ask).collect::<io::Result<_>>()?;
        for (number, (problem, endings)) in numbers.zip(asked) {
            let first = &endings[0];
            if !first.is_certified() && refused[0] == 0 {
                println!("{number} (n = {}): exit {}: {}", problem.dofs(), first.code, first.sentence);
                options.save.as_ref().map_or(Ok(()), |folder| {
                    let text = format!("refused: {}\n\n{}\n", first.sentence, options.again(number));
                    save(&folder.join("chain"), &problem, first.answer.as_ref(), &text)
                })?;
            }
            refused.iter_mut().zip(&endings).for_each(|(count, ending)| *count += usize::from(!ending.is_certified()));
        }
    }
    for (program, count) in options.programs.iter().zip(&refused) {
        println!("{}: {count} of {} chains refused", program.0.display(), options.problems);
    }
    Ok(refused[0])
}
