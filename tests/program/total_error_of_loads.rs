//! The total error with parts of boundaries and distributed loads: some loads keep the guarantee, for others the error
//! is estimated.

use crate::total_error::{block, classical, column, solved};
use serde_json::{Value, json};

#[test]
fn gravity_has_the_force_of_a_constant_body_force() {
    let mut scene = column("plane-strain");
    let (_, expected, _) = solved(&scene, &["--total-error", "1e-6"]);
    scene["material"]["density"] = json!(2);
    scene["loads"] = json!([{"gravity": [0, 1.5]}]);
    let (code, report, _) = solved(&scene, &["--total-error", "1e-6"]);
    assert_eq!((code, &report["total_error"]["guaranteed"]), (0, &json!(true)));
    assert_eq!(report["contact_force"], expected["contact_force"]);
}

/// A force of 600 on a side of length 0.5 with a thickness of 2 equals a traction of 600.
#[test]
fn a_force_on_a_boundary_has_the_contact_force_of_a_constant_traction() {
    let found = [
        json!({"force": {"boundary": "right", "value": [600, -300]}}),
        json!({"traction": {"boundary": "right", "value": [600, -300]}}),
    ]
    .map(|load| {
        let mut scene = classical(0.3);
        scene["thickness"] = json!(2);
        scene["loads"] = json!([load]);
        let (code, report, message) = solved(&scene, &["--total-error", "0.05"]);
        assert!(code == 0 && report["total_error"]["guaranteed"] == true, "{message}");
        report["contact_force"].as_f64().unwrap()
    });
    assert!((found[0] / found[1] - 1.0).abs() < 1e-12, "{found:?}");
}

/// Half of a layer on a plane, pressed by a strip of width 0.5: the plane carries the load of the strip, and the bound
/// is guaranteed.
#[test]
fn a_load_on_a_part_has_a_guaranteed_bound() {
    let scene = json!({
        "body": {"rectangle": {"x": {"points": [0, 4], "divisions": [16]}, "y": {"points": [0, 1], "divisions": [4]}}},
        "material": {"young": 1000, "poisson": 0.3},
        "parts": [{"name": "strip", "of": "top", "box": {"min": [0, 1], "max": [0.5, 1]}}],
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "strip", "value": 8}}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]
    });
    let (code, report, message) = solved(&scene, &["--total-error", "0.03"]);
    assert!(code == 0 && report["total_error"]["guaranteed"] == true, "{code} {message}");
    assert!(report["levels"].as_array().unwrap().len() > 1);
    assert!((report["contact_force"].as_f64().unwrap() / 4.0 - 1.0).abs() < 1e-6, "{report}");
}

#[test]
fn loads_and_supports_with_a_kink_inside_an_edge_are_estimated_with_the_reason() {
    let profile =
        |along: [f64; 2], end: f64| json!({"along": along, "places": [0, 0.3 * end, end], "factors": [1, 0, 0]});
    let varies = profile([0.0, 1.0], 0.5);
    let cases = [
        (json!({"pressure": {"boundary": "left", "value": 1e4, "profile": varies}}), "loads[0].pressure.profile"),
        (json!({"traction": {"boundary": "left", "value": [1e4, 0], "profile": varies}}), "loads[0].traction.profile"),
        (json!({"centrifugal": {"omega": 10}}), "loads[0].centrifugal"),
    ];
    let estimated = |scene: &Value, path: &str| {
        let (code, report, message) = solved(scene, &["--total-error", "0.3"]);
        assert!(code == 0 && report["total_error"]["guaranteed"] == false, "{path}: {message}");
        let reason = report["reason"].as_str().unwrap();
        assert!(reason.starts_with(path) && reason.contains("no guaranteed bound"), "{reason}");
    };
    for (load, path) in cases {
        let mut scene = classical(0.3);
        scene["material"]["density"] = json!(1);
        scene["loads"] = json!([load]);
        estimated(&scene, path);
    }
    let mut scene = classical(0.3);
    scene["supports"][0]["profile"] = profile([1.0, 0.0], 1.0);
    estimated(&scene, "supports[0].profile");
}

