//! The errors of every time integration scheme for two bars whose impact is known exactly.
//!
//! GOAL: displacement, contact force, rebound and energy of every scheme at several steps.
//! CONDITIONS: a free bar that flies against a wall, and a held bar that bounces on it with the period 3.
//! REFERENCE: `closed_forms::ImpactingBar`, `closed_forms::BouncingBar` of `tests/support`.

mod rows;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::json;
use signorini::motion::SchemeSpec;
use signorini::study::MotionError;
use signorini::{Error, Scene, Settings};
use support::impact::cases::cases;
use support::impact::measure::{Run, moved, run as run_case, scene_of, set_up};

use crate::process::Failure;
use crate::table::{heading, row, show};

/// Time steps as multiples of the time that a wave takes through a cell.
const COURANT: [f64; 3] = [0.5, 1.0, 1.5];

/// The time steps of central differences, whose highest mode is not bounded at a factor of 1.
const EXPLICIT_COURANT: [f64; 2] = [0.5, 0.9];

const CELLS: usize = 100;

/// Two contacts with a shorter time between them are one: nodes leave and come back while the body turns around.
const PAUSE: f64 = 0.1;

/// Numbers of cells of the meshes for the convergence of the midpoint rule.
const REFINED: [usize; 4] = [50, 100, 200, 400];

/// Errors of every time scheme for two bars; a part has other bodies
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Options {
    #[command(subcommand)]
    part: Option<Part>,
    /// Folder for the table and for plots of pressure and energy over time
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Part {
    /// The peaks of a block that hits a wall flatly, and of a ball
    Bodies {
        /// Finer meshes
        #[arg(long)]
        long: bool,
    },
    /// Estimated errors of the peak beside true ones
    Errors,
    /// The beginnings of eleven contacts of a bar and of a block
    Bounces,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    match options.part {
        Some(Part::Bodies { long }) => return Ok(bodies(long)?),
        Some(Part::Errors) => return Ok(errors()?),
        Some(Part::Bounces) => return Ok(bounces()?),
        None => {}
    }
    let mut text = String::new();
    for case in &cases() {
        let mut runs = Vec::new();
        for scheme in SchemeSpec::ALL {
            let steps = match scheme {
                SchemeSpec::CentralDifference => &EXPLICIT_COURANT[..],
                // In a bar it has a step of its own.
                SchemeSpec::FoxGoodwin => &[1.0],
                _ => &COURANT,
            };
            for &courant in steps {
                runs.push(run_case(case, scheme, courant, CELLS)?);
            }
        }
        text += &rows::of_runs(case, &runs);
        for courant in COURANT {
            let refined = REFINED.into_iter().map(|cells| run_case(case, SchemeSpec::Midpoint, courant, cells));
            text += &rows::of_meshes(case, courant, &REFINED, &refined.collect::<Result<Vec<Run>, Error>>()?);
        }
        if let Some(folder) = &options.out {
            rows::plots(case, &runs).write(folder, case.scene)?;
        }
    }
    Ok(show(&text, options.out.as_deref(), "impact.md", &[])?)
}

/// Prints the peaks of a block that hits a wall flatly, over its first force `rho c v` on the whole side, and of a
/// ball, over a fine mesh.
fn bodies(is_long: bool) -> Result<(), Error> {
    print!("{}", heading(rows::BODIES));
    let first = 10.0 * (900.0_f64 * 0.7 / (1.3 * 0.4)).sqrt();
    let steps = [0.3, 0.5, 0.9, 1.5];
    for cells in if is_long { &[20, 40, 80][..] } else { &[20, 40] } {
        for scheme in [SchemeSpec::Midpoint, SchemeSpec::FoxGoodwin, SchemeSpec::ContactStabilised] {
            for courant in steps {
                let moved = moved(&scene_of("block", *cells), scheme, courant)?;
                print!("{}", rows::of_body("block", *cells, &moved, first));
            }
        }
    }
    let finest = if is_long { 36 } else { 18 };
    let reference = moved(&scene_of("ball", finest), SchemeSpec::FoxGoodwin, 0.5)?.summary.contact.peak_force();
    for courant in steps {
        for scheme in [SchemeSpec::Midpoint, SchemeSpec::FoxGoodwin] {
            print!("{}", rows::of_body("ball", 9, &moved(&scene_of("ball", 9), scheme, courant)?, reference));
        }
    }
    Ok(())
}

/// Prints the estimated error of the peak of twenty motions over the true one: that against the first force of a block,
/// `rho c v`, or of a ball against four times the cells and a fourth of the step.
fn errors() -> Result<(), Error> {
    let columns = "body | cells | Poisson's ratio | CFL | peak | estimated error | true error | ratio | resolved";
    print!("{}", heading(columns));
    let mut within = 0;
    let blocks = [10, 20].into_iter().flat_map(|cells| [0.0, 0.2, 0.3, 0.4].map(|poisson| ("block", cells, poisson)));
    let balls = [("ball", 4, 0.3), ("ball", 6, 0.2)];
    let all: Vec<_> = blocks.chain(balls).flat_map(|one| [0.5, 1.0].map(|courant| (one, courant))).collect();
    for &((name, cells, poisson), courant) in &all {
        let mut scene = scene_of(name, cells);
        scene["material"]["poisson"] = json!(poisson);
        let own = moved(&scene, SchemeSpec::FoxGoodwin, courant)?;
        let parsed: Scene = serde_json::from_value(scene).expect("a scene");
        let error = MotionError::of(&parsed, own.step, &own.summary, &Settings::default())?;
        let exact = match name {
            "block" => 10.0 * (900.0_f64 * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson))).sqrt(),
            _ => {
                let fine = serde_json::to_value(parsed.refined(4)?).expect("JSON");
                moved(&fine, SchemeSpec::FoxGoodwin, courant)?.summary.contact.peak_force()
            }
        };
        let peak = own.summary.contact.peak_force();
        let (estimated, off) = (error.peak_force / exact, (peak / exact - 1.0).abs());
        let ratio = estimated / off;
        within += usize::from((0.3..=3.0).contains(&ratio));
        let resolved = if error.resolved { "yes" } else { "no" };
        let errors = format!("{peak:.5e} | {estimated:.2e} | {off:.2e} | {ratio:.2} | {resolved}");
        print!("{}", row(&format!("{name} | {cells} | {poisson} | {courant} | {errors}")));
    }
    println!("\n{within} of {} ratios are within 0.3 and 3", all.len());
    Ok(())
}

