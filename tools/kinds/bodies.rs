//! Elastic bodies as scenes: slabs, blocks and bars of Hex8 with uniform and graded meshes, and a layer of Q8.

use super::noise::noise;
use serde_json::{Value, json};
use signorini::qp::NearNullSpace;
use signorini::{ContactProblem, Error, Scene, SparseMatrix, SymmetricMatrix};

/// An axis with cells of equal size.
fn even(length: f64, cells: usize) -> Value {
    json!({"points": [0, length], "divisions": [cells]})
}

/// An axis from 0 to 1 whose cells become smaller near `towards`; the largest is `ratio` times the smallest.
fn graded(cells: usize, ratio: f64, towards: f64) -> Value {
    let sides: &[f64] = if towards == 0.5 { &[0.5, 0.5] } else { &[1.0] };
    let half = cells / sides.len();
    let growth = ratio.powf(1.0 / (half - 1) as f64);
    let whole = (growth.powi(half as i32) - 1.0) / (growth - 1.0);
    let from_fine = |count: usize| (growth.powi(count as i32) - 1.0) / (growth - 1.0) / whole;
    let mut points: Vec<f64> = (0..=half).map(|count| towards - sides[0] * from_fine(half - count)).collect();
    if sides.len() == 2 {
        points.extend((1..=half).map(|count| towards + sides[1] * from_fine(count)));
    }
    (points[0], *points.last_mut().unwrap_or(&mut 1.0)) = (points[0], 1.0);
    points[0] = 0.0;
    json!({"points": points, "divisions": vec![1; points.len() - 1]})
}

fn built(axes: [Value; 3], held: &str, height: f64, gap: f64) -> Result<ContactProblem, Error> {
    let [x, y, z] = axes;
    scene(json!({
        "model": "space",
        "body": {"box": {"x": x, "y": y, "z": z, "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": held}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach",
                       "shape": {"sphere": {"apex": [0.5, 0.5, height], "radius": 2}}}],
        "gap": gap
    }))
}

/// A thin slab under a sphere, clamped at its left side.
pub fn slab(cells: usize, gap: f64) -> Result<ContactProblem, Error> {
    built([even(1.0, cells), even(1.0, cells), even(0.05, 2)], "left", 0.05, gap)
}

/// A cube of equal cells under a sphere, clamped at its bottom.
pub fn block(cells: usize) -> Result<ContactProblem, Error> {
    built([even(1.0, cells), even(1.0, cells), even(1.0, cells)], "bottom", 1.0, -0.01)
}

/// Uncoupled copies of a cube under a sphere, whose stiffnesses differ by up to four orders of magnitude.
pub fn blocks_apart(count: usize, cells: usize) -> Result<ContactProblem, Error> {
    let one = block(cells)?;
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

/// A cube under a sphere, clamped at its bottom, whose cells become smaller towards the contact.
pub fn graded_block(cells: usize, ratio: f64) -> Result<ContactProblem, Error> {
    let across = || graded(cells, ratio, 0.5);
    built([across(), across(), graded(cells, ratio, 1.0)], "bottom", 1.0, -0.01)
}

/// A slender bar of Hex8 that is clamped at one end and bent over a sphere at half its length.
pub fn bar(cells: usize) -> Result<ContactProblem, Error> {
    scene(json!({
        "model": "space",
        "body": {"box": {"x": even(16.0, cells), "y": even(1.0, 10), "z": even(1.0, 10), "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.2},
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}],
        "loads": [{"body-force": [0, 0, 3e3]}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "closest-point",
                       "shape": {"sphere": {"apex": [8, 0.5, 1.02], "radius": 3}}}]
    }))
}

/// A thin, nearly incompressible layer in the plane, of Q8, under a wide round punch.
pub fn soft_layer(cells: usize) -> Result<ContactProblem, Error> {
    scene(json!({
        "model": "plane-strain",
        "body": {"rectangle": {"x": even(4.0, cells), "y": even(0.2, cells / 20), "element": "q8"}},
        "material": {"young": 1e6, "poisson": 0.49},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [2, 0.2], "radius": 20}}}],
        "gap": -0.01
    }))
}

/// A nearly incompressible cube of Hex8 on rollers that is compressed between two plates.
pub fn jelly(cells: usize) -> Result<ContactProblem, Error> {
    scene(json!({
        "model": "space",
        "body": {"box": {"x": even(1.0, cells), "y": even(1.0, cells), "z": even(1.0, cells), "element": "hex8"}},
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

fn scene(scene: Value) -> Result<ContactProblem, Error> {
    Ok(Scene::from_json(&scene.to_string(), "kind")?.build()?.problem().clone())
}
