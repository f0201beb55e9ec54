//! The trade-off of a small scene: errors that fall with the settings of the methods, the Pareto front, files.

use serde_json::{Value, json};
use signorini::output::InWords;
use signorini::scene::Units;
use signorini::study::{Tradeoff, TradeoffGrid, TradeoffPoint};
use signorini::{Scene, Watch};
use support::program::{Desk, scene};

fn measured(value: &Value) -> Tradeoff {
    let scene = Scene::from_json(&value.to_string(), "scene").unwrap();
    Tradeoff::of_scene(&scene, &TradeoffGrid { refinements: 1, runs: 1, ..TradeoffGrid::default() }, &Watch::default())
        .unwrap()
}

#[test]
fn errors_fall_with_the_tolerance_and_with_the_penalty() {
    let result = measured(&scene());
    assert_eq!(result.meshes.iter().map(|mesh| mesh.dofs).collect::<Vec<_>>(), [20, 72]);
    assert!(result.meshes[1].discretisation_error < result.meshes[0].discretisation_error);
    for mesh in 0..2 {
        for condensed in [true, false] {
            let of = |method: &str| -> Vec<&TradeoffPoint> {
                let is_meant = |point: &&TradeoffPoint| {
                    point.mesh == mesh && point.condensed == condensed && point.method == method
                };
                result.points.iter().filter(is_meant).collect()
            };
            let (qp, penalty) = (of("qp"), of("penalty"));
            let error_at = |points: &[&TradeoffPoint], knob: f64| {
                points.iter().find(|point| point.knob == Some(knob)).unwrap().energy_error
            };
            // An interior point with a loose tolerance may stop with a smaller error than promised, but not by six
            // digits.
            assert!(error_at(&qp, 1e-10) < 1e-3 * error_at(&qp, 1e-2), "{qp:?}");
            // The error of a penalty is k/(k + eps): a hundredth if the penalty is a hundred times larger.
            let ratio = error_at(&penalty, 1e4) / error_at(&penalty, 1e6);
            assert!((ratio / 100.0 - 1.0).abs() < 0.01, "{ratio}");
            for point in of("qp, polished").into_iter().chain(of("active-set")) {
                assert!(point.energy_error < 1e-12 && point.force_error < 1e-12 && point.rows_wrong == 0, "{point:?}");
            }
        }
    }
    for point in &result.points {
        assert!(point.seconds > 0.0 && point.energy_error.is_finite());
        assert!(point.energy_error <= point.energy_error_bound + 1e-12, "{point:?}");
    }
}

/// The times of certificate and proof are separate, multigrid is one of the methods, and the text compares the errors
/// of loose answers.
#[test]
fn the_text_compares_time_and_error_of_loose_and_exact_answers() {
    let result = measured(&scene());
    assert!(result.points.iter().all(|point| point.certificate_seconds > 0.0 && point.proof_seconds >= 0.0));
    let cycles: Vec<&TradeoffPoint> = result.points.iter().filter(|point| point.method == "mprgp").collect();
    assert_eq!(cycles.len(), 10, "there are five accuracies on two meshes");
    assert!(cycles.iter().all(|point| point.energy_error_bound <= point.knob.unwrap()), "{cycles:?}");
    // On a scene of twenty dofs the fastest method is random; so the times are set: each further digit takes one
    // percent more time.
    let mut timed = result.clone();
    for point in &mut timed.points {
        point.seconds = 1e-3 * (1.0 - 0.01 * point.energy_error.max(1e-16).log10());
    }
    let text = timed.text("block", &Units::unnamed());
    assert!(text.contains("the last penalty over the local stiffness"), "{text}");
    for method in ["penalty", "qp", "mprgp"] {
        let line = text.lines().find(|line| line.starts_with(&format!("  {method} ")) && line.contains(" and loses "));
        assert!(
            line.is_some_and(|line| line.contains("; active-set on ") && line.ends_with(" s and loses nothing")),
            "{text}"
        );
    }
    // A penalty of a hundred times the stiffness has an error of the force that is far above rounding.
    let lost = text.lines().find(|line| line.starts_with("  penalty") && line.contains(" % of the force"));
    assert!(lost.is_some(), "{text}");
}

