//! The cost of a time step with contact, including its energies, beside two triangular solves of the same matrix.
//!
//! Square blocks of Q4 cells, clamped at the bottom, fly against a parabola. The two triangular solves are one solution
//! of `K_eff x = b` by its own Cholesky factor, L y = b and L' x = y, without a special order for the contact dofs.
//! Times are means over all steps. Steps and solves are measured alternately, so that other work of the machine affects
//! both in the same way.

use serde_json::json;
use signorini::motion::Integrator;
use signorini::qp::Cholesky;
use signorini::{Scene, Settings};

use crate::block::block;
use crate::clock::timed;
use crate::process::Failure;
use crate::table::{heading, row};

/// Cells along a side of each block; the blocks have 8,320, 33,024 and 131,584 dofs.
const CELLS: [usize; 3] = [64, 128, 256];

const STEPS: usize = 200;

/// Cost of a time step with contact beside two triangular solves
#[derive(clap::Args)]
pub struct Options {
    /// Only the smallest block
    #[arg(long)]
    short: bool,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let columns = "factorise [s] | two triangular solves [ms] | step [ms] | ratio | steps a second";
    print!("{}", heading(&format!("dofs | rows | most closed | {columns}")));
    for &cells in if options.short { &CELLS[..1] } else { &CELLS[..] } {
        let scene = Scene::from_json(&flying(cells).to_string(), "block")?;
        let model = scene.build()?;
        let Some(dynamics) = scene.dynamics(&model)? else { continue };
        let (problem, scheme, step) = (dynamics.problem, dynamics.scheme, dynamics.step);
        let effective = problem.statics().stiffness().combined(1.0, 4.0 / (step * step), problem.mass())?;
        let cholesky = Cholesky::of(&effective)?;
        let (integrator, preparation) = timed(|| Integrator::new(problem, scheme, step, &Settings::default()));
        let mut integrator = integrator?;
        let (mut solves, mut steps, mut closed) = (0.0, 0.0, 0);
        for _ in 0..STEPS {
            let (x, seconds) = timed(|| cholesky.solve(&integrator.state().displacement));
            solves += seconds;
            assert_eq!(x.len(), model.problem().dofs());
            let (seen, seconds) = timed(|| integrator.advance().map(drop).map(|()| integrator.observe()));
            steps += seconds;
            closed = closed.max(seen?.closed);
        }
        // The minimum would favour short work, which on a busy machine sometimes runs undisturbed, over longer work.
        let [solve, step] = [solves, steps].map(|sum| sum / STEPS as f64);
        let cells = format!(
            "{} | {} | {closed} | {preparation:.3} | {:.2} | {:.2} | {:.2} | {:.0}",
            model.problem().dofs(),
            model.rows().len(),
            1e3 * solve,
            1e3 * step,
            step / solve,
            1.0 / step
        );
        print!("{}", row(&cells));
    }
    Ok(())
}

/// A block that is clamped at its bottom, with an initial velocity of its top towards a parabola.
fn flying(cells: usize) -> serde_json::Value {
    let mut scene = block([1.0; 2], [cells; 2], "q4", 2.0, 0.0);
    scene["material"] = json!({"young": 1000, "poisson": 0.3, "density": 1});
    let velocity = json!({"value": [0, 0], "gradient": [[0, 0], [0, 5]]});
    scene["analysis"] = json!({"dynamic": {"duration": 1, "initial": [{"velocity": velocity}]}});
    scene
}
