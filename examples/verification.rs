//! Prints the table of what is verified: case, unknowns, our value, exact value, relative error, seconds.
//!
//! `cargo run --release --example verification`

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};
use signorini::analytical::{Bar, ContactPatch, DiscMembrane, ObstacleString, Sides};
use signorini::{ContactProblem, Error, Model, Scene, SparseMatrix, SymmetricMatrix, solve_qp};

struct Line {
    case: String,
    unknowns: usize,
    quantity: &'static str,
    ours: f64,
    exact: f64,
    seconds: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut lines = Vec::new();
    bars(&mut lines)?;
    patches(&mut lines)?;
    obstacle_problems(&mut lines)?;
    stored_answers(&mut lines)?;
    println!("| case | unknowns | quantity | ours | exact | relative error | seconds |");
    println!("|---|---|---|---|---|---|---|");
    for Line { case, unknowns, quantity, ours, exact, seconds } in lines {
        let error = (ours - exact).abs() / exact.abs();
        println!("| {case} | {unknowns} | {quantity} | {ours:.9e} | {exact:.9e} | {error:.1e} | {seconds:.3} |");
    }
    Ok(())
}

fn model(scene: &Value) -> Result<Model, Error> {
    Scene::from_json(&scene.to_string(), "verification")?.build()
}

/// A bar of length 2 and EA = 100, gap 0.03: under an end force of 4, and under 4 per length.
fn bars(lines: &mut Vec<Line>) -> Result<(), Error> {
    let closed = Bar { length: 2.0, axial_stiffness: 100.0, gap: 0.03 };
    let cases = [
        (
            "bar, end force",
            json!({"traction": {"boundary": "right", "value": [40, 0]}}),
            closed.reaction_to_end_force(4.0),
        ),
        ("bar, distributed load", json!({"body-force": [40, 0]}), closed.reaction_to_distributed_load(4.0)),
    ];
    for (case, load, exact) in cases {
        let clock = Instant::now();
        let model = model(&json!({
            "model": "plane-stress",
            "body": {"rectangle": {"x": {"points": [0, 2], "divisions": [40]}, "y": {"points": [0, 0.1], "divisions": [1]}}},
            "material": {"young": 1e3, "poisson": 0},
            "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
            "loads": [load],
            "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2.03, 0], "normal": [1, 0]}}}],
        }))?;
        let ours = solve_qp(model.problem())?.contact_force();
        let unknowns = model.problem().dofs();
        lines.push(Line { case: case.into(), unknowns, quantity: "wall force", ours, exact, seconds: seconds(clock) });
    }
    Ok(())
}