/// The total error combines the errors of algebra and mesh; the chosen mesh and method are the best of all points.
#[test]
fn a_total_error_or_a_time_chooses_mesh_and_method() {
    let result = measured(&scene());
    for point in &result.points {
        let (of_mesh, total) = (result.meshes[point.mesh].discretisation_error.unwrap(), point.total_error.unwrap());
        assert!(total >= of_mesh.max(point.energy_error), "{point:?}");
        assert!(total <= of_mesh + point.energy_error, "{point:?}");
    }
    let chosen: Vec<_> = result.advice.iter().filter(|advice| advice.chooses_mesh).collect();
    let wanted: Vec<_> = chosen.iter().map(|advice| (advice.total_error, advice.seconds)).collect();
    let (error, time) = (|total| (Some(total), None), |seconds| (None, Some(seconds)));
    assert_eq!(wanted, [error(0.1), error(0.03), error(0.01), time(0.1), time(1.0), time(10.0)]);
    for advice in &chosen[..3] {
        let good = |point: &&TradeoffPoint| point.total_error.unwrap() <= advice.total_error.unwrap();
        let soonest = result.points.iter().filter(good).map(|point| point.seconds).fold(f64::INFINITY, f64::min);
        assert_eq!(advice.point.map_or(f64::INFINITY, |index| result.points[index].seconds), soonest);
    }
    // Ten seconds suffice for every point of this small scene, so the finer mesh is chosen.
    let best = &result.points[chosen[5].point.unwrap()];
    assert!(
        best.mesh == 1 && best.total_error.unwrap() < 1.02 * result.meshes[1].discretisation_error.unwrap(),
        "{best:?}"
    );
    let text = result.text("block", &Units::unnamed());
    assert!(text.contains("  in 10 s") && text.contains("72 dofs by "), "{text}");
}

/// Smaller errors are rounding and count as equal.
const ROUNDING: f64 = 1e-12;

#[test]
fn no_point_dominates_the_front_and_the_advice_is_on_it() {
    let result = measured(&scene());
    let beaten = |point: &TradeoffPoint| {
        result.points.iter().any(|other| {
            let [error, beaten] = [other, point].map(|point| point.energy_error.max(ROUNDING));
            other.mesh == point.mesh && other.seconds < point.seconds && error <= beaten
        })
    };
    for mesh in 0..2 {
        assert!(result.points.iter().any(|point| point.mesh == mesh && point.best));
    }
    assert!(result.points.iter().filter(|point| point.best).all(|point| !beaten(point)));
    let wanted: Vec<f64> = result.advice.iter().filter_map(|advice| advice.accuracy).collect();
    assert_eq!(wanted, [1e-2, 1e-4, 1e-8]);
    for advice in result.advice.iter().filter(|advice| !advice.chooses_mesh) {
        let Some(index) = advice.point else { continue };
        let chosen = &result.points[index];
        assert!(!beaten(chosen), "{chosen:?}");
        assert_eq!(chosen.mesh, 0);
        if let Some(accuracy) = advice.accuracy {
            let good = |point: &&TradeoffPoint| point.mesh == 0 && point.energy_error <= accuracy;
            assert!(result.points.iter().filter(good).all(|point| point.seconds >= chosen.seconds));
            assert!(chosen.energy_error <= accuracy);
        }
    }
}

#[test]
fn finer_meshes_are_nested_and_a_mesh_file_cannot_be_refined() {
    let graded = json!({"points": [0, 1, 3], "divisions": [4, 1], "ratios": [5, 1]});
    let mut value = scene();
    value["body"]["rectangle"]["x"] = graded;
    let coarse = Scene::from_json(&value.to_string(), "scene").unwrap();
    let fine = coarse.refined(3).unwrap();
    let nodes = |scene: &Scene| scene.build().unwrap().mesh().nodes().to_vec();
    let fine_nodes = nodes(&fine);
    assert_eq!(fine_nodes.len(), 16 * 7);
    for node in nodes(&coarse) {
        let nearest =
            fine_nodes.iter().map(|at| (at[0] - node[0]).hypot(at[1] - node[1])).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-12, "{node:?}: {nearest}");
    }
    value["body"] = json!({"gmsh": {"file": "any.msh"}});
    let error = Scene::from_json(&value.to_string(), "scene").unwrap().refined(2).unwrap_err();
    assert!(error.to_string().contains("body.gmsh"), "{error}");
    assert!(coarse.refined(0).is_err());
}

/// With cells four times finer along every edge, the number of nodes grows by about 4, 16 or 64 in one, two or three
/// dimensions.
#[test]
fn every_body_that_is_not_from_a_file_can_be_refined() {
    let line = json!({"points": [0, 1], "divisions": [12]});
    let (zone, centre) = (json!({"width": 0.2, "divisions": 8, "growth": 1.1}), json!([0, 1]));
    let angle = json!({"points": [-90, 0], "divisions": [12]});
    let bodies = [
        (1, json!({"bar": {"x": line}})),
        (2, json!({"rectangle": {"x": line, "y": line, "element": "q4"}})),
        (3, json!({"box": {"x": line, "y": line, "z": line, "element": "hex8"}})),
        (2, json!({"ring": {"radius": {"points": [1, 2], "divisions": [12]}, "angle": angle, "centre": centre}})),
        (2, json!({"half-disc": {"centre": centre, "radius": 1, "zone": zone}})),
        (2, json!({"disc": {"centre": centre, "radius": 1, "zone": zone}})),
        (3, json!({"half-ball": {"centre": [0, 0, 1], "radius": 1, "zone": zone}})),
    ];
    for (dimension, body) in bodies {
        let mut value = scene();
        value["body"] = body.clone();
        let coarse = Scene::from_json(&value.to_string(), "scene").unwrap();
        let growth = coarse.refined(4).unwrap().size().nodes / coarse.size().nodes;
        let all = 4.0_f64.powi(dimension);
        assert!((0.5 * all..1.2 * all).contains(&growth), "{body}: {growth}");
        assert_eq!(coarse.refined(1).unwrap().size().nodes, coarse.size().nodes);
    }
}

