//! GOAL: a scene that is exported as PETSc files is read back as the same problem, bit by bit.
//!
//! CONDITIONS: bodies on a line, in the plane, of revolution and in space; supports of single components, inclined
//! supports, springs; the same scenes exported as Matrix Market files.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use signorini::Scene;
use signorini::qp::read_problem;
use support::program::{Desk, scene};

/// A dome pressed onto a table; it slides along its axis and is guided by springs.
fn of_revolution() -> Value {
    json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [5]}, "y": {"points": [0, 1], "divisions": [4]},
                               "element": "q8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "springs": [{"on": {"boundary": "bottom"}, "y": 1e6}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [0, 1], "radius": 2}}}],
        "gap": -0.02
    })
}

/// A block on rollers along three axes; one of its edges has inclined supports.
fn in_space(element: &str) -> Value {
    let axis = |cells: usize| json!({"points": [0, 1], "divisions": [cells]});
    json!({
        "model": "space",
        "body": {"box": {"x": axis(3), "y": axis(2), "z": axis(3), "element": element}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [
            {"on": {"boundary": "left"}, "x": 0},
            {"on": {"boundary": "bottom"}, "z": 0},
            {"on": {"boundary": "front"}, "y": 0.001},
            {"on": {"point": [1, 1, 1]}, "normal": [1, 2, 0]}
        ],
        "springs": [{"on": {"boundary": "right"}, "y": 1e5}],
        "obstacles": [
            {"boundary": "top", "approach": "+z", "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 1}}}
        ],
        "gap": -0.01
    })
}

fn scenes() -> Vec<Value> {
    let read = |file: &str| -> Value {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
    };
    let files = ["tests/faults/plane.json", "tests/faults/space.json", "examples/bar.json", "examples/inclined.json"];
    let mut scenes: Vec<Value> = files.map(read).into();
    let mut tied = scene();
    let term = |x: f64, along: f64| json!({"on": {"point": [x, 0.5]}, "x": along});
    tied["ties"] = json!([{"equation": {"terms": [term(1.0, 1.0), term(0.0, -0.3)], "value": 1e-3}}]);
    scenes.extend([tied, scene(), of_revolution(), in_space("hex8"), in_space("tet10")]);
    scenes
}

/// The report of a command, without its times.
fn report(desk: &Desk, arguments: &[&str]) -> Value {
    let mut report = desk.run(&[arguments, &["--format", "json"]].concat()).ends_with(0).json();
    report.as_object_mut().unwrap().remove("seconds");
    report
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn petsc_files_contain_the_problem_of_the_scene_bit_by_bit() {
    let desk = Desk::new();
    for (number, scene) in scenes().iter().enumerate() {
        let name = format!("{number}.json");
        desk.write(&name, scene.to_string());
        for (folder, form) in [("text", "matrix-market"), ("petsc", "petsc")] {
            let _ = fs::remove_dir_all(desk.path(folder));
            desk.run(&["export", &name, folder, "--format", form]).ends_with(0);
        }
        let [text, petsc] = ["text", "petsc"].map(|folder| read_problem(&desk.path(folder)).unwrap());
        let built = Scene::read(desk.path(&name)).unwrap().build().unwrap();
        assert!(&petsc == built.problem() && petsc == text, "{scene}");
        let values = |problem: &signorini::ContactProblem| {
            let (stiffness, contact) = (problem.stiffness().lower(), problem.contact());
            let modes = problem.near_null().unwrap().vectors().concat();
            [stiffness.values(), problem.load(), contact.values(), problem.gap(), &modes].map(bits)
        };
        assert!(values(&petsc) == values(built.problem()), "{scene}");
        for file in ["dofs.csv", "rows.csv"] {
            let [text, petsc] = ["text", "petsc"].map(|folder| fs::read(desk.path(folder).join(file)).unwrap());
            assert_eq!(text, petsc, "{file}");
        }
    }
}

#[test]
fn commands_give_the_same_answer_for_petsc_and_matrix_market_files() {
    let desk = Desk::new();
    for scene in scenes() {
        desk.write("scene.json", scene.to_string());
        let mut answers = Vec::new();
        for (folder, form) in [("text", "matrix-market"), ("petsc", "petsc")] {
            let _ = fs::remove_dir_all(desk.path(folder));
            desk.run(&["export", "scene.json", folder, "--format", form]).ends_with(0);
            let solved = report(&desk, &["solve", folder, "--out", folder]);
            let [u, lambda] = ["u.mtx", "lambda.mtx"].map(|file| format!("{folder}/{file}"));
            let vectors = [&u, &lambda].map(|file| fs::read_to_string(desk.path(file)).unwrap());
            let mut verify = vec!["verify", folder, "--displacement", &u, "--multiplier", &lambda];
            let mu = format!("{folder}/mu.mtx");
            if desk.path(&mu).exists() {
                verify.extend(["--equality-multiplier", &mu]);
            }
            let rows = fs::read_to_string(desk.path(&format!("{folder}/rows.csv"))).unwrap().lines().count() - 1;
            assert_eq!(solved["model"]["contact_rows"], rows);
            answers.push((solved, vectors, report(&desk, &verify)));
        }
        assert_eq!(answers[0], answers[1], "{scene}");
        assert!(answers[0].1[0].lines().count() > 4 && answers[0].2["status"] == "certified");
    }
}

#[test]
fn compare_sweep_and_tradeoff_read_petsc_files() {
    let desk = Desk::new();
    desk.write("scene.json", scene().to_string());
    desk.run(&["export", "scene.json", "p", "--format", "petsc"]).ends_with(0);
    let compared = desk.run(&["compare", "p", "--format", "json"]).ends_with(0).json();
    assert_eq!(compared["methods"].as_array().unwrap().len(), 3);
    desk.run(&["tradeoff", "p", "--runs", "1", "--format", "json"]).ends_with(0);
    let problem = read_problem(&desk.path("p")).unwrap();
    let deeper: Vec<f64> = problem.gap().iter().map(|gap| gap - 0.01).collect();
    desk.write("p/g1.mtx", signorini::qp::format_vector(&deeper));
    let swept = desk.run(&["sweep", "p", "--points", "3", "--format", "json"]).ends_with(0).json();
    assert!(swept.to_string().contains("certified"), "{swept}");
}

#[test]
fn export_announces_the_number_of_bytes_that_it_writes() {
    let desk = Desk::new();
    desk.write("scene.json", in_space("hex8").to_string());
    for form in ["matrix-market", "petsc"] {
        let said = desk.run(&["export", "scene.json", form, "--format", form]).ends_with(0).stderr;
        let announced = said.strip_prefix("writing ").and_then(|rest| rest.split(' ').next()).unwrap();
        let files = fs::read_dir(desk.path(form)).unwrap();
        let written: u64 = files.map(|file| file.unwrap().metadata().unwrap().len()).sum();
        assert_eq!(announced.parse::<u64>().unwrap(), written, "{said}");
    }
}

#[test]
fn unknowns_without_a_node_and_a_directory_of_both_forms_are_refused() {
    let desk = Desk::new();
    let mut pressed = scene();
    pressed["obstacles"][0]["force"] = json!(1000.0);
    desk.write("pressed.json", pressed.to_string());
    desk.run(&["export", "pressed.json", "p"]).ends_with(0);
    let refused = desk.run(&["export", "pressed.json", "q", "--format", "petsc"]);
    refused.fails_with(1, &["`--format`", "only the unknowns of nodes", "take --format matrix-market"]);
    assert!(!desk.path("q").exists());
    desk.write("scene.json", scene().to_string());
    desk.run(&["export", "scene.json", "p", "--format", "petsc"]).ends_with(0);
    desk.run(&["solve", "p"]).fails_with(1, &["cannot read p: the folder has both K.mtx and K.petsc"]);
    fs::remove_file(desk.path("p/K.mtx")).unwrap();
    desk.run(&["solve", "p"]).ends_with(0);
}

/// Without `near_null.petsc`, the rigid-body modes come from the coordinates of the nodes: multigrid still solves a
/// block.
#[test]
fn coordinates_replace_missing_rigid_body_modes() {
    let desk = Desk::new();
    let mut block = in_space("hex8");
    for axis in ["x", "y", "z"] {
        block["body"]["box"][axis]["divisions"] = json!([9]);
    }
    desk.write("scene.json", block.to_string());
    desk.run(&["export", "scene.json", "p", "--format", "petsc"]).ends_with(0);
    let solve = ["solve", "p", "--method", "mprgp", "--format", "json"];
    let cycles = |desk: &Desk| desk.run(&solve).ends_with(0).json()["iterations"].as_u64().unwrap();
    let with = cycles(&desk);
    fs::remove_file(desk.path("p/near_null.petsc")).unwrap();
    let by_nodes = cycles(&desk);
    fs::remove_file(desk.path("p/coordinates.petsc")).unwrap();
    let without = cycles(&desk);
    assert!(by_nodes <= with + 2 && without > by_nodes, "{with} {by_nodes} {without}");
    assert!(read_problem(&desk.path("p")).unwrap().near_null().is_none());
}
