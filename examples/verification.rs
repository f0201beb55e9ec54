//! Prints the tables of what is verified: answers against exact values, and errors of manufactured blocks with their rates.
//!
//! `cargo run --release --example verification [-- --out DIR]`; a folder gets the tables as Markdown and CSV, and plots of
//! the errors over the cell size.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};
use signorini::analytical::manufactured::{ContactSolution, GenericEdge, HertzBlock, PlaneElasticity, Smooth};
use signorini::analytical::{
    Bar, Cone, ContactPatch, DiscMembrane, FlatDisc, FlatStrip, LineContact, ObstacleString, PointContact, Sides, Wedge,
};
use signorini::body::Integration;
use signorini::element::ElementKind;
use signorini::norm::ErrorNorms;
use signorini::output::{Drawing, Plot, Quantity, Scale, Series, line_plots, write_files, write_picture};
use signorini::scene::ContactRow;
use signorini::study::{BlockErrors, NodalPressure, solve_block};
use signorini::{ContactProblem, Error, Model, Scene, Solution, SparseMatrix, SymmetricMatrix, solve_qp};

struct Line {
    case: String,
    unknowns: usize,
    quantity: &'static str,
    ours: f64,
    exact: f64,
    seconds: f64,
}

/// Errors of one element on one manufactured block, from coarse to fine.
struct Family {
    name: &'static str,
    kind: ElementKind,
    /// Cells along a side.
    cells: Vec<usize>,
    blocks: Vec<BlockErrors>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut lines = Vec::new();
    bars(&mut lines)?;
    patches(&mut lines)?;
    obstacle_problems(&mut lines)?;
    stored_answers(&mut lines)?;
    hertz_and_punches(&mut lines)?;
    let mut rows = vec![
        "case | unknowns | quantity | ours | exact | relative error | seconds".to_owned(),
        "---|---|---|---|---|---|---".into(),
    ];
    for Line { case, unknowns, quantity, ours, exact, seconds } in lines {
        let error = (ours - exact).abs() / exact.abs();
        rows.push(format!("{case} | {unknowns} | {quantity} | {ours:.9e} | {exact:.9e} | {error:.1e} | {seconds:.3}"));
    }
    let families = families()?;
    let mut errors = vec![
        "block | element | cells | unknowns | energy error | rate | L2 error | rate | peak pressure, ours | exact | seconds".to_owned(),
        "---|---|---|---|---|---|---|---|---|---|---".into(),
    ];
    for Family { name, kind, cells, blocks } in &families {
        for (index, block) in blocks.iter().enumerate() {
            let rate = |value: fn(&BlockErrors) -> f64| match index {
                0 => String::new(),
                _ => format!("{:.2}", (value(&blocks[index - 1]) / value(block)).log2()),
            };
            let peak = |value: fn(&NodalPressure) -> f64| block.pressure.iter().map(value).fold(0.0, f64::max);
            let BlockErrors { unknowns, errors: ErrorNorms { energy, l2 }, seconds, .. } = block;
            errors.push(format!(
                "{name} | {} | {} | {unknowns} | {energy:.3e} | {} | {l2:.3e} | {} | {:.5} | {:.5} | {seconds:.3}",
                kind.name(),
                cells[index],
                rate(|b| b.errors.energy),
                rate(|b| b.errors.l2),
                peak(|at| at.ours),
                peak(|at| at.exact)
            ));
        }
    }
    let table = |rows: &[String]| rows.iter().map(|row| format!("| {row} |\n")).collect::<String>();
    let text = format!("{}\n{}", table(&rows), table(&errors));
    print!("{text}");
    let mut arguments = std::env::args().skip(1);
    if let (Some("--out"), Some(folder)) = (arguments.next().as_deref(), arguments.next()) {
        let csv = |rows: &[String]| {
            let quoted =
                |row: &String| row.split(" | ").map(|cell| format!("\"{cell}\"")).collect::<Vec<_>>().join(",") + "\n";
            rows.iter().enumerate().filter(|row| row.0 != 1).map(|row| quoted(row.1)).collect::<String>()
        };
        let folder = Path::new(&folder);
        write_files(folder, &[("verification.md", text), ("answers.csv", csv(&rows)), ("errors.csv", csv(&errors))])?;
        for name in ["smooth", "generic edge", "Hertz"] {
            let slope = if name == "smooth" { 2.0 } else { 1.5 };
            write_picture(folder, &name.to_lowercase().replace(' ', "-"), &error_plots(name, slope, &families))?;
        }
    }
    Ok(())
}

