//! Elastic bodies in space, as scenes: slabs and blocks of Hex8, even and graded.

use serde_json::{Value, json};
use signorini::{ContactProblem, Error, Scene};

/// An axis with even cells.
fn even(length: f64, cells: usize) -> Value {
    json!({"points": [0, length], "divisions": [cells]})
}

/// An axis from 0 to 1 whose cells shrink towards `towards`, the largest `ratio` times the smallest.
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
    let scene = json!({
        "model": "space",
        "body": {"box": {"x": x, "y": y, "z": z, "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": held}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach",
                       "shape": {"sphere": {"apex": [0.5, 0.5, height], "radius": 2}}}],
        "gap": gap
    });
    Ok(Scene::from_json(&scene.to_string(), "kind")?.build()?.problem().clone())
}

/// A thin slab, clamped at its left side, under a sphere.
pub fn slab(cells: usize, gap: f64) -> Result<ContactProblem, Error> {
    built([even(1.0, cells), even(1.0, cells), even(0.05, 2)], "left", 0.05, gap)
}

/// A cube of equal cells, clamped below, under a sphere.
pub fn block(cells: usize) -> Result<ContactProblem, Error> {
    built([even(1.0, cells), even(1.0, cells), even(1.0, cells)], "bottom", 1.0, -0.01)
}

/// A cube whose cells shrink towards the place of contact, clamped below, under a sphere.
pub fn graded_block(cells: usize, ratio: f64) -> Result<ContactProblem, Error> {
    let across = || graded(cells, ratio, 0.5);
    built([across(), across(), graded(cells, ratio, 1.0)], "bottom", 1.0, -0.01)
}