/// A block pressed by 300 onto a plane: the pressure is 300 at every node, the width grows by nu' p/E.
fn patches(lines: &mut Vec<Line>) -> Result<(), Error> {
    for (state, sides) in [("plane-strain", Sides::PlaneStrain), ("plane-stress", Sides::PlaneStress)] {
        for element in ["t3", "q4"] {
            let clock = Instant::now();
            let model = model(&json!({
                "model": state,
                "body": {"rectangle": {
                    "x": {"points": [0, 1], "divisions": [12], "ratios": [3]},
                    "y": {"points": [0, 0.8], "divisions": [9], "ratios": [0.4]},
                    "element": element,
                }},
                "material": {"young": 2e5, "poisson": 0.3},
                "supports": [{"on": {"boundary": "left"}, "x": 0}],
                "loads": [{"traction": {"boundary": "top", "value": [0, -300]}}],
                "obstacles":
                    [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
            }))?;
            let solution = solve_qp(model.problem())?;
            let pressure = model.pressure(&solution.multiplier)?;
            let farthest = |exact: f64, values: &[f64]| {
                values.iter().copied().max_by(|a, b| (a - exact).abs().total_cmp(&(b - exact).abs())).unwrap_or(exact)
            };
            let case = format!("contact patch, {element}, {state}");
            let (unknowns, seconds) = (model.problem().dofs(), seconds(clock));
            let ours = farthest(300.0, &pressure);
            lines.push(Line { case: case.clone(), unknowns, quantity: "worst pressure", ours, exact: 300.0, seconds });
            let exact = ContactPatch { young: 2e5, poisson: 0.3, sides }.strains(300.0).0;
            let nodal = model.nodal_displacement(&solution.displacement)?;
            let right: Vec<f64> = (model.mesh().nodes().iter().enumerate())
                .filter(|(_, at)| at[0] == 1.0)
                .map(|(node, _)| nodal[2 * node])
                .collect();
            let ours = farthest(exact, &right);
            lines.push(Line { case, unknowns, quantity: "worst side displacement", ours, exact, seconds });
        }
    }
    Ok(())
}

/// A string of 2000 and a membrane of 800 linear elements on flat obstacles.
fn obstacle_problems(lines: &mut Vec<Line>) -> Result<(), Error> {
    let (cells, closed) = (2000, ObstacleString { load: 1.0, gap: 0.08 });
    let h = 1.0 / cells as f64;
    let clock = Instant::now();
    let stiffness: Vec<_> = (0..cells - 1)
        .flat_map(|i| [(i, i, 2.0 / h), ((i + 1).min(cells - 2), i, if i + 2 < cells { -1.0 / h } else { 0.0 })])
        .collect();
    let string = raw(&stiffness, vec![-closed.load * h; cells - 1], closed.gap)?;
    let ours = solve_qp(&string)?.contact_force();
    let (unknowns, exact, seconds_string) = (cells - 1, closed.force(), seconds(clock));
    lines.push(Line {
        case: "string on an obstacle".into(),
        unknowns,
        quantity: "force",
        ours,
        exact,
        seconds: seconds_string,
    });

    let (cells, closed) = (800, DiscMembrane { load: 8.0, gap: 0.25 });
    let h = 1.0 / cells as f64;
    let clock = Instant::now();
    let (mut stiffness, mut load) = (Vec::new(), vec![0.0; cells]);
    let circle = 2.0 * std::f64::consts::PI;
    for cell in 0..cells {
        let (left, right) = (cell as f64 * h, (cell + 1) as f64 * h);
        let k = circle * (left + right) / 2.0 / h;
        stiffness.push((cell, cell, k));
        load[cell] -= circle * closed.load * h * (2.0 * left + right) / 6.0;
        if cell + 1 < cells {
            stiffness.extend([(cell + 1, cell, -k), (cell + 1, cell + 1, k)]);
            load[cell + 1] -= circle * closed.load * h * (left + 2.0 * right) / 6.0;
        }
    }
    let ours = solve_qp(&raw(&stiffness, load, closed.gap)?)?.contact_force();
    let (exact, seconds) = (closed.force(), seconds(clock));
    lines.push(Line { case: "membrane over a disc".into(), unknowns: cells, quantity: "force", ours, exact, seconds });
    Ok(())
}

/// K from entries of its lower triangle, and a row -u <= gap for every dof.
fn raw(stiffness: &[(usize, usize, f64)], load: Vec<f64>, gap: f64) -> Result<ContactProblem, Error> {
    let n = load.len();
    let rows: Vec<_> = (0..n).map(|i| (i, i, -1.0)).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, stiffness)?)?;
    ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(n, n, &rows)?, vec![gap; n])
}

/// The indentation at three gaps against the stored answers of cvxpy, Clarabel and OSQP.
fn stored_answers(lines: &mut Vec<Line>) -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let stored: Value = serde_json::from_str(&std::fs::read_to_string(root.join("reference/results.json"))?)?;
    let base = Scene::read(root.join("examples/indentation.json"))?.build()?;
    for gap in [-0.01, -0.05, -0.1] {
        let clock = Instant::now();
        let model = base.with_gap(gap)?;
        let ours = solve_qp(model.problem())?.contact_force();
        let case = format!("indentation, gap {gap}, against cvxpy and OSQP");
        let exact = stored["cases"][format!("indentation {gap:.2}")]["force"].as_f64().ok_or("no stored force")?;
        let unknowns = model.problem().dofs();
        lines.push(Line { case, unknowns, quantity: "force", ours, exact, seconds: seconds(clock) });
    }
    Ok(())
}

fn seconds(clock: Instant) -> f64 {
    clock.elapsed().as_secs_f64()
}
