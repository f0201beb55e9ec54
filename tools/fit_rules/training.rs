//! The problems to which the rules are fitted, and the ten problems on which they are checked.

use std::path::Path;

use serde_json::{Value, json};
use signorini::{ContactProblem, Error, Scene, SparseMatrix, SymmetricMatrix};

type Problems = Vec<(String, ContactProblem)>;

/// The training problems: blocks of growing size, clamped at the bottom and pressed from above, and strings and
/// membranes over an obstacle with small and large loads.
pub fn training() -> Result<Problems, Error> {
    let mut problems = Vec::new();
    for cells in [8, 16, 32, 64, 128, 256] {
        problems.push((format!("block Q4 {cells}"), scene(&block(cells, "q4"))?));
    }
    for cells in [8, 16, 32, 64] {
        problems.push((format!("block T3 {cells}"), scene(&block(cells, "t3"))?));
    }
    for cells in [8, 16, 32, 64] {
        problems.push((format!("block Q8 {cells}"), scene(&block(cells, "q8"))?));
    }
    for cells in [4, 6, 8, 12, 16] {
        problems.push((format!("block Hex8 {cells}"), scene(&brick(cells))?));
    }
    for (nodes, weight) in
        [(20, 0.2), (40, 0.08), (60, 0.2), (120, 0.2), (160, 0.08), (250, 0.2), (500, 0.08), (600, 0.2)]
    {
        problems.push((format!("string {nodes} under {weight}"), string(nodes, weight)?));
    }
    for (nodes, weight) in [(10, 8.0), (20, 8.0), (30, 30.0), (40, 8.0), (80, 8.0), (100, 4.0), (120, 8.0)] {
        problems.push((format!("membrane {nodes} under {weight}"), membrane(nodes, weight)?));
    }
    Ok(problems)
}

/// The problems of the check: the scenes of the examples, and a brick, a string and a membrane of other sizes and
/// loads.
pub fn others() -> Result<Problems, Error> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let mut problems = Vec::new();
    for name in ["bar", "between", "block", "circle", "inclined", "indentation", "two_cylinders"] {
        let model = Scene::read(Path::new(&format!("{folder}/{name}.json")))?.build()?;
        problems.push((name.to_string(), model.problem().clone()));
    }
    problems.push(("string 350, light".to_string(), string(350, 0.05)?));
    problems.push(("membrane 55, heavy".to_string(), membrane(55, 20.0)?));
    problems.push(("brick 10".to_string(), scene(&brick(10))?));
    Ok(problems)
}

fn scene(scene: &Value) -> Result<ContactProblem, Error> {
    Ok(Scene::from_json(&scene.to_string(), "training")?.build()?.problem().clone())
}

fn block(cells: usize, element: &str) -> Value {
    json!({
        "title": "block",
        "model": "plane-strain",
        "body": { "rectangle": {
            "x": { "points": [0, 1], "divisions": [cells] },
            "y": { "points": [0, 1], "divisions": [cells] },
            "element": element,
        } },
        "material": { "young": 1e7, "poisson": 0.3 },
        "supports": [{ "on": { "boundary": "bottom" }, "x": 0, "y": 0 }],
        "obstacles": [{
            "boundary": "top",
            "approach": "+y",
            "rule": "approach",
            "shape": { "parabola": { "apex": [0.5, 1.0], "radius": 1 } },
        }],
        "gap": -0.01,
    })
}

fn brick(cells: usize) -> Value {
    let axis = json!({ "points": [0, 1], "divisions": [cells] });
    json!({
        "title": "brick",
        "model": "space",
        "body": { "box": { "x": axis, "y": axis, "z": axis, "element": "hex8" } },
        "material": { "young": 1e7, "poisson": 0.3 },
        "supports": [{ "on": { "boundary": "bottom" }, "x": 0, "y": 0, "z": 0 }],
        "obstacles": [{
            "boundary": "top",
            "approach": "+z",
            "rule": "approach",
            "shape": { "sphere": { "apex": [0.5, 0.5, 1], "radius": 1 } },
        }],
        "gap": -0.01,
    })
}

/// A string of unit length and tension, fixed at both ends, that is pressed onto a hump.
fn string(nodes: usize, weight: f64) -> Result<ContactProblem, Error> {
    let h = 1.0 / (nodes + 1) as f64;
    let mut entries = Vec::new();
    for node in 0..nodes {
        entries.push((node, node, 2.0 / h));
        if node > 0 {
            entries.push((node, node - 1, -1.0 / h));
        }
    }
    let gap = (1..=nodes).map(|node| 0.01 + 0.1 * (node as f64 * h - 0.5).powi(2)).collect();
    over_an_obstacle(nodes, &entries, vec![weight * h * 10.0; nodes], gap)
}

/// A square membrane with `nodes` x `nodes` inner nodes, fixed at its edges, that is pressed onto a hump.
fn membrane(nodes: usize, weight: f64) -> Result<ContactProblem, Error> {
    let h = 1.0 / (nodes + 1) as f64;
    let mut entries = Vec::new();
    let mut gap = Vec::new();
    for row in 0..nodes {
        for column in 0..nodes {
            let node = row * nodes + column;
            entries.push((node, node, 4.0));
            if column > 0 {
                entries.push((node, node - 1, -1.0));
            }
            if row > 0 {
                entries.push((node, node - nodes, -1.0));
            }
            let (x, y) = ((column + 1) as f64 * h - 0.5, (row + 1) as f64 * h - 0.5);
            gap.push(0.05 + 0.5 * (x * x + y * y));
        }
    }
    over_an_obstacle(nodes * nodes, &entries, vec![weight * h * h; nodes * nodes], gap)
}

fn over_an_obstacle(
    dofs: usize,
    entries: &[(usize, usize, f64)],
    load: Vec<f64>,
    gap: Vec<f64>,
) -> Result<ContactProblem, Error> {
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, entries)?)?;
    let rows: Vec<_> = (0..dofs).map(|dof| (dof, dof, 1.0)).collect();
    Ok(ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(dofs, dofs, &rows)?, gap)?)
}
