//! Random damage: files of every reader, and contact problems, changed until something gives way.
//!
//! `cargo run --release --example fuzz -- TARGET INPUTS [SEED]` with the target `scene`, `mesh`, `matrix` or `problem`. A
//! reader gets files of `tests/faults` with bytes changed, cut, doubled or swapped, and may refuse them, but not panic. A
//! problem gets damaged dense data, and must end with an answer whose conditions hold when they are recomputed in dense
//! arithmetic, or with an error. Runs with the same seed are the same; a panic ends the run after the input is printed.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use signorini::matrix_market::read_problem;
use signorini::mesh::gmsh::GmshFile;
use signorini::{ContactProblem, Error, Scene, SparseMatrix, SymmetricMatrix, solve_qp};

/// Conditions of an answer that is certified to 1e-9, recomputed.
const HOLDS: f64 = 1e-7;

/// splitmix64.
struct Draws(u64);

impl Draws {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }

    fn signed(&mut self) -> f64 {
        self.below(1 << 30) as f64 / (1 << 29) as f64 - 1.0
    }
}

/// Words that readers stumble over.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e999",
    "1e-999",
    "nan",
    "inf",
    "-inf",
    "18446744073709551616",
    "99999999999",
    "2.5",
    "\"",
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "null",
    "true",
    "\n",
    " ",
    "\u{feff}",
    "\0",
    "$EndNodes",
];

/// A few changes of a text, most of them small.
fn damaged(draws: &mut Draws, text: &[u8]) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..1 + draws.below(4) {
        let (from, length) = (draws.below(bytes.len() + 1), draws.below(12));
        let to = (from + length).min(bytes.len());
        match draws.below(6) {
            0 => drop(bytes.splice(from..to, WORDS[draws.below(WORDS.len())].bytes())),
            1 => drop(bytes.drain(from..to)),
            2 => {
                let copy = bytes[from..to].to_vec();
                let at = draws.below(bytes.len() + 1);
                bytes.splice(at..at, copy);
            }
            3 if from < bytes.len() => bytes[from] = draws.below(256) as u8,
            4 if from < bytes.len() => bytes[from] ^= 1 << draws.below(8),
            _ if draws.below(20) == 0 => bytes.truncate(from),
            _ => {}
        }
    }
    bytes
}

fn faults(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults").join(name)
}

/// Reads damaged text, and builds what can be read, if it is small.
fn read(target: &str, name: &str, bytes: &[u8], desk: &Path) -> Result<(), Error> {
    let text = String::from_utf8_lossy(bytes);
    /// Scenes of more nodes would only take time.
    const FEW_NODES: f64 = 2000.0;
    match target {
        "scene" => {
            let scene = Scene::from_json(&text, name)?;
            if scene.size().nodes < FEW_NODES { scene.build().map(drop) } else { Ok(()) }
        }
        "mesh" => GmshFile::parse(&text, name)?.mesh(None, 1.0).map(drop),
        _ => {
            let io = |source| Error::File { action: "write", path: desk.into(), source };
            std::fs::write(desk.join(name), bytes).map_err(io)?;
            read_problem(desk).map(drop)
        }
    }
}

/// A folder for the files of a problem, in memory where there is such a place.
fn desk() -> std::io::Result<tempfile::TempDir> {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }
}

/// A problem of few dofs, often degenerate or hostile.
fn problem(draws: &mut Draws) -> Result<ContactProblem, Error> {
    let (n, m) = (1 + draws.below(6), draws.below(7));
    let rank = 1 + draws.below(n + 1);
    let factor: Vec<f64> = (0..n * rank).map(|_| if draws.below(3) == 0 { 0.0 } else { draws.signed() }).collect();
    let scale = if draws.below(4) == 0 { 2.0_f64.powi(draws.below(1200) as i32 - 600) } else { 1.0 };
    let mut stiffness = Vec::new();
    for i in 0..n {
        for j in 0..=i {
            let product: f64 = (0..rank).map(|k| factor[i * rank + k] * factor[j * rank + k]).sum();
            stiffness.push((i, j, scale * (product + if i == j && draws.below(2) == 0 { 0.1 } else { 0.0 })));
        }
    }
    let number = |draws: &mut Draws| match draws.below(12) {
        0 => 0.0,
        1 => draws.signed() * 1e-12,
        2 => draws.signed() * 1e12,
        _ => draws.signed(),
    };
    let mut contact = Vec::new();
    for row in 0..m {
        for _ in 0..1 + draws.below(2) {
            contact.push((row, draws.below(n), number(draws)));
        }
    }
    let load = (0..n).map(|_| scale * number(draws)).collect();
    let gap = (0..m).map(|_| if draws.below(10) == 0 { f64::INFINITY } else { number(draws) }).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &stiffness)?)?;
    ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(m, n, &contact)?, gap)
}