/// The manufactured blocks with every element of the plane.
fn families() -> Result<Vec<Family>, Error> {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.3);
    let smooth = Smooth { elasticity, opening: 1.0, pressure: 1.0, edge: 0.5, power: 3 };
    let edge = GenericEdge { elasticity, edge: 0.53, pressure: 1.0 };
    let hertz = HertzBlock { elasticity, half_width: 0.53, peak_pressure: 1.0 };
    let exact: [(&str, &dyn ContactSolution); 3] = [("smooth", &smooth), ("generic edge", &edge), ("Hertz", &hertz)];
    let mut families = Vec::new();
    for (name, exact) in exact {
        for kind in [ElementKind::T3, ElementKind::Q4, ElementKind::T6, ElementKind::Q8] {
            let cells = vec![8, 16, 32, 64, 128];
            let block = |&cells: &usize| solve_block(exact, kind, Integration::Standard, cells);
            let blocks = cells.iter().map(block).collect::<Result<_, _>>()?;
            families.push(Family { name, kind, cells, blocks });
        }
    }
    Ok(families)
}

/// Errors in energy and L2 over the cell size, and the slopes expected of linear and quadratic elements in energy.
fn error_plots(name: &str, quadratic_slope: f64, families: &[Family]) -> Drawing {
    let panel = |title: &str, value: fn(&BlockErrors) -> f64, slopes: &[f64]| {
        let mut series: Vec<Series> = Vec::new();
        let mut ends: Vec<[f64; 2]> = Vec::new();
        for family in families.iter().filter(|family| family.name == name) {
            let points: Vec<_> =
                family.cells.iter().zip(&family.blocks).map(|(&n, block)| [1.0 / n as f64, value(block)]).collect();
            ends.extend(points.first());
            series.push(Series::new(family.kind.name(), points));
        }
        for (index, slope) in slopes.iter().enumerate() {
            // A little above the line of Q4 or Q8.
            let [h, error] = ends[2 * index + 1];
            let at = |n: f64| [1.0 / n, 0.6 * error * (1.0 / n / h).powf(*slope)];
            series.push(Series::new(format!("slope {slope}"), vec![at(8.0), at(128.0)]));
        }
        let plot = Plot::new(Quantity::new("cell size h", ""), Quantity::new("relative error", ""), series);
        Plot { title: title.into(), scales: [Scale::Logarithmic; 2], ..plot }
    };
    let l2 = if name == "smooth" { vec![2.0, 3.0] } else { vec![2.0] };
    let panels = [
        panel("energy norm", |block| block.errors.energy, &[1.0, quadratic_slope]),
        panel("L2 norm", |block| block.errors.l2, &l2),
    ];
    line_plots(&format!("Manufactured block: {name}"), &panels)
}

