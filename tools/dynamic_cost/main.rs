//! Compares the cost of a time step with contact, including its energies, with that of two triangular solves of the
//! same matrix.
//!
//! `cargo run --release --example dynamic_cost [-- --short]` runs square blocks of Q4 cells, clamped at the bottom,
//! that fly against a parabola; the short form runs only the smallest. The two triangular solves are one solution of
//! `K_eff x = b` by its own Cholesky factor, L y = b and L' x = y, without a special order for the contact dofs. Times
//! are means over all steps. Steps and solves are measured alternately, so that other work of the machine affects both
//! in the same way.

use std::time::Instant;

use serde_json::json;
use signorini::motion::Integrator;
use signorini::qp::Cholesky;
use signorini::{Scene, Settings, SparseMatrix, SymmetricMatrix};

/// Cells along a side of each block; the blocks have 8,320, 33,024 and 131,584 dofs.
const CELLS: [usize; 3] = [64, 128, 256];

const STEPS: usize = 200;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| dofs | rows | most closed | factorise [s] | two triangular solves [ms] | step [ms] | ratio | steps a second |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let is_short = std::env::args().nth(1).is_some_and(|argument| argument == "--short");
    for &cells in if is_short { &CELLS[..1] } else { &CELLS[..] } {
        let scene = Scene::from_json(&block(cells).to_string(), "block")?;
        let model = scene.build()?;
        let Some(dynamics) = scene.dynamics(&model)? else { continue };
        let (problem, scheme, step) = (dynamics.problem, dynamics.scheme, dynamics.step);
        let matrix = effective(problem.mass(), problem.statics().stiffness(), 4.0 / (step * step))?;
        let cholesky = factor(&matrix)?;
        let clock = Instant::now();
        let mut integrator = Integrator::new(problem, scheme, step, &Settings::default())?;
        let preparation = clock.elapsed().as_secs_f64();
        let (mut solves, mut steps, mut closed) = (Vec::new(), Vec::new(), 0);
        for _ in 0..STEPS {
            let clock = Instant::now();
            let x = cholesky.solve(&integrator.state().displacement);
            solves.push(clock.elapsed().as_secs_f64());
            assert_eq!(x.len(), model.problem().dofs());
            let clock = Instant::now();
            integrator.advance()?;
            let seen = integrator.observe();
            steps.push(clock.elapsed().as_secs_f64());
            closed = closed.max(seen.closed);
        }
        let [solves, steps] = [solves, steps].map(mean);
        println!(
            "| {} | {} | {closed} | {preparation:.3} | {:.2} | {:.2} | {:.2} | {:.0} |",
            model.problem().dofs(),
            model.rows().len(),
            1e3 * solves,
            1e3 * steps,
            steps / solves,
            1.0 / steps
        );
    }
    Ok(())
}

/// Returns the mean. The minimum would favour short work, which on a busy machine sometimes runs undisturbed, over
/// longer work.
fn mean(seconds: Vec<f64>) -> f64 {
    seconds.iter().sum::<f64>() / seconds.len() as f64
}

fn factor(matrix: &SymmetricMatrix) -> Result<Cholesky, signorini::qp::Error> {
    Cholesky::of(matrix)
}

/// A block that is clamped at its bottom, with an initial velocity of its top towards a parabola.
fn block(cells: usize) -> serde_json::Value {
    json!({
        "body": {"rectangle": {
            "x": {"points": [0, 1], "divisions": [cells]}, "y": {"points": [0, 1], "divisions": [cells]}}},
        "material": {"young": 1000, "poisson": 0.3, "density": 1},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [
            {"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 1], "radius": 2}}}],
        "analysis": {"dynamic": {
            "duration": 1, "initial": [{"velocity": {"value": [0, 0], "gradient": [[0, 0], [0, 5]]}}]}}
    })
}

/// Returns `factor M + K`.
fn effective(
    mass: &SymmetricMatrix,
    stiffness: &SymmetricMatrix,
    factor: f64,
) -> Result<SymmetricMatrix, signorini::Error> {
    let inertia = mass.lower().triplets().map(|(row, column, value)| (row, column, factor * value));
    let entries: Vec<_> = inertia.chain(stiffness.lower().triplets()).collect();
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_triplets(mass.dim(), mass.dim(), &entries)?)?)
}
