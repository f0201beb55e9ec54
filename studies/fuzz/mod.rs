//! Fuzzing: random damage to the files of every reader, and random contact problems.
//!
//! A reader gets files of `tests/faults` in which bytes are changed, cut, doubled or swapped. It may refuse them, but
//! it must neither panic nor take long. The target `problem` solves contact problems with damaged data. Each must end
//! with an error, or with an answer whose conditions hold when they are recomputed. Runs with the same seed are
//! identical. The first input that fails is printed and ends the run. `tests/files/corpus.rs` replays what `--keep` has
//! kept.
#![expect(clippy::disallowed_methods, reason = "a panic is a finding")]

mod counts;
mod desk;
mod exact;
mod promises;

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use support::draws::Draws;
use support::fuzz::damage::{damaged, fault, faults, read, wording};
use support::fuzz::problem;

use crate::clock::timed;
use crate::process::Failure;
use desk::desk;

/// Seconds above which an input counts as taking too long.
const LONG: f64 = 5.0;

/// The files of a problem.
const MATRICES: [&str; 4] = ["K.mtx", "f.mtx", "B.mtx", "g.mtx"];

/// Random damage to files, and random problems beside exact arithmetic
#[derive(Args)]
pub struct Options {
    #[command(subcommand)]
    target: Target,
}

#[derive(Subcommand)]
enum Target {
    /// Damaged scenes
    Scene(Damage),
    /// Damaged meshes of Gmsh
    Mesh(Damage),
    /// Damaged matrices
    Matrix(Damage),
    /// Problems with damaged data
    Problem(Damage),
    Exact(exact::Options),
    Promises(promises::Options),
}

#[derive(Args)]
struct Damage {
    inputs: u64,
    #[arg(default_value_t = 1)]
    seed: u64,
    /// Write the first input of every ending that is new to `tests/faults` and `tests/corpus` into `tests/corpus`
    #[arg(long)]
    keep: bool,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    match &options.target {
        Target::Scene(damage) => inputs("scene", &["plane.json", "space.json", "round.json"], damage),
        Target::Mesh(damage) => inputs("mesh", &["square2.msh", "square4.msh", "square2b.msh", "square4b.msh"], damage),
        Target::Matrix(damage) => inputs("matrix", &MATRICES, damage),
        Target::Problem(damage) => inputs("problem", &[], damage),
        Target::Exact(options) => exact::run(options),
        Target::Promises(options) => promises::run(options),
    }
}

fn corpus() -> PathBuf {
    support::root().join("tests/corpus")
}

/// The known endings, the number of files that were kept for them, and the number of new ones.
struct Kept {
    known: BTreeSet<String>,
    files: usize,
    new: usize,
}

impl Kept {
    /// Reads the known endings: code and message of each line of `tests/faults/cases.jsonl`, and the files of
    /// `tests/corpus`.
    fn read(desk: &Path) -> std::io::Result<Self> {
        let (mut known, mut files) = (BTreeSet::new(), 0);
        for line in fs::read_to_string(faults("cases.jsonl"))?.lines() {
            let case: Vec<String> = serde_json::from_str(line)?;
            if let [_, _, _, code, sentence] = &case[..] {
                known.insert(wording(code, sentence));
            }
        }
        for file in fs::read_dir(corpus()).into_iter().flatten() {
            let file = file?.path();
            if file.is_dir() {
                continue;
            }
            files += 1;
            let stem = file.file_name().and_then(|name| name.to_str()).and_then(|name| name.split_once('-'));
            let extension = file.extension().and_then(|extension| extension.to_str());
            match (stem, extension) {
                (Some((stem, _)), Some(extension)) => {
                    let name = format!("{stem}.{extension}");
                    known.extend(read(&name, &fs::read(&file)?, desk).err().map(|error| fault(&error)));
                    drop(fs::copy(faults(&name), desk.join(name)));
                }
                _ => {
                    let endings = fs::read_to_string(&file)?;
                    known.extend(endings.lines().filter_map(|line| Some(line.split_once(' ')?.1.to_string())));
                }
            }
        }
        Ok(Kept { known, files, new: 0 })
    }

    fn is_new(&mut self, ending: String) -> bool {
        let is_new = self.known.insert(ending);
        self.new += usize::from(is_new);
        is_new
    }
}

/// Runs one input. Returns `true` if it was accepted, `false` if it was refused, and the fault as an error.
fn input(files: &[(&str, Vec<u8>)], draws: &mut Draws, desk: &Path, kept: &mut Option<Kept>) -> Result<bool, String> {
    if files.is_empty() {
        let at = draws.clone();
        draws.below(2);
        let ending = catch_unwind(AssertUnwindSafe(|| problem::ending(&mut at.clone())));
        let ending = ending.map_err(|_| format!("a panic of the problem from {}", at.0))??;
        let accepted = ending.starts_with("qp");
        if kept.as_mut().is_some_and(|kept| kept.is_new(ending.clone())) {
            let file = corpus().join("problems");
            let before = fs::read_to_string(&file).unwrap_or_default();
            fs::write(file, format!("{before}{} {ending}\n", at.0)).map_err(|error| error.to_string())?;
        }
        return Ok(accepted);
    }
    let (name, text) = &files[draws.below(files.len())];
    let bytes = damaged(draws, text);
    let result = catch_unwind(AssertUnwindSafe(|| read(name, &bytes, desk)));
    if name.ends_with(".mtx") {
        drop(fs::write(desk.join(name), text));
    }
    let result = result.map_err(|_| format!("a panic on {name}: {:?}", String::from_utf8_lossy(&bytes)))?;
    if let (Err(error), Some(kept)) = (&result, kept)
        && kept.is_new(fault(error))
    {
        let (stem, extension) = name.split_once('.').unwrap_or((name, ""));
        let file = corpus().join(format!("{stem}-{}-{}.{extension}", error.code(), kept.files + kept.new));
        fs::write(file, &bytes).map_err(|error| error.to_string())?;
    }
    Ok(result.is_ok())
}

fn inputs(target: &str, files: &[&str], &Damage { inputs, seed, keep }: &Damage) -> Result<(), Failure> {
    let desk = desk()?;
    // All matrices of a problem are needed to replay the kept files, for every target.
    MATRICES.iter().for_each(|name| drop(fs::copy(faults(name), desk.path().join(name))));
    let files: Vec<(&str, Vec<u8>)> =
        files.iter().map(|name| (*name, fs::read(faults(name)).unwrap_or_default())).collect();
    let mut kept = match keep {
        true => Some(fs::create_dir_all(corpus()).and_then(|()| Kept::read(desk.path()))?),
        false => None,
    };
    let (mut draws, mut accepted, mut longest) = (Draws(seed), 0_u64, 0.0_f64);
    for number in 0..inputs {
        let before = draws.0;
        let (result, seconds) = timed(|| input(&files, &mut draws, desk.path(), &mut kept));
        longest = longest.max(seconds);
        match result {
            Ok(passed) if seconds < LONG => accepted += u64::from(passed),
            fault => {
                let fault = fault.err().unwrap_or_else(|| format!("{seconds:.1} s"));
                return Err(format!("input {number} of seed {seed} (or the first of seed {before}): {fault}").into());
            }
        }
    }
    let new = kept.map_or(String::new(), |kept| format!(", {} kept", kept.new));
    println!(
        "{target}: {inputs} inputs of seed {seed}, {accepted} accepted{new}, no panic and no wrong answer; the longest took \
         {:.1} ms",
        1e3 * longest
    );
    Ok(())
}
