//! Seconds, memory and error of the three faces of a contact problem: its conditions on all dofs, its quadratic program
//! on the contact dofs, and the complementarity problem of its forces, for shares of contact rows from 0.002 to 1.
//!
//! Blocks of cells under a parabola, and a membrane with an obstacle below every node. Each face has a process of its
//! own. Its seconds are the least of several rounds, with the certificate that belongs to it; its error is the bound of
//! the certificate of the contact problem, relative in energy; its memory is the peak of the process.

use serde_json::json;
use signorini::lcp::{Lcp, solve_lcp};
use signorini::qp::{Condense, InteriorPoint};
use signorini::{ContactProblem, Method, Prepared, Scene, Settings, solve};
use support::floors::membrane;

use crate::block::block;
use crate::clock::timed;
use crate::process::{Failure, child, peak_bytes};
use crate::table::table;

/// Cells of each block, along its top and in its height; the last is the side of the membrane.
const CASES: [[usize; 2]; 8] = [[60, 250], [125, 80], [250, 25], [500, 10], [600, 5], [700, 2], [700, 1], [30, 0]];

const FACES: [&str; 5] = ["kkt", "qp", "active-set", "lcp", "auto"];

/// Rounds, while they take less than this many seconds in all.
const ROUNDS: (usize, f64) = (15, 6.0);

/// Seconds, memory and error of KKT system, QP and LCP of one problem, for shares of contact rows from 0.002 to 1
#[derive(clap::Args)]
pub struct Options {
    /// One case alone, and one of its faces, as JSON
    #[arg(long, num_args = 2, value_names = ["CASE", "FACE"], hide = true)]
    only: Option<Vec<String>>,
}

/// A contact problem of some cells.
fn problem([along, height]: [usize; 2]) -> Result<ContactProblem, Failure> {
    if height == 0 {
        return Ok(membrane(along)?);
    }
    let lengths = [along as f64, height as f64];
    let depth = 0.02 * lengths[1];
    // The parabola meets the undeformed top on half of its length.
    let radius = (lengths[0] / 4.0).powi(2) / (2.0 * depth);
    let scene = Scene::from_json(&block(lengths, [along, height], "q4", radius, -depth).to_string(), "block")?;
    Ok(scene.build()?.problem().clone())
}

/// Solves one face: displacement and multiplier.
fn solved(problem: &ContactProblem, face: &str) -> Result<[Vec<f64>; 2], Failure> {
    let mut settings = Settings::default();
    match face {
        "kkt" => {
            let barrier = InteriorPoint { polish: false, ..InteriorPoint::default() };
            (settings.method, settings.condense, settings.tolerance) = (Method::Qp(barrier), Condense::Never, None);
        }
        "qp" => settings.method = Method::qp(),
        "active-set" => settings.method = Method::ActiveSet,
        "lcp" => {
            let made = Prepared::for_gaps(problem, 1, &settings)?.delassus()?;
            let (lower, upper) = (made.lower.clone(), made.upper.clone());
            let x = solve_lcp(&Lcp::new(made.matrix.clone(), made.offset.clone(), lower, upper)?, &settings)?.z;
            let mut multiplier = vec![0.0; problem.rows()];
            made.rows.iter().zip(&x).for_each(|(&row, z)| multiplier[row] = -z);
            return Ok([made.displacement(&x)?, multiplier]);
        }
        _ => {}
    }
    let solution = solve(problem, &settings)?;
    Ok([solution.displacement, solution.multiplier])
}

/// Prints seconds, peak memory and error of one face of one case.
fn one(case: &str, face: &str) -> Result<(), Failure> {
    let cells = CASES.get(case.parse::<usize>()?).ok_or("no such case")?;
    let problem = problem(*cells)?;
    let ([mut u, mut multiplier], mut least, mut all) = ([Vec::new(), Vec::new()], f64::INFINITY, 0.0);
    for _ in 0..ROUNDS.0 {
        let (answer, seconds) = timed(|| solved(&problem, face));
        ([u, multiplier], least, all) = (answer?, least.min(seconds), all + seconds);
        if all > ROUNDS.1 {
            break;
        }
    }
    let (n, m, bytes) = (problem.dofs(), problem.rows(), peak_bytes());
    let error = problem.certify(&u, &multiplier)?.energy_error_bound;
    println!("{}", json!({"n": n, "m": m, "seconds": least, "bytes": bytes, "error": error}));
    Ok(())
}

pub fn run(options: &Options) -> Result<(), Failure> {
    if let Some([case, face]) = options.only.as_deref() {
        return one(case, face);
    }
    let mut rows = Vec::new();
    for case in 0..CASES.len() {
        let (mut cells, mut seconds, mut sizes) = (String::new(), Vec::new(), [0.0; 2]);
        for face in FACES {
            let found = child(&["three_faces", "--only", &case.to_string(), face])?;
            let value = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
            sizes = [value("m"), value("n")];
            seconds.push(value("seconds"));
            let (ms, megabytes) = (1e3 * value("seconds"), value("bytes") / 1e6);
            cells += &match face {
                "auto" => format!(" | {ms:.1}"),
                _ => format!(" | {ms:.1} ms, {megabytes:.0} MB, {:.0e}", value("error")),
            };
        }
        let cheapest = seconds[..4].iter().copied().fold(f64::INFINITY, f64::min);
        rows.push(format!(
            "{} | {} | {:.3}{cells} | {:.2}",
            sizes[1],
            sizes[0],
            sizes[0] / sizes[1],
            seconds[4] / cheapest
        ));
    }
    print!(
        "{}",
        table("n | m | m/n | KKT | QP, interior point | QP, active set | LCP | `auto`, ms | over the cheapest", &rows)
    );
    Ok(())
}