/// Rigid punches on a large block, in the plane and about an axis; it reaches 200 contact radii, 0.1, in each direction.
///
/// In the plane pressures are compared at the force that was found; the approach depends on the body.
fn hertz_and_punches(lines: &mut Vec<Line>) -> Result<(), Error> {
    let modulus = 1.0 / 0.91;
    let pressed = |state: &str, shape: Value, approach: f64| -> Result<(Model, Solution, f64), Error> {
        let clock = Instant::now();
        // 40 equal cells over 0.2, then growing to the far side.
        let model = model(&json!({
            "model": state,
            "body": {"rectangle": {
                "x": {"points": [0, 0.2, 20], "divisions": [40, 44], "ratios": [1, 500]},
                "y": {"points": [-20, -0.2, 0], "divisions": [44, 40], "ratios": [0.002, 1]}}},
            "material": {"young": 1, "poisson": 0.3},
            "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "shape": shape}],
            "gap": -approach,
        }))?;
        let solution = solve_qp(model.problem())?;
        Ok((model, solution, seconds(clock)))
    };
    let parabola = json!({"parabola": {"apex": [0, 0], "radius": 1}});
    let wedge = json!({"wedge": {"apex": [0, 0], "slope": 0.1}});
    // Flat up to 0.1, out of reach from the next node on.
    let flat = json!({"table": {"points": [[0, 0], [0.1, 0], [0.1025, 1], [20, 1]]}});
    let mut push = |case: &str, model: &Model, quantity, ours, exact, seconds| {
        let unknowns = model.problem().dofs();
        lines.push(Line { case: case.into(), unknowns, quantity, ours, exact, seconds });
    };
    let at = |model: &Model, solution: &Solution, x: f64| -> Result<f64, Error> {
        let pressure = model.pressure(&solution.multiplier)?;
        let away = |row: &ContactRow| (model.mesh().nodes()[row.node][0] - x).abs();
        let nearest = model.rows().iter().zip(pressure).min_by(|a, b| away(a.0).total_cmp(&away(b.0)));
        Ok(nearest.map_or(f64::NAN, |row| row.1))
    };
    // The plane model is one half of the body.
    let line = LineContact { modulus, radius: 1.0 };
    let (model, answer, clock) = pressed("plane-strain", parabola.clone(), 0.02)?;
    let force = 2.0 * answer.contact_force();
    push(
        "cylinder on a block, Q4",
        &model,
        "pressure at x = 0",
        at(&model, &answer, 0.0)?,
        line.peak_pressure(force),
        clock,
    );
    let closed = Wedge { slope: 0.1, modulus };
    let (model, answer, clock) = pressed("plane-strain", wedge.clone(), 0.02)?;
    let force = 2.0 * answer.contact_force();
    let x = 0.02;
    push(
        "wedge on a block, Q4",
        &model,
        "pressure at x = 0.02",
        at(&model, &answer, x)?,
        closed.pressure(force, x),
        clock,
    );
    let closed = FlatStrip { half_width: 0.1 };
    let (model, answer, clock) = pressed("plane-strain", flat.clone(), 0.02)?;
    let force = 2.0 * answer.contact_force();
    push(
        "flat strip on a block, Q4",
        &model,
        "pressure at x = 0",
        at(&model, &answer, 0.0)?,
        closed.pressure(force, 0.0),
        clock,
    );
    let point = PointContact { modulus, radius: 1.0 };
    let (model, answer, clock) = pressed("axisymmetric", parabola, 0.01)?;
    let force = answer.contact_force();
    push("sphere on a block, axisymmetric Q4", &model, "force", force, point.force(0.01), clock);
    push(
        "sphere on a block, axisymmetric Q4",
        &model,
        "pressure at r = 0",
        at(&model, &answer, 0.0)?,
        point.peak_pressure(force),
        clock,
    );
    let closed = Cone { slope: 0.1, modulus };
    let (model, answer, clock) = pressed("axisymmetric", wedge, 0.01)?;
    let force = answer.contact_force();
    push("cone on a block, axisymmetric Q4", &model, "force", force, closed.force(0.01), clock);
    push(
        "cone on a block, axisymmetric Q4",
        &model,
        "pressure at r = 0.02",
        at(&model, &answer, x)?,
        closed.pressure(force, x),
        clock,
    );
    let closed = FlatDisc { radius: 0.1, modulus };
    let (model, answer, clock) = pressed("axisymmetric", flat, 0.01)?;
    let force = answer.contact_force();
    push("flat disc on a block, axisymmetric Q4", &model, "force", force, closed.force(0.01), clock);
    push(
        "flat disc on a block, axisymmetric Q4",
        &model,
        "pressure at r = 0",
        at(&model, &answer, 0.0)?,
        closed.pressure(force, 0.0),
        clock,
    );
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
