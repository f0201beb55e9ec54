//! GOAL: force and pressure of elastic half cylinders and half balls on a rigid plane.
//! CONDITIONS: radius 1; the cut moves rigidly by 0.01 or 2.5e-5; the balls are axisymmetric and in space.
//! REFERENCE: Hertz, by `closed_forms::hertz`.

use crate::closed_forms::{LineContact, PointContact};
use serde_json::{Value, json};
use signorini::Error;

use super::answer::{Answer, Solved};

/// Plane strain modulus E / (1 - nu^2) for E = 1 and nu = 0.3; the radius is 1.
const MODULUS: f64 = 1.0 / 0.91;

/// Displacement delta of the cut face of the half ball; the contact radius is sqrt(delta) = 0.005. Hertz treats the
/// sphere as a half space; for this contact radius, the force of a half ball is 0.17 % larger.
const APPROACH: f64 = 2.5e-5;

/// A half cylinder of unit radius, with quadratic elements, whose cut face moves rigidly by 0.01 towards a plane.
pub fn half_cylinders() -> Result<Vec<Answer>, Error> {
    let line = LineContact { modulus: MODULUS, radius: 1.0 };
    // The exact force for an approach of 0.01; section and force are those of the full width.
    let force = 4.983922e-3;
    let mut answers = Vec::new();
    for element in ["t6", "q8"] {
        let solved = Solved::of(&half_cylinder(element))?;
        let case = "half cylinder on a plane";
        answers.push(solved.answer(case, "force", solved.force(), force));
        answers.push(solved.answer(case, "largest pressure", solved.peak_pressure(), line.peak_pressure(force)));
    }
    Ok(answers)
}

pub fn half_cylinder(element: &str) -> Value {
    json!({
        "model": "plane-strain",
        "body": {"half-disc": {"radius": 1, "zone": {"width": 0.1, "divisions": 8}, "element": element}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "y": -0.01}, {"on": {"point": [0, 0]}, "x": 0}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "shape": {"plane": {"point": [0, -1], "normal": [0, -1]}}}],
    })
}

/// A half ball whose cut face moves rigidly towards a plane: its axisymmetric section, and the given quarter in space.
pub fn half_balls(quarter: &Value) -> Result<Vec<Answer>, Error> {
    let point = PointContact { modulus: MODULUS, radius: 1.0 };
    let force = point.force(APPROACH);
    let solved = Solved::of(&half_ball_about_the_axis())?;
    let case = "half ball on a plane, about the axis";
    // The node on the axis has the pressure of its neighbour, half a cell away, so that another node is compared.
    let [r, ours] = solved.pressure_near(0.12 * APPROACH.sqrt());
    let mut answers = vec![
        solved.answer(case, "force", solved.force(), force),
        solved.answer(case, format!("pressure at r = {r:.1e}"), ours, point.pressure(force, r)),
    ];
    let solved = Solved::of(quarter)?;
    let case = "half ball on a plane, in space";
    answers.push(solved.answer(case, "force", 4.0 * solved.force(), force));
    answers.push(solved.answer(case, "largest pressure", solved.peak_pressure(), point.peak_pressure(force)));
    Ok(answers)
}

pub fn half_ball_about_the_axis() -> Value {
    json!({
        "model": "axisymmetric",
        "body": {"half-disc": {"radius": 1, "symmetric": true,
            "zone": {"width": 1.2 * APPROACH.sqrt(), "divisions": 4, "growth": 3}, "element": "q8"}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "y": -APPROACH}, {"on": {"boundary": "symmetry-x"}, "x": 0}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "shape": {"plane": {"point": [0, -1], "normal": [0, -1]}}}],
    })
}

/// A quarter of the half ball, which carries a quarter of its force.
pub fn quarter_ball(divisions: usize, growth: f64) -> Value {
    json!({
        "model": "space",
        "body": {"half-ball": {"radius": 1, "symmetric": ["x", "y"],
            "zone": {"width": 1.1 * APPROACH.sqrt(), "divisions": divisions, "growth": growth}}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "z": -APPROACH},
            {"on": {"boundary": "symmetry-x"}, "x": 0}, {"on": {"boundary": "symmetry-y"}, "y": 0}],
        "obstacles":
            [{"boundary": "round", "approach": "-z", "shape": {"plane": {"point": [0, 0, -1], "normal": [0, 0, -1]}}}],
    })
}

/// The same half balls at nu = 0.4999, with linear elements and mean dilatation: axisymmetric, and in space.
pub fn nearly_incompressible_half_balls() -> Result<Vec<Answer>, Error> {
    let nu = 0.4999;
    let point = PointContact { modulus: 1.0 / (1.0 - nu * nu), radius: 1.0 };
    let mut section = half_ball_about_the_axis();
    section["body"]["half-disc"]["element"] = json!("q4");
    section["body"]["half-disc"]["zone"] = json!({"width": 1.2 * APPROACH.sqrt(), "divisions": 12, "growth": 1.5});
    let mut answers = Vec::new();
    for (mut scene, body, place, parts) in
        [(section, "half-disc", "about the axis", 1.0), (quarter_ball(8, 2.0), "half-ball", "in space", 4.0)]
    {
        scene["material"]["poisson"] = json!(nu);
        scene["body"][body]["integration"] = json!("mean-dilatation");
        let solved = Solved::of(&scene)?;
        let case = format!("half ball, nu = 0.4999, mean dilatation, {place}");
        answers.push(solved.answer(&case, "force", parts * solved.force(), point.force(APPROACH)));
        let exact = point.peak_pressure(point.force(APPROACH));
        answers.push(solved.answer(&case, "largest pressure", solved.peak_pressure(), exact));
    }
    Ok(answers)
}
