//! Shapes a punch so that it presses uniformly: the force is held, and the heights of its profile follow from
//! derivatives.
//!
//! `cargo run --release --example uniform_pressure [-- CELLS [PICTURE.svg]]`

use std::sync::Arc;
use std::time::Instant;

use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use signorini::output::{Plot, Quantity, Series, line_plots, write_files};
use signorini::qp::Change;
use signorini::scene::Answer;
use signorini::{Error, Model, Prepared, Scene, Settings};

/// Half the width of the punch, which stands in the middle of a block of 1 m: from node to node of 16, 32, 64 or more
/// cells.
const HALF: f64 = 3.0 / 16.0;

/// The profile is flat, plus even polynomials up to twice this degree.
const MODES: usize = 8;

/// The share of the width in which the pressure is to be uniform.
const INSIDE: f64 = 0.9;

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let cells = arguments.next().and_then(|cells| cells.parse().ok()).unwrap_or(64);
    let clock = Instant::now();
    let scene = Scene::from_json(&block(cells).to_string(), "punch")?;
    let model = Arc::new(scene.build()?);
    let problem = model.problem();
    let at: Vec<f64> = model.rows().iter().map(|row| (model.mesh().nodes()[row.node][0] - 0.5) / HALF).collect();
    let mode = |degree: usize| at.iter().map(|x| x.powi(2 * degree as i32)).collect::<Vec<f64>>();
    let inside: Vec<usize> = (0..at.len()).filter(|&row| at[row].abs() <= INSIDE).collect();

    // The stiffness is factorised once, for all profiles.
    let prepared = Prepared::for_gaps(problem, 3, &Settings::default().with_proof())?;
    let mut gap = problem.gap().to_vec();
    let mut profiles = Vec::new();
    for step in 0..3 {
        let solution = prepared.solve(&gap)?;
        let pressure = Answer::of(model.clone(), &solution)?.pressure().to_vec();
        let ratio = peak_over_mean(&pressure, &inside);
        println!("profile {step}: peak over mean pressure {ratio:.3}, {:.1} s", clock.elapsed().as_secs_f64());
        profiles.push(pressure.clone());
        if ratio < 1.01 {
            break;
        }
        // The derivative of every pressure with respect to the share of each mode: one solve with the factor at hand.
        let derivatives = prepared.with_gap(gap.clone())?.derivatives(&solution)?;
        let mut columns = Vec::new();
        for degree in 1..=MODES {
            let tangent = derivatives.tangent(&Change::of_gap(mode(degree), problem.dofs()))?;
            let tangent = tangent.proven().expect("every row is proven");
            columns.push(model.pressure(&tangent.multiplier)?);
        }
        let off = |pressure: &[f64]| {
            let mean = inside.iter().map(|&row| pressure[row]).sum::<f64>() / inside.len() as f64;
            DVector::from_iterator(inside.len(), inside.iter().map(|&row| pressure[row] - mean))
        };
        let columns: Vec<DVector<f64>> = columns.iter().map(|column| off(column)).collect();
        let shares = DMatrix::from_columns(&columns).svd(true, true).solve(&-off(&pressure), 1e-12);
        let shares = shares.expect("the singular vectors are there");
        for degree in 1..=MODES {
            gap.iter_mut().zip(mode(degree)).for_each(|(gap, height)| *gap += shares[degree - 1] * height);
        }
    }
    if let Some(picture) = arguments.next() {
        let places: Vec<f64> = at.iter().map(|x| 0.5 + HALF * x).collect();
        draw(&model, &places, &profiles, &picture)?;
    }
    Ok(())
}

/// A block with a flat punch, which a force presses into its top.
fn block(cells: usize) -> Value {
    let axis = json!({"points": [0, 1], "divisions": [cells]});
    json!({
        "title": "A punch on a block",
        "model": "plane-strain",
        "body": {"rectangle": {"x": axis, "y": axis, "element": "q4"}},
        "material": {"young": 210e9, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "parts": [{"name": "under the punch", "of": "top", "box": {"min": [0.5 - HALF, 1], "max": [0.5 + HALF, 1]}}],
        "obstacles": [{"boundary": "under the punch", "approach": "+y", "force": 1e6,
                       "shape": {"table": {"points": [[0.5 - HALF, 1], [0.5 + HALF, 1]]}}}]
    })
}

fn peak_over_mean(pressure: &[f64], rows: &[usize]) -> f64 {
    let peak = rows.iter().fold(0.0, |peak: f64, &row| peak.max(pressure[row]));
    peak * rows.len() as f64 / rows.iter().map(|&row| pressure[row]).sum::<f64>()
}

/// The pressure of each profile.
fn draw(model: &Model, places: &[f64], profiles: &[Vec<f64>], file: &str) -> Result<(), Error> {
    let line = |name: &str, pressure: &[f64]| {
        Series::new(name, places.iter().zip(pressure).map(|(&x, &p)| [x, p / 1e6]).collect())
    };
    let (first, last) = (&profiles[0], &profiles[profiles.len() - 1]);
    let lines = vec![line("flat punch", first), line("shaped punch", last)];
    let plot = Plot::new(Quantity::new("x", "m"), Quantity::new("contact pressure", "MPa"), lines);
    let drawing = line_plots(model.title(), &[plot]);
    write_files(std::path::Path::new("."), &[(file, &drawing.svg())])
}