/// The edge of the part is an edge of cells: the halves of its facets stay inside it, and the load is the same on every
/// mesh.
#[test]
fn a_load_on_a_part_is_the_same_on_bisected_tetrahedra() {
    let mut scene = block(2);
    scene["parts"] = json!([{"name": "half", "of": "top", "box": {"min": [0, 0, 0.5], "max": [0.5, 1, 0.5]}}]);
    scene["loads"] = json!([{"pressure": {"boundary": "half", "value": 3000}}]);
    let (code, report, message) = solved(&scene, &["--total-error", "0.25"]);
    assert!(code == 0 && report["levels"].as_array().unwrap().len() > 1, "{message}");
    let resultants = report["answer"]["resultants"].as_array().unwrap();
    let loads = resultants.iter().find(|one| one["of"] == "loads").unwrap();
    let force = loads["force"][2].as_f64().unwrap();
    assert!((force / -1500.0 - 1.0).abs() < 1e-12, "{loads}");
}

/// A part with planes of symmetry has bounds of the force and of the energy that meet those of the whole, on meshes
/// that are no images of each other.
#[test]
fn a_half_and_a_quarter_have_guaranteed_bounds_that_meet_those_of_the_whole() {
    let half = |scene: &Value, axes: &[&str], divisions: usize| {
        let mut part = scene.clone();
        part["symmetry"] = json!(axes);
        for &axis in axes {
            // The obstacles have their apex in the middle, which is moved to the plane of symmetry at zero.
            part["body"][if axes.len() == 1 { "rectangle" } else { "box" }][axis] =
                json!({"points": [0, 0.5], "divisions": [divisions]});
        }
        part
    };
    let (plane, mut space) = (classical(0.3), block(2));
    let mut of_plane = half(&plane, &["x"], 4);
    of_plane["obstacles"][0]["shape"]["parabola"]["apex"] = json!([0, 0.49]);
    let mut of_space = half(&space, &["x", "y"], 2);
    of_space["obstacles"][0]["shape"]["sphere"]["apex"] = json!([0, 0, 0.49]);
    space["body"]["box"]["element"] = json!("hex8");
    of_space["body"]["box"]["element"] = json!("hex8");
    for (whole, part, goal, parts) in [(&plane, &of_plane, "0.03", 2), (&space, &of_space, "0.3", 4)] {
        let [of_whole, of_part] = [whole, part].map(|scene| {
            let (code, report, message) = solved(scene, &["--total-error", goal]);
            assert!(code == 0 && report["total_error"]["guaranteed"] == true, "{message}");
            report
        });
        for key in ["force_interval", "potential_energy"] {
            let ends = |report: &Value| [0, 1].map(|end| report[key][end].as_f64().unwrap());
            let ([low, high], [other_low, other_high]) = (ends(&of_whole), ends(&of_part));
            assert!(low <= other_high && other_low <= high, "{key}: {low} {high} {other_low} {other_high}");
            assert!((high - low).abs() < 0.3 * high.abs(), "{key}: {low} {high}");
        }
        let basis = of_part["force_basis"].as_str().unwrap();
        assert!(basis.contains(&format!("{parts} times the meshed part")), "{basis}");
        let unknowns = |report: &Value| report["levels"].as_array().unwrap().last().unwrap()["dofs"].as_f64().unwrap();
        assert!(unknowns(&of_part) < 0.75 * unknowns(&of_whole));
    }
}

/// Axes that turn around a line have an estimate, and the reason says so.
#[test]
fn axes_around_a_line_have_an_estimate() {
    let mut scene = classical(0.3);
    scene["material"] = json!({"orthotropic": {"young": [1e7, 1e7, 1e7], "poisson": [0.3, 0.3, 0.3],
        "shear": [3.8e6, 3.8e6, 3.8e6], "around": {"point": [-0.2, 0.3]}}});
    let (code, report, message) = solved(&scene, &["--total-error", "0.05"]);
    assert!(code == 0 && report["total_error"]["guaranteed"] == false, "{message}");
    assert!(
        report["reason"].as_str().unwrap().contains("axes around a line has no guaranteed bound"),
        "{}",
        report["reason"]
    );
}
