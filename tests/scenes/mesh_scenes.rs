//! Scenes on bodies from mesh files and on round bodies, solved completely and compared with closed forms.

use signorini::{Error, Model, Scene, qp, solve_qp};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};
use signorini::scene::Answer;

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;

/// Uniform compression is exact up to rounding; the largest measured difference is 6e-15.
const ROUNDING: f64 = 1e-12;

/// A scene as if it were read from a file in the folder of the meshes.
fn scene(value: &Value) -> Scene {
    let scene = Scene::from_json(&value.to_string(), "scene").unwrap();
    Scene { folder: Some(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes")), ..scene }
}

/// The pressures of the contact rows, and the sum of the contact forces.
fn solved(model: &Model) -> (Vec<f64>, f64) {
    let solution = solve_qp(model.problem()).unwrap();
    let force = -solution.multiplier.iter().sum::<f64>();
    (model.pressure(&solution.multiplier).unwrap(), force)
}

/// A body between rollers, its top pressed down by 0.01 of its height 1.
fn pressed(model: &str, body: Value, vertical: &str, rollers: &[(&str, &str)]) -> Value {
    let normal: Vec<f64> = if vertical == "z" { vec![0.0, 0.0, 1.0] } else { vec![0.0, 1.0] };
    let supports: Vec<Value> = rollers.iter().map(|(side, axis)| json!({"on": {"boundary": side}, *axis: 0})).collect();
    json!({
        "model": model, "body": body, "material": {"young": YOUNG, "poisson": POISSON}, "supports": supports,
        "obstacles": [{"boundary": "top", "approach": format!("+{vertical}"),
                       "shape": {"plane": {"point": normal, "normal": normal}}}],
        "gap": -0.01,
    })
}

/// GOAL: uniform compression of a block, the contact patch test, on meshes of Gmsh.
/// CONDITIONS: plane strain, plane stress, a body of revolution and space; rollers at the side, a strain of 0.01
/// against a plane.
/// REFERENCE: p = E' 0.01, with E' = E/(1-nu^2) in plane strain and otherwise E.
#[test]
fn uniform_compression_is_exact_on_unstructured_meshes() {
    let gmsh = |file: &str| json!({"gmsh": {"file": file}});
    let part = json!({"gmsh": {"file": "two-parts-q8.msh", "group": "second"}});
    let plane = [("bottom", "y"), ("left", "x")];
    let space = [("bottom", "z"), ("left", "x"), ("front", "y")];
    let plane_strain = YOUNG / (1.0 - POISSON * POISSON);
    let cases = [
        (pressed("plane-strain", gmsh("block-t3.msh"), "y", &plane), plane_strain, 2.0),
        (pressed("plane-stress", gmsh("block-t3.msh"), "y", &plane), YOUNG, 2.0),
        (pressed("plane-strain", part, "y", &[("bottom", "y"), ("interface", "x")]), plane_strain, 1.0),
        (pressed("axisymmetric", gmsh("block-t3.msh"), "y", &[("bottom", "y")]), YOUNG, PI * 4.0),
        (pressed("space", gmsh("box-tet4.msh"), "z", &space), YOUNG, 1.0),
        (pressed("space", gmsh("box-hex8.msh"), "z", &space), YOUNG, 1.0),
        (pressed("space", gmsh("box-tet10.msh"), "z", &space), YOUNG, 1.0),
        (pressed("space", gmsh("box-hex20.msh"), "z", &space), YOUNG, 1.0),
    ];
    for (value, modulus, area) in cases {
        let (pressures, force) = solved(&scene(&value).build().unwrap());
        let expected = 0.01 * modulus;
        assert!(pressures.len() >= 4);
        for pressure in pressures {
            assert!((pressure / expected - 1.0).abs() < ROUNDING, "{value}: {pressure} instead of {expected}");
        }
        assert!((force / (expected * area) - 1.0).abs() < ROUNDING, "{value}: {force}");
    }
}

/// A half ball of ten-node tetrahedra from Gmsh under a sphere. Its faces are curved and quadratic; forces and moments
/// must balance.
#[test]
fn forces_and_moments_balance_on_curved_quadratic_faces() {
    let support = |on: Value, axis: &str, value: f64| json!({"on": on, axis: value});
    for rule in ["approach", "closest-point"] {
        let value = json!({
            "model": "space",
            "body": {"gmsh": {"file": "half-ball-tet10.msh"}},
            "material": {"young": 1.0, "poisson": 0.3},
            "supports": [support(json!({"boundary": "cut"}), "z", -0.02), support(json!({"boundary": "cut"}), "x", 0.0),
                         support(json!({"boundary": "cut"}), "y", 0.0)],
            "obstacles": [{"boundary": "round", "approach": "-z", "rule": rule,
                           "shape": {"sphere": {"apex": [0.05, -0.03, 0], "radius": 3}}}],
        });
        let model = scene(&value).build().unwrap();
        let solution = solve_qp(model.problem()).unwrap();
        let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
        assert!(balance < 1e-12, "{rule}: {balance:e}");
        assert!(solution.multiplier.iter().all(|&lambda| lambda <= 0.0));
        // The moment of the contact rows equals the moment of the nodal forces.
        let forces = model.contact_forces(&solution.multiplier).unwrap();
        let nodes = model.mesh().nodes();
        let moment = (0..nodes.len())
            .fold(0.0, |sum, node| sum + nodes[node][1] * forces[3 * node + 2] - nodes[node][2] * forces[3 * node + 1]);
        let of_rows = model.contact_resultants(&solution.multiplier).unwrap()[0].moment[0];
        let scale = solution.contact_force();
        assert!((moment - of_rows).abs() < 1e-12 * scale, "{rule}: {moment:e} {of_rows:e}");
    }
}

/// A half ball of ten-node tetrahedra fills a socket that is a little smaller: the estimated area is that of its curved
/// facets, which is 0.3 % larger than that of the straight triangles, and the area of the half ball lies within its
/// uncertainty.
#[test]
fn the_area_of_a_closed_socket_is_that_of_its_curved_facets() {
    const WIDE: f64 = 0.01;
    let value = json!({
        "model": "space",
        "body": {"gmsh": {"file": "half-ball-tet10.msh"}},
        "material": {"young": YOUNG, "poisson": POISSON},
        "supports": [{"on": {"boundary": "cut"}, "z": 0}, {"on": {"point": [1, 0, 1]}, "y": 0}],
        "obstacles": [{"boundary": "round", "approach": "-z", "rule": "closest-point",
                       "shape": {"sphere": {"centre": [0, 0, 1], "radius": 0.99, "side": "inside"}}}],
    });
    let model = Arc::new(scene(&value).build().unwrap());
    let solution = solve_qp(model.problem()).unwrap();
    let extent = Answer::of(model.clone(), &solution).unwrap().segments().remove(0).extent;
    let (area, off, exact) = (extent.area, extent.area_uncertainty, 2.0 * PI);
    let of_rows: f64 = model.rows().iter().map(|row| row.tributary_area).sum();
    assert!((area / of_rows - 1.0).abs() < ROUNDING, "{area}: {of_rows}");
    assert!((area - exact).abs() < off && off < WIDE * exact, "{area} ± {off}, {exact}");
}

#[test]
fn a_scaled_mesh_in_other_units_gives_the_same_pressure() {
    let mut value = pressed("plane-strain", json!({}), "y", &[("bottom", "y"), ("left", "x")]);
    value["body"] = json!({"gmsh": {"file": "block-t3.msh", "scale": 1000.0}});
    value["obstacles"][0]["shape"]["plane"]["point"] = json!([0, 1000]);
    value["gap"] = json!(-10.0);
    let (pressures, _) = solved(&scene(&value).build().unwrap());
    let expected = 0.01 * YOUNG / (1.0 - POISSON * POISSON);
    assert!(pressures.iter().all(|pressure| (pressure / expected - 1.0).abs() < 1e-7), "{pressures:?}");
}

/// A round body of radius 1 above the plane through its lowest point; its cut moves down.
fn indented(model: &str, body: Value, round: &str, depth: f64, symmetry: &[&str]) -> Value {
    let vertical = if model == "space" { "z" } else { "y" };
    let down: Vec<f64> = if model == "space" { vec![0.0, 0.0, -1.0] } else { vec![0.0, -1.0] };
    let origin = vec![0.0; down.len()];
    let mut supports = vec![json!({"on": {"boundary": "cut"}, vertical: -depth})];
    for side in symmetry {
        supports.push(json!({"on": {"boundary": format!("symmetry-{side}")}, *side: 0}));
    }
    json!({
        "model": model, "body": body, "material": {"young": YOUNG, "poisson": POISSON}, "supports": supports,
        "obstacles": [{"boundary": round, "approach": format!("-{vertical}"),
                       "shape": {"plane": {"point": origin, "normal": down}}}],
    })
}

/// GOAL: the peak pressure of a cylinder and of a ball on a rigid plane, from the total force.
///
/// CONDITIONS: half disc, or half ball, of radius 1 whose flat cut is moved down; contact half-width near 0.06.
///
/// REFERENCE: Hertz: p0 = sqrt(F E* / (pi R)) per unit of length, p0 = (6 F E*^2 / (pi^3 R^2))^(1/3) for a ball.
#[test]
fn round_bodies_have_the_peak_pressure_of_hertz() {
    let modulus = YOUNG / (1.0 - POISSON * POISSON);
    let line = |force: f64| (force * modulus / PI).sqrt();
    let point = |force: f64| (6.0 * force * modulus * modulus / PI.powi(3)).cbrt();
    let disc = |element: &str, symmetric: bool, width: f64, divisions: usize| {
        let zone = json!({"width": width, "divisions": divisions, "growth": 1.25});
        json!({"half-disc": {"centre": [0, 1], "radius": 1, "zone": zone, "symmetric": symmetric, "element": element}})
    };
    let strain = |element: &str, tolerance: f64| {
        let value = indented("plane-strain", disc(element, true, 0.1, 12), "arc", 0.007, &["x"]);
        let (pressures, half) = solved(&scene(&value).build().unwrap());
        let (peak, expected) = (pressures.iter().copied().fold(0.0, f64::max), line(2.0 * half));
        assert!((peak / expected - 1.0).abs() < tolerance, "{element}: {peak} instead of {expected}");
    };
    strain("q4", 0.02);
    strain("t3", 0.03);
    let revolved = |element: &str, tolerance: f64| {
        let value = indented("axisymmetric", disc(element, true, 0.1, 12), "arc", 0.004, &[]);
        let (pressures, force) = solved(&scene(&value).build().unwrap());
        let (peak, expected) = (pressures.iter().copied().fold(0.0, f64::max), point(force));
        assert!((peak / expected - 1.0).abs() < tolerance, "{element}: {peak} instead of {expected}");
        force
    };
    let force = revolved("q4", 0.05);
    let ball = json!({"half-ball": {"centre": [0, 0, 1], "radius": 1, "symmetric": ["x", "y"],
                                    "zone": {"width": 0.1, "divisions": 4, "growth": 1.8}}});
    let value = indented("space", ball, "round", 0.004, &["x", "y"]);
    let (_, quarter) = solved(&scene(&value).build().unwrap());
    assert!((4.0 * quarter / force - 1.0).abs() < 0.05, "in space {}, revolved {force}", 4.0 * quarter);
}

/// GOAL: the pressure of a ball of unstructured ten-node tetrahedra from Gmsh on a rigid plane.
///
/// CONDITIONS: a quarter of a half ball of radius 1 whose cut is moved down by 0.004; five edges along the radius of
/// the contact.
///
/// REFERENCE: Hertz, from the total force: p0 = (6 F E*^2 / (pi^3 R^2))^(1/3), a = (3 F R / (4 E*))^(1/3), p = p0
/// sqrt(1 - (r/a)^2).
#[test]
fn a_ball_of_unstructured_quadratic_tetrahedra_has_the_pressure_of_hertz() {
    let body = json!({"gmsh": {"file": "quarter-ball-tet10.msh"}});
    let model = scene(&indented("space", body, "round", 0.004, &["x", "y"])).build().unwrap();
    let solution = solve_qp(model.problem()).unwrap();
    let force = 4.0 * solution.contact_force();
    let modulus = YOUNG / (1.0 - POISSON * POISSON);
    let peak = (6.0 * force * modulus * modulus / PI.powi(3)).cbrt();
    let radius = (3.0 * force / (4.0 * modulus)).cbrt();
    let (mut largest, mut inside) = (0.0_f64, 0);
    let pressures = model.pressure(&solution.multiplier).unwrap();
    for (row, &pressure) in model.rows().iter().zip(&pressures) {
        let [x, y, _] = model.mesh().nodes()[row.node];
        let distance = x.hypot(y) / radius;
        largest = largest.max(pressure);
        if distance < 0.7 {
            inside += 1;
            let expected = peak * (1.0 - distance * distance).sqrt();
            assert!((pressure / expected - 1.0).abs() < 0.04, "at {distance} a: {pressure} instead of {expected}");
        }
    }
    assert!(inside > 60 && (largest / peak - 1.0).abs() < 0.01, "{inside} nodes, peak {largest} instead of {peak}");
}

#[test]
fn an_unstructured_half_disc_has_the_contact_force_of_a_structured_one() {
    let zone = json!({"width": 0.3, "divisions": 8, "growth": 1.2});
    let structured = json!({"half-disc": {"centre": [0, 1], "radius": 1, "element": "t6", "zone": zone}});
    let force = |body: Value| {
        let mut value = indented("plane-strain", body, "arc", 0.03, &[]);
        // The support of the node at the lowest point prevents sliding.
        let cut = value["supports"][0].clone();
        value["supports"] = json!([cut, {"on": {"point": [0, 0]}, "x": 0}]);
        solved(&scene(&value).build().unwrap()).1
    };
    let (one, other) = (force(json!({"gmsh": {"file": "half-disc-t6.msh"}})), force(structured));
    assert!((one / other - 1.0).abs() < 0.01, "{one} and {other}");
}

/// GOAL: a thick ring under external pressure.
/// CONDITIONS: plane strain; a quarter with planes of symmetry, radii 1 and 2; an obstacle that it does not reach.
/// REFERENCE: Lamé: u(b) = -p b (1 + nu) ((1 - 2 nu) b^2 + a^2) / (E (b^2 - a^2)).
#[test]
fn a_ring_under_external_pressure_has_the_displacement_of_lame() {
    let axis = |points: [f64; 2], cells: usize| json!({"points": points, "divisions": [cells]});
    let value = json!({
        "body": {"ring": {"radius": axis([1.0, 2.0], 6), "angle": axis([0.0, 90.0], 12), "element": "q8"}},
        "material": {"young": YOUNG, "poisson": POISSON},
        "supports": [{"on": {"boundary": "start"}, "y": 0}, {"on": {"boundary": "end"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "outer", "value": 3}}],
        "obstacles": [{"boundary": "inner", "approach": "-x",
                       "shape": {"plane": {"point": [-5, 0], "normal": [-1, 0]}}}],
    });
    let model = scene(&value).build().unwrap();
    let solution = solve_qp(model.problem()).unwrap();
    let displacement = model.nodal_displacement(&solution.displacement).unwrap();
    let (node, _) = model.mesh().nearest_node([2.0, 0.0, 0.0]).unwrap();
    let expected = -3.0 * 2.0 * (1.0 + POISSON) * ((1.0 - 2.0 * POISSON) * 4.0 + 1.0) / (YOUNG * 3.0);
    assert!((displacement[2 * node] / expected - 1.0).abs() < 1e-4, "{} and {expected}", displacement[2 * node]);
}

#[test]
fn the_path_of_a_mesh_file_is_relative_to_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    std::fs::copy(meshes.join("block-t3.msh"), folder.path().join("parts/block.msh")).unwrap();
    let body = json!({"gmsh": {"file": "parts/block.msh"}});
    let value = pressed("plane-strain", body, "y", &[("bottom", "y"), ("left", "x")]);
    std::fs::write(folder.path().join("scene.json"), value.to_string()).unwrap();
    assert!(Scene::read(folder.path().join("scene.json")).unwrap().build().is_ok());
    // A scene from text has no folder: the path is relative to the current one.
    let error = Scene::from_json(&value.to_string(), "scene").unwrap().build().unwrap_err();
    assert!(
        matches!(&error, Error::Linear(qp::LinearError::File { action: "read", path, .. }) if path.ends_with("parts/block.msh")),
        "{error}"
    );
}

#[test]
fn faults_of_a_mesh_are_reported_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let text = std::fs::read_to_string(meshes.join("block-t3.msh")).unwrap();
    std::fs::write(folder.path().join("cut.msh"), &text[..text.len() / 2]).unwrap();
    let value = pressed("plane-strain", json!({"gmsh": {"file": "cut.msh"}}), "y", &[("bottom", "y")]);
    let read = Scene::from_json(&value.to_string(), "scene").unwrap();
    let error = Scene { folder: Some(folder.path().into()), ..read }.build().unwrap_err();
    assert!(matches!(&error, Error::Linear(qp::LinearError::FileSyntax { line, .. }) if *line > 20), "{error}");
    assert!(error.to_string().contains("cut.msh:"), "{error}");
}

