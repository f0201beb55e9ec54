//! Measures seconds and bytes of the assembly of 1,000,000 dofs in Q4 and 300,000 dofs in Hex8, on one core:
//! `cargo run --release --example assembly_speed`.
//!
//! Each case runs in a process of its own, so that its peak memory can be measured. The peak includes the mesh, the
//! numbers of the dofs, the program itself and the finished matrix.

use std::process::{Command, ExitCode};
use std::time::Instant;

use signorini::Error;
use signorini::fem::{DofMap, ElasticBody, ElementKind, Formulation, Material, Mesh, stiffness};
use signorini::scene::{cuboid, rectangle};

/// Name of each case, and the seconds that its assembly must not exceed.
const CASES: [(&str, f64); 2] = [("Q4", 2.0), ("Hex8", 3.0)];

/// Largest allowed ratio of the peak memory to the bytes of the finished matrix.
const MOST_MEMORY: f64 = 1.5;

fn lines(cells: usize) -> Vec<f64> {
    (0..=cells).map(|i| i as f64 / cells as f64).collect()
}

/// A square of 707 x 706 cells, or a cube of 46 x 46 x 45.
fn mesh(name: &str) -> Result<(Mesh, Formulation), Error> {
    if name == "Q4" {
        let mesh = rectangle(&lines(707), &lines(706), ElementKind::Q4)?;
        return Ok((mesh, Formulation::PlaneStrain { thickness: 1.0 }));
    }
    let mesh = cuboid(&lines(46), &lines(46), &lines(45), ElementKind::Hex8)?;
    Ok((mesh, Formulation::Space))
}

/// Returns an entry of `/proc/self/status` in bytes, or `None` if the system has no such file.
fn status(key: &str) -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024.0)
}

fn run(name: &str, limit: f64) -> Result<bool, Error> {
    let (mesh, formulation) = mesh(name)?;
    let body = ElasticBody::new(mesh, Material::new(1e7, 0.3)?, formulation)?;
    let dofs = DofMap::new(vec![None; body.nodal_dofs()])?;
    let before = status("VmRSS");
    let clock = Instant::now();
    let stiffness = stiffness(&body, &dofs)?;
    let seconds = clock.elapsed().as_secs_f64();
    let entries = stiffness.lower().entries();
    let matrix = (8 * (stiffness.dim() + 1) + 16 * entries) as f64;
    let million = 1e-6;
    println!(
        "{name}: {} dofs, {entries} entries, {seconds:.3} s (limit {limit} s), matrix {:.1} MB",
        stiffness.dim(),
        matrix * million
    );
    let mut fits = seconds < limit;
    if let (Some(before), Some(peak)) = (before, status("VmHWM")) {
        fits &= peak < MOST_MEMORY * matrix;
        println!(
            "    before {:.1} MB, peak {:.1} MB: {:.2} of the matrix (limit {MOST_MEMORY}), {:.2} by assembly alone",
            before * million,
            peak * million,
            peak / matrix,
            (peak - before) / matrix
        );
    }
    Ok(fits)
}

fn main() -> ExitCode {
    if let Some(name) = std::env::args().nth(1) {
        let limit = CASES.iter().find(|case| case.0 == name).map_or(0.0, |case| case.1);
        return match run(&name, limit) {
            Ok(true) => ExitCode::SUCCESS,
            Ok(false) => ExitCode::FAILURE,
            Err(error) => {
                eprintln!("{error}");
                ExitCode::FAILURE
            }
        };
    }
    let alone = |name: &str| {
        let program = std::env::current_exe().ok()?;
        Command::new(program).arg(name).status().ok().filter(|status| status.success())
    };
    let all = CASES.iter().filter(|case| alone(case.0).is_some()).count() == CASES.len();
    if all { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
