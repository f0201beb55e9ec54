//! The total error of bodies about an axis, and of warm ones.

use crate::total_error::{column, solved};
use serde_json::{Value, json};

/// The thick cylinder of Lame under inner pressure: the bound is the one that a prototype printed, and the energy lies between the bounds.
#[test]
fn a_thick_cylinder_about_an_axis_has_the_energy_of_lame() {
    let (inner, outer, pressure, young, poisson): (f64, f64, f64, f64, f64) = (0.5, 1.0, 0.01, 1.0, 0.3);
    let scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": {"points": [inner, outer], "divisions": [8]}, "y": {"points": [0, 0.5], "divisions": [8]}}},
        "material": {"young": young, "poisson": poisson},
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "top"}, "y": 0}],
        "loads": [{"pressure": {"boundary": "left", "value": pressure}}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2, 0], "normal": [1, 0]}}}]
    });
    let (code, report, message) = solved(&scene, &["--total-error", "0.01"]);
    assert!(code == 0 && report["total_error"]["bound"].as_f64().unwrap() < 2.25e-3, "{message} {report}");
    let ratio = inner * inner / (outer * outer - inner * inner);
    let moved = pressure * ratio * (1.0 + poisson) / young * ((1.0 - 2.0 * poisson) * inner + outer * outer / inner);
    let energy = -std::f64::consts::PI * inner * 0.5 * pressure * moved;
    let [low, high] = [0, 1].map(|end| report["potential_energy"][end].as_f64().unwrap());
    assert!(low <= energy && energy <= high && high - low < 1e-5 * energy.abs(), "{low} {energy} {high}");
}

/// In plane strain a temperature has a stress across the plane, which does no work: the column stays exact.
#[test]
fn a_warm_column_is_exact() {
    for model in ["plane-strain", "plane-stress", "axisymmetric"] {
        let mut scene = column(model);
        if model == "axisymmetric" {
            scene["loads"] = json!([]);
            scene["obstacles"][0]["shape"]["plane"]["point"][1] = json!(0.999);
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
