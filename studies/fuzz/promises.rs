//! The target `promises`: what binaries of the program print about random problems, compared with exact arithmetic.
//!
//! Rows of the table are classes of problems (`trial.rs`), by their data and exact answer alone. Its columns count
//! problems: certified; `bound`, a printed bound below the error; `wrong`, certified and not right to 1e-9; `exact`,
//! the exact answer of a problem that moves is refused by `verify`; `mute`, a refusal without dof or digits; `lost`, a
//! right answer is refused that the other binary certifies.
//!
//! With `--against`, a second binary gets the same problems. Only the faults of the first one make the run fail; the
//! second one shows whether the problems are harsh enough, and which right answers the first one has lost.

use std::collections::BTreeSet;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use signorini::ContactProblem;
use support::oracles::promises::draw::chain;
use support::oracles::promises::program::{Program, write};
use support::oracles::promises::trial::{Fault, Findings, Trial};

use super::counts::Table;
use super::desk::{desk, save, seed};
use crate::clock::timed;
use crate::process::{Failure, no_faults};

/// Number of problems after which faults are printed.
const AT_ONCE: u64 = 500;

/// What binaries of the program print, beside exact arithmetic
#[derive(Args)]
pub struct Options {
    problems: u64,
    /// By the clock if none is given
    #[arg(default_value_t = seed(), hide_default_value = true)]
    seed: u64,
    /// The binary in question
    #[arg(long, value_name = "PATH")]
    program: PathBuf,
    /// Another binary, which gets the same problems
    #[arg(long, value_name = "PATH")]
    against: Option<PathBuf>,
    /// Long chains of rows instead, which only have to be certified
    #[arg(long)]
    chains: bool,
    /// Write the first problem of each sort of fault and class into this folder
    #[arg(long, value_name = "FOLDER")]
    save: Option<PathBuf>,
    /// Only the problem of this number
    #[arg(long, value_name = "NUMBER")]
    only: Option<u64>,
}

impl Options {
    fn programs(&self) -> Vec<Program> {
        [Some(&self.program), self.against.as_ref()].into_iter().flatten().cloned().map(Program).collect()
    }

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

/// Runs the problems and prints the table. A promise that the first program breaks is a fault.
pub fn run(options: &Options) -> Result<(), Failure> {
    let (desk, judge) = (desk()?, if options.chains { chains } else { problems });
    let (faults, seconds) = timed(|| judge(options, &options.programs(), desk.path()));
    let faults = faults?;
    println!("{seconds:.0} s; seed {}", options.seed);
    no_faults(faults, "promises are broken")
}

/// Returns the number of faults of the first program.
fn problems(options: &Options, programs: &[Program], desk: &Path) -> io::Result<usize> {
    let (mut table, mut shown) = (Table::new(programs.len()), BTreeSet::new());
    for numbers in options.batches() {
        let judge = |number: u64| {
            let trial = Trial::draw(options.seed, number);
            let findings = trial.run(programs, &desk.join(number.to_string()))?;
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
    println!("{}", table.text(programs));
    Ok(table.faults())
}

fn about(trial: &Trial, fault: &Fault, again: &str) -> String {
    let exact = trial.exact.json(&trial.case);
    format!("{}: {}\n\n{}, {again}\n\nexact: {exact}\n", fault.sort.name(), fault.detail, trial.class.name())
}

/// Counts the chains that each program refuses. Returns the count of the first one.
fn chains(options: &Options, programs: &[Program], desk: &Path) -> io::Result<usize> {
    let mut refused = vec![0; programs.len()];
    for numbers in options.batches() {
        let ask = |number: u64| {
            let problem = chain(options.seed, number).map_err(io::Error::other)?;
            let directory = desk.join(number.to_string());
            write(&directory, &problem)?;
            let endings = programs.iter().map(|program| program.solve(&directory));
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
    for (program, count) in programs.iter().zip(&refused) {
        println!("{}: {count} of {} chains refused", program.0.display(), options.problems);
    }
    Ok(refused[0])
}