#[test]
fn invalid_bodies_are_refused_at_their_path() {
    let on = |model: &str, body: Value| {
        let value = pressed(model, body, if model == "space" { "z" } else { "y" }, &[("bottom", "y")]);
        scene(&value).build().unwrap_err()
    };
    let gmsh = |change: Value| {
        let mut spec = json!({"file": "block-t3.msh"});
        change.as_object().unwrap().iter().for_each(|(key, value)| spec[key] = value.clone());
        json!({"gmsh": spec})
    };
    let disc = |radius: f64, zone: Value| json!({"half-disc": {"radius": radius, "zone": zone}});
    let ball = |radius: f64| json!({"half-ball": {"radius": radius, "zone": {"width": 0.1, "divisions": 2}}});
    let ring = |radius: Value, angle: Value| json!({"ring": {"radius": radius, "angle": angle}});
    let axis = |points: [f64; 2]| json!({"points": points, "divisions": [3]});
    let cases = [
        (on("plane-strain", gmsh(json!({"scale": 0}))), "body.gmsh.scale", "positive and finite"),
        (on("plane-strain", gmsh(json!({"group": "bulk"}))), "body.gmsh", "bottom, right, top, left, body"),
        (on("space", gmsh(json!({}))), "body.gmsh.file", "the mesh is plane, which does not fit the model `space`"),
        (on("plane-strain", gmsh(json!({"file": "box-hex8.msh"}))), "body.gmsh.file", "in space"),
        (on("plane-strain", gmsh(json!({"integration": "mean-dilatation"}))), "body.gmsh.integration", "T3"),
        (on("plane-strain", ball(1.0)), "body.half-ball", "half-disc, ring, gmsh or deck"),
        (
            on("space", disc(1.0, json!({"width": 0.1, "divisions": 2}))),
            "body.half-disc",
            "box, half-ball, gmsh or deck",
        ),
        (on("plane-strain", disc(0.0, json!({"width": 0.1, "divisions": 2}))), "body.half-disc.radius", "positive"),
        (on("plane-strain", disc(1.0, json!({"width": 2, "divisions": 2}))), "body.half-disc.zone.width", "the radius"),
        (
            on("plane-strain", disc(1.0, json!({"width": 1, "divisions": 0}))),
            "body.half-disc.zone.divisions",
            "at least",
        ),
        (on("space", ball(-1.0)), "body.half-ball.radius", "-1"),
        (on("plane-strain", ring(axis([2.0, 1.0]), axis([0.0, 90.0]))), "body.ring.radius.points[1]", "increase"),
        (on("plane-strain", ring(axis([0.0, 1.0]), axis([0.0, 90.0]))), "body.ring", "inner radius is 0"),
        (on("plane-strain", ring(axis([1.0, 2.0]), axis([0.0, 400.0]))), "body.ring", "span 400 degrees"),
        (on("axisymmetric", disc(1.0, json!({"width": 0.1, "divisions": 2}))), "body.half-disc", "x must be >= 0"),
    ];
    for (error, path, phrase) in cases {
        let Error::Scene { path: found, message } = &error else { panic!("{path}: {error}") };
        assert!(found == path && message.contains(phrase), "{error}\n  expected {path}: {phrase}");
    }
}

#[test]
fn an_unknown_boundary_is_refused_with_the_names_of_the_existing_ones() {
    let body = json!({"gmsh": {"file": "block-t3.msh"}});
    let mut value = pressed("plane-strain", body, "y", &[("floor", "y")]);
    let message = scene(&value).build().unwrap_err().to_string();
    assert!(message.contains("`supports[0].on.boundary`") && message.contains("no boundary `floor`"), "{message}");
    assert!(message.contains("bottom, right, top, left"), "{message}");
    value["supports"] = json!([{"on": {"boundary": "bottom"}, "y": 0}]);
    value["obstacles"][0]["boundary"] = json!("stray");
    let message = scene(&value).build().unwrap_err().to_string();
    assert!(message.contains("`obstacles[0].boundary`") && message.contains("no boundary `stray`"), "{message}");
}