/// Prints the beginnings of the contacts of a bar and of a block that fall and bounce, on several meshes, and the
/// energy that is left.
fn bounces() -> Result<(), Error> {
    print!("{}", heading("body | cells | contacts begin at | energy at the end"));
    for (name, meshes) in [("jumping_bar", &[100, 200, 400, 800][..]), ("bouncing_block", &[8, 16, 32, 64])] {
        for &cells in meshes {
            let (begins, energy) = contacts(&scene_of(name, cells))?;
            let shown: Vec<String> = begins.iter().map(|begin| format!("{begin:.3}")).collect();
            print!("{}", row(&format!("{name} | {cells} | {} | {energy:.5}", shown.join(", "))));
        }
    }
    Ok(())
}

/// The beginnings of the contacts of a motion, and the total energy at its end over that at the first contact: less
/// than 1 by what the scheme took.
fn contacts(scene: &serde_json::Value) -> Result<(Vec<f64>, f64), Error> {
    let (_, dynamics, mut integrator) = set_up(scene)?;
    let (mut begins, mut last, mut fallen) = (Vec::new(), f64::NEG_INFINITY, 0.0);
    for _ in 0..dynamics.steps {
        integrator.advance()?;
        let seen = integrator.observe();
        if seen.force > 0.0 {
            if seen.acting[0] - last > PAUSE {
                begins.push(seen.acting[0]);
            }
            if begins.len() == 1 && last == f64::NEG_INFINITY {
                fallen = seen.work;
            }
            last = seen.acting[1];
        }
    }
    let seen = integrator.observe();
    Ok((begins, 1.0 + (seen.kinetic + seen.strain - seen.work) / fallen))
}