#[test]
fn tradeoff_prints_the_table_and_writes_its_values() {
    let desk = Desk::new();
    desk.write("scene.json", scene().to_string());
    let command = ["tradeoff", "scene.json", "--refinements", "1", "--runs", "1", "--out", "out"];
    let run = desk.run(&command).ends_with(0);
    let phrases = [
        "mesh of the scene: 20 dofs",
        "each edge of the scene's cells divided into 2",
        "active-set",
        "penalty",
        "misclassified rows",
    ];
    for phrase in phrases.into_iter().chain(["What to choose", "a tenth of the reference method's time"]) {
        assert!(run.stdout.contains(phrase), "{}", run.stdout);
    }
    let csv = std::fs::read_to_string(desk.path("out/tradeoff.csv")).unwrap();
    let columns = csv.lines().next().unwrap().split(',').count();
    let json = desk.run(&[&command[..6], &["--format", "json"]].concat()).ends_with(0).json();
    let points = json["points"].as_array().unwrap().len();
    assert_eq!(csv.lines().count(), points + 1);
    // Only the field in quotation marks may contain a comma.
    assert!(csv.lines().skip(1).all(|line| line.replace(", ", " ").split(',').count() == columns));
    assert!(desk.path("out/total-error.png").exists());
    assert!(desk.path("out/tradeoff.png").exists() && desk.path("out/tradeoff.txt").exists());
    desk.run(&["tradeoff", "missing.json"]).fails_with(1, &["missing.json"]);
    desk.run(&["tradeoff", "scene.json", "--runs", "0"]).ends_with(2);
    desk.run(&["tradeoff", "scene.json", "--refinements", "9"]).ends_with(2);
}

/// Matrices have no mesh: the trade-off is the algebraic part of that of their scene.
#[test]
fn tradeoff_of_a_problem_directory_has_the_algebraic_errors_of_its_scene() {
    let desk = Desk::new();
    desk.write("scene.json", scene().to_string());
    desk.run(&["export", "scene.json", "matrices"]).ends_with(0);
    let run = desk.run(&["tradeoff", "matrices", "--runs", "1", "--format", "json", "--out", "out"]);
    let found = run.ends_with(0).json();
    let points = found["points"].as_array().unwrap();
    let of_scene = measured(&scene());
    assert_eq!(points.len(), of_scene.points.iter().filter(|point| point.mesh == 0).count());
    for (point, same) in points.iter().zip(&of_scene.points) {
        assert_eq!((&point["method"], &point["rows_wrong"]), (&json!(same.method), &json!(same.rows_wrong)));
        assert!(point.get("total_error").is_none() && point.get("pressure_error").is_none(), "{point}");
        let error = point["energy_error"].as_f64().unwrap();
        assert!((error - same.energy_error).abs() <= 1e-3 * same.energy_error + 1e-10, "{point} {same:?}");
    }
    assert!(found["meshes"][0].get("discretisation_error").is_none(), "{found}");
    let text = std::fs::read_to_string(desk.path("out/tradeoff.txt")).unwrap();
    assert!(text.contains("matrices: 20 dofs") && text.contains("What to choose:\n"), "{text}");
    assert!(!text.contains("Which mesh"), "{text}");
    assert!(desk.path("out/tradeoff.png").exists() && !desk.path("out/total-error.png").exists());
}

/// With almost no time only the mesh of the scene is used, and with much time all requested meshes are used.
#[test]
fn meshes_are_as_fine_as_the_time_allows() {
    let desk = Desk::new();
    desk.write("scene.json", scene().to_string());
    let meshes = |time: &str| {
        let limits = ["--refinements", "2", "--time", time, "--runs", "1", "--format", "json"];
        let run = desk.run(&[&["tradeoff", "scene.json"], &limits[..]].concat());
        run.ends_with(0).json()["meshes"].as_array().unwrap().len()
    };
    assert_eq!([meshes("1e-6"), meshes("1e6")], [1, 3]);
}
