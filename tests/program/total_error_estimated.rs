//! The estimated total error of bodies in space: bisection into quadratic tetrahedra.

use crate::total_error::{block, solved};
use serde_json::{Value, json};
use support::program::Desk;

/// The same with rows along the normals of the ball, for which only an estimate exists.
fn estimated(cells: usize) -> Value {
    let mut scene = block(cells);
    scene["obstacles"][0]["rule"] = json!("closest-point");
    scene
}

/// Bisection gives fewer unknowns than uniform tetrahedra, refines at the contact, and writes a mesh that another scene
/// can read.
#[test]
fn bisected_tetrahedra_need_fewer_unknowns_than_uniform_ones() {
    let desk = Desk::new();
    desk.write("scene.json", estimated(2).to_string());
    let run = desk.run(&["solve", "scene.json", "--total-error", "0.2", "--format", "json", "--out", "out"]);
    let found = run.ends_with(0).json();
    let last = found["levels"].as_array().unwrap().last().unwrap().clone();
    assert!(last["total_error"].as_f64().unwrap() <= 0.2 && last["energy_error_bound"].as_f64().unwrap() <= 0.02);
    // With more than 1.5 times as many unknowns, uniform tetrahedra have a larger error.
    let (_, equal, _) = solved(&estimated(10), &[]);
    assert!(equal["model"]["dofs"].as_f64().unwrap() > 1.5 * last["dofs"].as_f64().unwrap(), "{equal}");
    assert!(equal["discretisation_error"].as_f64().unwrap() > 1.3 * last["total_error"].as_f64().unwrap(), "{equal}");

    let mut again = estimated(2);
    again["body"] = json!({"gmsh": {"file": "out/mesh.msh"}});
    desk.write("again.json", again.to_string());
    let again = desk.run(&["solve", "again.json", "--format", "json"]).ends_with(0).json();
    assert_eq!(again["model"]["dofs"], last["dofs"]);
    let [one, two] = [&again, &found["answer"]].map(|answer| answer["contact"]["force"].as_f64().unwrap());
    assert!((one / two - 1.0).abs() < 0.02, "{one} {two}");
    for name in
        ["meshes.csv", "meshes.png", "total-error.png", "total-error.txt", "report.json", "u.mtx", "solution.vtu"]
    {
        assert!(desk.path("out").join(name).exists(), "{name}");
    }
}

/// The finer meshes are quadratic tetrahedra: a tenth of the unknowns of linear ones, for bricks as well. Materials and
/// boundaries are those of the scene, on every mesh.
#[test]
fn an_estimate_of_a_tenth_takes_at_most_15000_unknowns() {
    for element in ["tet4", "tet10", "hex8", "hex20"] {
        let mut scene = estimated(2);
        scene["body"]["box"]["element"] = json!(element);
        let (code, report, message) = solved(&scene, &["--total-error", "0.1"]);
        assert!(code == 0 && report["total_error"]["guaranteed"] == false, "{element}: {message}");
        assert!(report["model"]["dofs"].as_f64().unwrap() <= 15_000.0, "{element}: {report}");
    }
    let mut two = estimated(2);
    two["body"]["box"]["element"] = json!("hex8");
    two["body"]["box"]["integration"] = json!("mean-dilatation");
    two["materials"] =
        json!([{"box": {"min": [0, 0, 0], "max": [0.5, 1, 0.5]}, "material": {"young": 1e6, "poisson": 0.2}}]);
    two["supports"].as_array_mut().unwrap().push(json!({"on": {"boundary": "left"}, "x": 0}));
    two["loads"] = json!([{"pressure": {"boundary": "right", "value": 1e4}}]);
    two["obstacles"][0]["rule"] = json!("approach");
    // A weak spring at a point changes nothing but the guarantee.
    two["springs"] = json!([{"on": {"point": [1, 0, 0.5]}, "x": 1e-3}]);
    let (code, report, message) = solved(&two, &["--total-error", "0.1"]);
    assert!(code == 0 && report["total_error"]["guaranteed"] == false, "{message}");
    two["springs"] = json!([]);
    two["body"]["box"].as_object_mut().unwrap().remove("integration");
    let (code, bounded, message) = solved(&two, &["--total-error", "0.2"]);
    assert!(code == 0 && bounded["total_error"]["guaranteed"] == true, "{message}");
    let [one, other] = [&report, &bounded].map(|report| report["answer"]["contact"]["force"].as_f64().unwrap());
    assert!((one / other - 1.0).abs() < 0.05, "{one} {other}");
}

