//! The total error of bodies about an axis, and of warm ones.

use crate::total_error::{column, solved};
use serde_json::{Value, json};

const INNER: f64 = 0.5;
const OUTER: f64 = 1.0;
const PRESSURE: f64 = 0.01;
const POISSON: f64 = 0.3;

/// A thick cylinder of Young's modulus 1 under inner pressure, with springs of this stiffness per area at its outer
/// side.
fn cylinder(stiffness: Option<f64>) -> Value {
    let mut scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": {"points": [INNER, OUTER], "divisions": [8]}, "y": {"points": [0, 0.5], "divisions": [8]}}},
        "material": {"young": 1, "poisson": POISSON},
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "top"}, "y": 0}],
        "loads": [{"pressure": {"boundary": "left", "value": PRESSURE}}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2, 0], "normal": [1, 0]}}}]
    });
    if let Some(stiffness) = stiffness {
        scene["springs"] = json!([{"on": {"boundary": "right"}, "normal": stiffness, "stiffness": "per-area"}]);
    }
    scene
}

/// Asserts a guarantee whose energies enclose closely the one with this displacement of the inner side; returns the
/// bound.
fn bound_with_energy(scene: &Value, moved: f64) -> f64 {
    let (code, report, message) = solved(scene, &["--total-error", "0.01"]);
    assert!(code == 0 && report["total_error"]["guaranteed"] == true, "{message} {}", report["reason"]);
    let energy = -std::f64::consts::PI * INNER * 0.5 * PRESSURE * moved;
    let [low, high] = [0, 1].map(|end| report["potential_energy"][end].as_f64().unwrap());
    assert!(low <= energy && energy <= high && high - low < 1e-5 * energy.abs(), "{low} {energy} {high}");
    report["total_error"]["bound"].as_f64().unwrap()
}

/// GOAL: a thick cylinder under internal pressure.
/// CONDITIONS: about the axis, without axial strain; the bound is at most the one that a prototype printed.
/// REFERENCE: Lamé: the potential energy is minus half the work of the pressure.
#[test]
fn a_thick_cylinder_about_an_axis_has_the_energy_of_lame() {
    let ratio = INNER * INNER / (OUTER * OUTER - INNER * INNER);
    let moved = PRESSURE * ratio * (1.0 + POISSON) * ((1.0 - 2.0 * POISSON) * INNER + OUTER * OUTER / INNER);
    assert!(bound_with_energy(&cylinder(None), moved) < 2.25e-3);
}

/// GOAL: a thick cylinder in an elastic bed.
/// CONDITIONS: as the cylinder above; springs take the pressure `q` at its outer side that makes `q = k u` there.
/// REFERENCE: Lamé: u = A r + B/r with the condition of the springs.
#[test]
fn a_thick_cylinder_in_springs_has_the_energy_of_lame() {
    const STIFFNESS: f64 = 0.7;
    // u = A r + B / r with the radial stress 2 mu (A / (1 - 2 nu) - B / r^2).
    let twice_mu = 1.0 / (1.0 + POISSON);
    let stress = |r: f64| [twice_mu / (1.0 - 2.0 * POISSON), -twice_mu / (r * r)];
    let [a, b] = stress(INNER);
    let [c, d] = [stress(OUTER)[0] + STIFFNESS * OUTER, stress(OUTER)[1] + STIFFNESS / OUTER];
    let determinant = a * d - b * c;
    let moved = -PRESSURE * d / determinant * INNER + PRESSURE * c / determinant / INNER;
    bound_with_energy(&cylinder(Some(STIFFNESS)), moved);
}

/// GOAL: a solid column on a bed of springs under a plane.
/// CONDITIONS: about the axis, nu = 0; the plane starts 0.001 inside the column.
/// REFERENCE: springs in series: `p = 0.001 / (h / E + 1 / k)`.
#[test]
fn a_column_about_an_axis_on_springs_has_its_energy_and_force() {
    let mut scene = column("axisymmetric");
    scene["loads"] = json!([]);
    scene["material"] = json!({"young": 2, "poisson": 0});
    scene["supports"] = json!([]);
    scene["springs"] = json!([{"on": {"boundary": "bottom"}, "y": 5, "stiffness": "per-area"}]);
    let [wide, high] = ["x", "y"].map(|axis| {
        let points = scene["body"]["rectangle"][axis]["points"].as_array().unwrap();
        points.last().unwrap().as_f64().unwrap() - points[0].as_f64().unwrap()
    });
    scene["obstacles"][0]["shape"]["plane"]["point"][1] = json!(high - 0.001);
    let (code, report, message) = solved(&scene, &["--total-error", "0.02"]);
    assert!(code == 0 && report["total_error"]["guaranteed"] == true, "{message} {}", report["reason"]);
    let force = std::f64::consts::PI * wide * wide * 0.001 / (high / 2.0 + 1.0 / 5.0);
    let [low, high] = [0, 1].map(|end| report["potential_energy"][end].as_f64().unwrap());
    let energy = 0.0005 * force;
    assert!(
        low <= energy * (1.0 + 1e-9) && energy <= high * (1.0 + 1e-9) && high - low < 1e-3 * energy,
        "{low} {energy} {high}"
    );
    let [least, most] = [0, 1].map(|end| report["force_interval"][end].as_f64().unwrap());
    assert!(
        least <= force * (1.0 + 1e-9) && force <= most * (1.0 + 1e-9) && most - least < 0.05 * force,
        "{least} {force} {most}"
    );
}

/// GOAL: a confined column that is warmed.
/// CONDITIONS: plane strain, plane stress and a body of revolution; in plane strain the temperature has a stress across
/// the plane, which does no work.
/// REFERENCE: the exact displacement is in the space of the elements in the plane: the bound is rounding.
#[test]
fn a_warm_column_is_exact() {
    for model in ["plane-strain", "plane-stress", "axisymmetric"] {
        let mut scene = column(model);
        if model == "axisymmetric" {
            scene["loads"] = json!([]);
            scene["obstacles"][0]["shape"]["plane"]["point"][1] = json!(1.999);
        }
        scene["material"]["expansion"] = json!(1e-5);
        scene["temperature"] = json!([{"value": 20}]);
        let (code, report, message) = solved(&scene, &["--total-error", "1e-2"]);
        let bound = report["total_error"]["bound"].as_f64().unwrap();
        assert!(code == 0 && bound < if model == "axisymmetric" { 5e-3 } else { 1e-6 }, "{model}: {message} {report}");
    }
}

/// A ball on a cylinder takes the unknowns of a prototype, and the interval of the force contains that of a finer mesh.
#[test]
fn a_ball_on_a_cylinder_about_an_axis_takes_few_unknowns() {
    let scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": {"points": [0, 0.5], "divisions": [4]}, "y": {"points": [0, 0.5], "divisions": [4]}}},
        "material": {"young": 1e5, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0, 0.49], "radius": 1}}}]
    });
    let [coarse, fine] = ["0.06", "0.011"].map(|goal| solved(&scene, &["--total-error", goal]).1);
    let last = fine["levels"].as_array().unwrap().last().unwrap();
    assert!(last["dofs"].as_u64().unwrap() <= 3700 && last["stress_dofs"].as_u64().unwrap() <= 5300, "{last}");
    let force = |report: &Value, end: usize| report["force_interval"][end].as_f64().unwrap();
    assert!(force(&coarse, 0) < force(&fine, 0) && force(&fine, 1) < force(&coarse, 1), "{coarse}");
}
