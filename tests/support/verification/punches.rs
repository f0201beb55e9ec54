//! GOAL: pressures and forces of rigid punches on a large block: flat, wedge and cone, cylinder and sphere.
//! CONDITIONS: plane strain and about an axis; the block extends 500 contact radii (of 0.1) in each direction. In the
//! plane, pressures are compared for the computed force, because the approach depends on the size of the body.
//! REFERENCE: the half space, by `closed_forms::punch` and `closed_forms::hertz`.

use crate::closed_forms::{Cone, FlatDisc, FlatStrip, LineContact, PointContact, Wedge};
use serde_json::{Value, json};
use signorini::Error;

use super::answer::{Answer, Solved};

/// Poisson's ratio; Young's modulus is 1.
const POISSON: f64 = 0.3;
const MODULUS: f64 = 1.0 / (1.0 - POISSON * POISSON);

/// Size of the block, and half width of the flat punches.
const SIZE: f64 = 50.0;
const HALF_WIDTH: f64 = 0.1;

/// Cells of equal size up to 0.15, around the contact, which grow from there to the far sides.
fn even() -> Value {
    json!({"rectangle": {
        "x": {"points": [0, 0.15, SIZE], "divisions": [30, 24], "ratios": [1, 2000]},
        "y": {"points": [-SIZE, -0.15, 0], "divisions": [24, 20], "ratios": [0.0005, 0.5]},
        "element": "q8"}})
}

/// Cells that become smaller towards the surface and towards the edge of a flat punch, at which the pressure is
/// infinite.
fn graded() -> Value {
    json!({"rectangle": {
        "x": {"points": [0, HALF_WIDTH, 0.2, SIZE], "divisions": [50, 30, 50], "ratios": [0.01, 100, 1000]},
        "y": {"points": [-SIZE, -0.1, 0], "divisions": [50, 50], "ratios": [0.001, 0.01]},
        "element": "q4"}})
}

fn pressed(state: &str, body: &Value, shape: &Value, approach: f64) -> Result<Solved, Error> {
    Solved::of(&json!({
        "model": state,
        "body": body,
        "material": {"young": 1, "poisson": POISSON},
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": shape}],
        "gap": -approach,
    }))
}

/// Compares the pressure at the contact node nearest to `place` with the exact pressure there.
fn pressure(solved: &Solved, case: &str, axis: &str, place: f64, exact: impl Fn(f64) -> f64) -> Answer {
    let [at, ours] = solved.pressure_near(place);
    solved.answer(case, format!("pressure at {axis} = {at:.2}"), ours, exact(at))
}

pub fn punches() -> Result<Vec<Answer>, Error> {
    let (even, graded) = (even(), graded());
    let parabola = json!({"parabola": {"apex": [0, 0], "radius": 1}});
    let wedge = json!({"wedge": {"apex": [0, 0], "slope": 0.1}});
    // Flat over the half width; beyond it the obstacle is out of reach.
    let flat = json!({"table": {"points": [[0, 0], [HALF_WIDTH, 0], [HALF_WIDTH + 1e-9, 1], [SIZE, 1]]}});
    let mut answers = Vec::new();

    // The plane model is one half of the symmetric body.
    let (case, solved) = ("cylinder on a block", pressed("plane-strain", &even, &parabola, 0.02)?);
    let (closed, force) = (LineContact { modulus: MODULUS, radius: 1.0 }, 2.0 * solved.force());
    answers.push(pressure(&solved, case, "x", 0.0, |x| closed.pressure(force, x)));

    let (case, solved) = ("wedge on a block", pressed("plane-strain", &even, &wedge, 0.02)?);
    let (closed, force) = (Wedge { slope: 0.1, modulus: MODULUS }, 2.0 * solved.force());
    answers.push(pressure(&solved, case, "x", 0.02, |x| closed.pressure(force, x)));

    let (case, solved) = ("flat strip on a block", pressed("plane-strain", &graded, &flat, 0.02)?);
    let (closed, force) = (FlatStrip { half_width: HALF_WIDTH }, 2.0 * solved.force());
    answers.push(pressure(&solved, case, "x", 0.0, |x| closed.pressure(force, x)));
    answers.push(pressure(&solved, case, "x", 0.08, |x| closed.pressure(force, x)));

    let (case, solved) = ("sphere on a block, about the axis", pressed("axisymmetric", &even, &parabola, 0.01)?);
    let (closed, force) = (PointContact { modulus: MODULUS, radius: 1.0 }, solved.force());
    answers.push(solved.answer(case, "force", force, closed.force(0.01)));
    answers.push(pressure(&solved, case, "r", 0.0, |r| closed.pressure(force, r)));

    let (case, solved) = ("cone on a block, about the axis", pressed("axisymmetric", &even, &wedge, 0.01)?);
    let (closed, force) = (Cone { slope: 0.1, modulus: MODULUS }, solved.force());
    answers.push(solved.answer(case, "force", force, closed.force(0.01)));
    answers.push(pressure(&solved, case, "r", 0.02, |r| closed.pressure(force, r)));

    let (case, solved) = ("flat disc on a block, about the axis", pressed("axisymmetric", &graded, &flat, 0.01)?);
    let (closed, force) = (FlatDisc { radius: HALF_WIDTH, modulus: MODULUS }, solved.force());
    answers.push(solved.answer(case, "force", force, closed.force(0.01)));
    answers.push(pressure(&solved, case, "r", 0.0, |r| closed.pressure(force, r)));
    answers.push(pressure(&solved, case, "r", 0.08, |r| closed.pressure(force, r)));
    Ok(answers)
}