/// The same mesh with rows along the approach has a guaranteed bound, which judges the estimate.
#[test]
fn the_estimate_of_quadratic_tetrahedra_is_near_the_guaranteed_bound() {
    for ratio in [0.3, 0.45] {
        let desk = Desk::new();
        let mut scene = estimated(2);
        scene["material"]["poisson"] = json!(ratio);
        desk.write("scene.json", scene.to_string());
        let goal = ["--total-error", "0.25", "--format", "json", "--out", "out", "--pictures", "none"];
        let run = desk.run(&[&["solve", "scene.json"], &goal[..]].concat());
        let found = run.ends_with(0).json();
        scene["body"] = json!({"gmsh": {"file": "out/mesh.msh"}});
        scene["obstacles"][0]["rule"] = json!("approach");
        desk.write("again.json", scene.to_string());
        let run = desk.run(&["solve", "again.json", "--total-error", "0.5", "--format", "json"]);
        let own = run.ends_with(0).json()["own_mesh"].clone();
        assert_eq!(own["element"], "Tet10");
        let [estimate, bound] = [&found, &own].map(|report| report["total_error"]["bound"].as_f64().unwrap());
        assert!((0.6..1.5).contains(&(estimate / bound)), "{estimate} {bound}");
    }
}

/// On the first mesh no node is at the tip: its answer would have no contact and no error.
#[test]
fn a_tip_between_nodes_is_found_by_refinement() {
    for element in ["tet4", "hex8"] {
        let mut scene = estimated(2);
        scene["body"]["box"]["element"] = json!(element);
        scene["obstacles"][0]["shape"] = json!({"sphere": {"apex": [0.375, 0.375, 0.49], "radius": 0.1}});
        let (code, report, message) = solved(&scene, &["--total-error", "0.4"]);
        assert_eq!(code, 0, "{message}");
        let levels = report["levels"].as_array().unwrap();
        assert_eq!(levels[0]["contact_force"].as_f64(), Some(0.0), "{report}");
        let last = levels.last().unwrap();
        assert!(
            last["contact_force"].as_f64().unwrap() > 1000.0 && last["depth_between_nodes"].as_f64().unwrap() < 0.4
        );
    }
}

#[test]
fn a_plane_mesh_of_a_file_has_no_finer_mesh() {
    let desk = Desk::new();
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meshes/half-disc-t6.msh");
    desk.write("disc.msh", std::fs::read(mesh).unwrap());
    let scene = json!({
        "body": {"gmsh": {"file": "disc.msh"}},
        "material": {"young": 1, "poisson": 0.3, "density": 1},
        "supports": [{"on": {"boundary": "cut"}, "x": 0, "y": 0}],
        "loads": [{"centrifugal": {"omega": 1e-3}}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "shape": {"plane": {"point": [0, -0.95], "normal": [0, -1]}}}]
    });
    desk.write("scene.json", scene.to_string());
    let run = desk.run(&["solve", "scene.json", "--total-error", "0.001"]);
    assert!(run.code == 4 && run.stdout.contains("cannot be refined here"), "{} {}", run.stdout, run.stderr);
}

/// Bricks of a file are bisected as tetrahedra.
#[test]
fn bricks_of_a_file_have_finer_meshes() {
    let desk = Desk::new();
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meshes/box-hex8.msh");
    desk.write("box.msh", std::fs::read(mesh).unwrap());
    let mut scene = estimated(2);
    scene["body"] = json!({"gmsh": {"file": "box.msh"}});
    scene["obstacles"][0]["shape"]["sphere"]["apex"] = json!([0.5, 0.5, 0.99]);
    desk.write("scene.json", scene.to_string());
    let run = desk.run(&["solve", "scene.json", "--total-error", "0.2", "--format", "json"]);
    assert!(run.ends_with(0).json()["levels"].as_array().unwrap().len() > 1);
}
