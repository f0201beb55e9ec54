//! Prints the errors of every time integration scheme for two bars whose impact is known exactly.
//!
//! `cargo run --release --example impact [-- --out DIR]`; with a folder, the table and plots of pressure and energy
//! over time are written into it.

mod table;

use std::path::Path;

use signorini::Error;
use signorini::motion::SchemeSpec;
use signorini::output::write_files;
use support::impact::cases::cases;
use support::impact::measure::{Run, run};

/// Time steps as multiples of the time that a wave takes through a cell.
const COURANT: [f64; 3] = [0.5, 1.0, 1.5];

/// The time steps of central differences, whose highest mode is not bounded at a factor of 1.
const EXPLICIT_COURANT: [f64; 2] = [0.5, 0.9];

const CELLS: usize = 100;

/// Numbers of cells of the meshes for the convergence of the default scheme.
const REFINED: [usize; 4] = [50, 100, 200, 400];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut text = String::new();
    let mut arguments = std::env::args().skip(1);
    let folder = match (arguments.next().as_deref(), arguments.next()) {
        (Some("--out"), Some(folder)) => Some(folder),
        _ => None,
    };
    for case in &cases() {
        let mut runs = Vec::new();
        for scheme in SchemeSpec::ALL {
            let steps = if scheme == SchemeSpec::CentralDifference { &EXPLICIT_COURANT[..] } else { &COURANT };
            for &courant in steps {
                runs.push(run(case, scheme, courant, CELLS)?);
            }
        }
        text += &table::of_runs(case, &runs);
        for courant in COURANT {
            let refined = REFINED.into_iter().map(|cells| run(case, SchemeSpec::Midpoint, courant, cells));
            text += &table::of_meshes(case, courant, &REFINED, &refined.collect::<Result<Vec<Run>, Error>>()?);
        }
        if let Some(folder) = &folder {
            table::plots(case, &runs).write(Path::new(folder), case.scene)?;
        }
    }
    print!("{text}");
    if let Some(folder) = &folder {
        write_files(Path::new(folder), &[("impact.md", text)])?;
    }
    Ok(())
}
