//! Elastic bodies as scenes: slabs, blocks and bars of Hex8 with uniform and graded meshes, and a layer of Q8.

use super::noise::noise;
use crate::block::{axis, block};
use serde_json::{Value, json};
use signorini::qp::NearNullSpace;
use signorini::{ContactProblem, Error, Scene, SparseMatrix, SymmetricMatrix};

/// A thin slab under a sphere, clamped at its left side.
pub fn slab(cells: usize, gap: f64) -> Result<ContactProblem, Error> {
    let mut slab = block([1.0, 1.0, 0.05], [cells, cells, 2], "hex8", 2.0, gap);
    slab["supports"][0]["on"]["boundary"] = json!("left");
    problem(&slab)
}

fn cube_of(cells: usize) -> Value {
    block([1.0; 3], [cells; 3], "hex8", 2.0, -0.01)
}

/// A cube of equal cells under a sphere, clamped at its bottom.
pub fn cube(cells: usize) -> Result<ContactProblem, Error> {
    problem(&cube_of(cells))
}

/// Uncoupled copies of a cube under a sphere, whose stiffnesses differ by up to four orders of magnitude.
pub fn blocks_apart(count: usize, cells: usize) -> Result<ContactProblem, Error> {
    let one = cube(cells)?;
    let (dofs, rows) = (one.dofs(), one.rows());
    let scales: Vec<f64> = (0..count).map(|body| 10.0_f64.powf(4.0 * noise(body))).collect();
    let copies = |matrix: &SparseMatrix, rows: usize, scales: &[f64]| -> Vec<(usize, usize, f64)> {
        let copy = |(body, &scale): (usize, &f64)| {
            matrix.triplets().map(move |(row, column, value)| (body * rows + row, body * dofs + column, scale * value))
        };
        scales.iter().enumerate().flat_map(copy).collect()
    };
    let stiffness = copies(one.stiffness().lower(), dofs, &scales);
    let stiffness = SparseMatrix::from_triplets(count * dofs, count * dofs, &stiffness)?;
    let contact = copies(one.contact(), rows, &vec![1.0; count]);
    let contact = SparseMatrix::from_triplets(count * rows, count * dofs, &contact)?;
    let load = scales.iter().flat_map(|&scale| one.load().iter().map(move |force| scale * force)).collect();
    let gap = (0..count).flat_map(|body| one.gap().iter().map(move |gap| gap + 0.004 * noise(7 * body))).collect();
    let modes = one.near_null().map_or(&[][..], |modes| modes.vectors());
    let modes = modes.iter().map(|mode| mode.repeat(count)).collect();
    let problem = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, load, contact, gap)?;
    Ok(problem.with_near_null(NearNullSpace::new(modes, count * dofs)?)?)
}

/// A cube under a sphere, clamped at its bottom, whose cells become smaller towards the contact; the largest is `ratio`
/// times the smallest along each axis.
pub fn graded_cube(cells: usize, ratio: f64) -> Result<ContactProblem, Error> {
    let mut cube = cube_of(cells);
    let half = cells / 2;
    let across = json!({"points": [0, 0.5, 1], "divisions": [half, half], "ratios": [1.0 / ratio, ratio]});
    let up = json!({"points": [0, 1], "divisions": [cells], "ratios": [1.0 / ratio]});
    cube["body"]["box"] = json!({"x": across, "y": across, "z": up, "element": "hex8"});
    problem(&cube)
}

/// A slender bar of Hex8 that is clamped at one end and bent over a sphere at half its length.
pub fn bar(cells: usize) -> Result<ContactProblem, Error> {
    problem(&json!({
        "model": "space",
        "body": {"box": {"x": axis(16.0, cells), "y": axis(1.0, 10), "z": axis(1.0, 10), "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.2},
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}],
        "loads": [{"body-force": [0, 0, 3e3]}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "closest-point",
                       "shape": {"sphere": {"apex": [8, 0.5, 1.02], "radius": 3}}}]
    }))
}

/// A thin, nearly incompressible layer in the plane, of Q8, under a wide round punch.
pub fn soft_layer(cells: usize) -> Result<ContactProblem, Error> {
    problem(&json!({
        "model": "plane-strain",
        "body": {"rectangle": {"x": axis(4.0, cells), "y": axis(0.2, cells / 20), "element": "q8"}},
        "material": {"young": 1e6, "poisson": 0.49},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [2, 0.2], "radius": 20}}}],
        "gap": -0.01
    }))
}

/// A nearly incompressible cube of Hex8 on rollers that is compressed between two plates.
pub fn jelly(cells: usize) -> Result<ContactProblem, Error> {
    problem(&json!({
        "model": "space",
        "body": {"box": {"x": axis(1.0, cells), "y": axis(1.0, cells), "z": axis(1.0, cells), "element": "hex8"}},
        "material": {"young": 1e6, "poisson": 0.48},
        "supports": [{"on": {"boundary": "bottom"}, "z": 0}, {"on": {"boundary": "left"}, "x": 0},
                     {"on": {"boundary": "front"}, "y": 0}],
        "loads": [{"pressure": {"boundary": "top", "value": 1e5}}],
        "obstacles": [{"boundary": "right", "approach": "+x",
                       "shape": {"plane": {"point": [1.02, 0, 0], "normal": [1, 0, 0]}}},
                      {"boundary": "back", "approach": "+y",
                       "shape": {"plane": {"point": [0, 1.01, 0], "normal": [0, 1, 0]}}}]
    }))
}

fn problem(scene: &Value) -> Result<ContactProblem, Error> {
    Ok(Scene::from_json(&scene.to_string(), "kind")?.build()?.problem().clone())
}
