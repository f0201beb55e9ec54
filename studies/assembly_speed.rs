//! Seconds and bytes of the assembly of 1,000,000 dofs in Q4 and 300,000 dofs in Hex8, on one core.
//!
//! Each case runs in a process of its own, so that its peak memory can be measured. The peak includes the mesh, the
//! numbers of the dofs, the program itself and the finished matrix.

use serde_json::json;
use signorini::fem::{DofMap, ElasticBody, ElementKind, Formulation, Material, stiffness};
use signorini::scene::{cuboid, rectangle};

use crate::clock::timed;
use crate::process::{Failure, child, memory_bytes, no_faults};

/// Name of each case, and the seconds that its assembly must not exceed.
const CASES: [(&str, f64); 2] = [("Q4", 2.0), ("Hex8", 3.0)];

/// Largest allowed ratio of the peak memory to the bytes of the finished matrix.
const MOST_MEMORY: f64 = 1.5;

/// Seconds and bytes of the assembly of a million dofs
#[derive(clap::Args)]
pub struct Options {
    /// Assemble this case in this process, and print its numbers
    #[arg(value_parser = CASES.map(|case| case.0), hide = true)]
    case: Option<String>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    if let Some(name) = &options.case {
        return assemble(name);
    }
    let mut faults = 0;
    for (name, limit) in CASES {
        let found = child(&["assembly_speed", name])?;
        let [dofs, entries, seconds] =
            ["dofs", "entries", "seconds"].map(|key| found[key].as_f64().unwrap_or(f64::NAN));
        let (matrix, mega) = (8.0 * (dofs + 1.0) + 16.0 * entries, 1e-6);
        println!(
            "{name}: {dofs} dofs, {entries} entries, {seconds:.3} s (limit {limit} s), matrix {:.1} MB",
            matrix * mega
        );
        let mut fits = seconds < limit;
        if let (Some(before), Some(peak)) = (found["before"].as_f64(), found["peak"].as_f64()) {
            fits &= peak < MOST_MEMORY * matrix;
            println!(
                "    before {:.1} MB, peak {:.1} MB: {:.2} of the matrix (limit {MOST_MEMORY}), {:.2} by assembly alone",
                before * mega,
                peak * mega,
                peak / matrix,
                (peak - before) / matrix
            );
        }
        faults += usize::from(!fits);
    }
    no_faults(faults, "cases are above their limits")
}

/// Assembles a square of 707 x 706 cells, or a cube of 46 x 46 x 45.
fn assemble(name: &str) -> Result<(), Failure> {
    let lines = |cells: usize| (0..=cells).map(|i| i as f64 / cells as f64).collect::<Vec<f64>>();
    let (mesh, formulation) = if name == "Q4" {
        let mesh = rectangle(&lines(707), &lines(706), ElementKind::Q4)?;
        (mesh, Formulation::PlaneStrain { thickness: 1.0 })
    } else {
        (cuboid(&lines(46), &lines(46), &lines(45), ElementKind::Hex8)?, Formulation::Space)
    };
    let body = ElasticBody::new(mesh, Material::new(1e7, 0.3)?, formulation)?;
    let dofs = DofMap::new(vec![None; body.nodal_dofs()])?;
    let before = memory_bytes().map(|[now, _]| now);
    let (stiffness, seconds) = timed(|| stiffness(&body, &dofs));
    let stiffness = stiffness?;
    let peak = memory_bytes().map(|[_, peak]| peak);
    let (dofs, entries) = (stiffness.dim(), stiffness.lower().entries());
    println!("{}", json!({"dofs": dofs, "entries": entries, "seconds": seconds, "before": before, "peak": peak}));
    Ok(())
}