/// Do penetration, sign and complementarity of an answer hold, recomputed?
fn holds(problem: &ContactProblem, u: &[f64], lambda: &[f64]) -> bool {
    let largest = |values: &[f64]| values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    let moved = problem.contact().mul(u);
    let force = largest(problem.load()).max(largest(&problem.contact().mul_transposed(lambda)));
    let stiffness = largest(&problem.stiffness().diagonal());
    let still = if stiffness > 0.0 { force / stiffness } else { 0.0 };
    let strongest = largest(lambda);
    (0..problem.rows()).all(|row| {
        let gap = problem.gap()[row];
        let touched = if lambda[row] != 0.0 || moved[row] > gap { gap.abs() } else { 0.0 };
        let reach = largest(&moved).max(touched).max(still);
        let distance = moved[row] - gap;
        let product = if lambda[row] == 0.0 { 0.0 } else { (lambda[row] * distance).abs() };
        lambda[row] <= HOLDS * strongest && distance <= HOLDS * reach && product <= HOLDS * strongest * reach
    })
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let inputs = arguments.get(1).and_then(|text| text.parse::<u64>().ok());
    let seed = arguments.get(2).map_or(Some(1), |text| text.parse::<u64>().ok());
    let files: &[&str] = match arguments.first().map(String::as_str) {
        Some("scene") => &["plane.json", "space.json", "round.json"],
        Some("mesh") => &["square2.msh", "square4.msh"],
        Some("matrix") => &["K.mtx", "f.mtx", "B.mtx", "g.mtx"],
        Some("problem") => &[],
        _ => {
            eprintln!("usage: fuzz scene|mesh|matrix|problem INPUTS [SEED]");
            return ExitCode::from(2);
        }
    };
    let (Some(inputs), Some(seed), Ok(desk)) = (inputs, seed, desk()) else {
        eprintln!("usage: fuzz scene|mesh|matrix|problem INPUTS [SEED]");
        return ExitCode::from(2);
    };
    let corpus: Vec<(&str, Vec<u8>)> =
        files.iter().map(|name| (*name, std::fs::read(faults(name)).unwrap_or_default())).collect();
    corpus.iter().for_each(|(name, text)| drop(std::fs::write(desk.path().join(name), text)));
    let (mut draws, mut accepted) = (Draws(seed), 0_u64);
    for input in 0..inputs {
        let target = arguments[0].as_str();
        let passed = if target == "problem" {
            let mut at = Draws(draws.0);
            draws.below(2);
            let result = catch_unwind(AssertUnwindSafe(|| {
                let Ok(problem) = problem(&mut at) else { return (false, true) };
                match solve_qp(&problem) {
                    Ok(solution) => (true, holds(&problem, &solution.displacement, &solution.multiplier)),
                    Err(_) => (false, true),
                }
            }));
            match result {
                Ok((solved, true)) => Ok(solved),
                Ok((_, false)) => Err("a certified answer whose conditions do not hold".to_string()),
                Err(_) => Err("a panic".to_string()),
            }
        } else {
            let (name, text) = &corpus[draws.below(corpus.len())];
            let bytes = damaged(&mut draws, text);
            let result = catch_unwind(AssertUnwindSafe(|| read(target, name, &bytes, desk.path()).is_ok()));
            if target == "matrix" {
                drop(std::fs::write(desk.path().join(name), text));
            }
            result.map_err(|_| format!("a panic on {name}: {:?}", String::from_utf8_lossy(&bytes)))
        };
        match passed {
            Ok(passed) => accepted += u64::from(passed),
            Err(fault) => {
                eprintln!("input {input} of seed {seed}: {fault}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("{}: {inputs} inputs of seed {seed}, {accepted} accepted, no panic and no wrong answer", arguments[0]);
    ExitCode::SUCCESS
}
