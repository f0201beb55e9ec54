//! Fuzzing: random damage to the files of every reader, and random contact problems.
//!
//! `cargo run --release --example fuzz -- TARGET INPUTS [SEED] [--keep]` with the target `scene`, `mesh`, `matrix` or
//! `problem`. A reader gets files of `tests/faults` in which bytes are changed, cut, doubled or swapped. It may refuse
//! them, but it must neither panic nor take long. The target `problem` solves contact problems with damaged data. Each
//! must end with an error, or with an answer whose conditions hold when they are recomputed. Runs with the same seed
//! are identical. The first input that fails is printed and ends the run.
//!
//! The target `exact` compares every answer of the program with exact arithmetic: `fuzz exact PROBLEMS [SEED] [--kind
//! NAME] [--only NUMBER] [--save FOLDER] [--all]`, or `fuzz exact --answer DIRECTORY` for the exact answer of one
//! problem. See `exact.rs`.
//!
//! The target `promises` runs binaries of the program as a user does, and compares what they print with exact
//! arithmetic: `fuzz promises PROBLEMS [SEED] --program PATH [--against PATH] [--save FOLDER] [--only NUMBER]`.
//! `fuzz promises --chains PROBLEMS` has long chains of rows instead, which only have to be certified. See
//! `promises.rs`.
//!
//! With `--keep`, the first input of every ending that is new to `tests/faults` and `tests/corpus` is written into
//! `tests/corpus`, which `tests/files/corpus.rs` replays.

mod desk;
mod exact;
mod promises;

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use desk::desk;
use support::draws::Draws;
use support::fuzz::damage::{damaged, fault, faults, read, wording};
use support::fuzz::problem;

/// Seconds above which an input counts as taking too long.
const LONG: f64 = 5.0;

/// The files of each target; the target `problem` has no files.
const TARGETS: [(&str, &[&str]); 4] = [
    ("scene", &["plane.json", "space.json", "round.json"]),
    ("mesh", &["square2.msh", "square4.msh", "square2b.msh", "square4b.msh"]),
    ("matrix", &["K.mtx", "f.mtx", "B.mtx", "g.mtx"]),
    ("problem", &[]),
];

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

fn main() -> ExitCode {
    let all: Vec<String> = std::env::args().skip(1).collect();
    if all.first().is_some_and(|target| target == "exact") {
        return exact::run(&all[1..]);
    }
    if all.first().is_some_and(|target| target == "promises") {
        return promises::run(&all[1..]);
    }
    let (options, arguments): (Vec<String>, Vec<String>) = all.into_iter().partition(|word| word == "--keep");
    let target = TARGETS.iter().find(|target| arguments.first().is_some_and(|name| name == target.0));
    let inputs = arguments.get(1).and_then(|text| text.parse::<u64>().ok());
    let seed = arguments.get(2).map_or(Some(1), |text| text.parse::<u64>().ok());
    let (Some((target, files)), Some(inputs), Some(seed), Ok(desk)) = (target, inputs, seed, desk()) else {
        eprintln!("usage: fuzz scene|mesh|matrix|problem INPUTS [SEED] [--keep]");
        return ExitCode::from(2);
    };
    // All matrices of a problem are needed to replay the kept files, for every target.
    TARGETS[2].1.iter().for_each(|name| drop(fs::copy(faults(name), desk.path().join(name))));
    let files: Vec<(&str, Vec<u8>)> =
        files.iter().map(|name| (*name, fs::read(faults(name)).unwrap_or_default())).collect();
    let mut kept = match options.is_empty() {
        true => None,
        false => match fs::create_dir_all(corpus()).and_then(|()| Kept::read(desk.path())) {
            Ok(kept) => Some(kept),
            Err(error) => {
                eprintln!("tests/corpus: {error}");
                return ExitCode::FAILURE;
            }
        },
    };
    let (mut draws, mut accepted, mut longest) = (Draws(seed), 0_u64, 0.0_f64);
    for number in 0..inputs {
        let (start, before) = (Instant::now(), draws.clone());
        let result = input(&files, &mut draws, desk.path(), &mut kept);
        let seconds = start.elapsed().as_secs_f64();
        longest = longest.max(seconds);
        match result {
            Ok(passed) if seconds < LONG => accepted += u64::from(passed),
            fault => {
                let fault = fault.err().unwrap_or_else(|| format!("{seconds:.1} s"));
                eprintln!("input {number} of seed {seed} (or the first of seed {}): {fault}", before.0);
                return ExitCode::FAILURE;
            }
        }
    }
    let new = kept.map_or(String::new(), |kept| format!(", {} kept", kept.new));
    println!(
        "{target}: {inputs} inputs of seed {seed}, {accepted} accepted{new}, no panic and no wrong answer; the longest took \
         {:.1} ms",
        1e3 * longest
    );
    ExitCode::SUCCESS
}
