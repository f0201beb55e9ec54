//! GOAL: a problem directory may contain the motions without energy, and multigrid then solves it like its scene.
//!
//! CONDITIONS: an exported scene; coordinates of a body without supports; files that do not match the problem.

use std::fs;
use std::path::Path;

use serde_json::json;
use signorini::{ContactProblem, Method, Settings, qp, solve};
use support::bodies::{clamped_block, clamped_square};
use support::program::Desk;
use support::scenes::built;

fn write(folder: &Path, problem: &ContactProblem) {
    // Without the near-null space.
    for file in &problem.files()[..4] {
        fs::write(folder.join(file.name), file.text()).unwrap();
    }
}

#[test]
fn an_exported_scene_is_solved_by_multigrid_as_the_scene_itself() {
    let desk = Desk::new();
    desk.write("scene.json", clamped_block(8, -0.01).to_string());
    desk.run(&["export", "scene.json", "problem"]).ends_with(0);
    let answers = ["scene.json", "problem"]
        .map(|input| desk.run(&["solve", input, "--method", "mprgp", "--format", "json"]).ends_with(0).json());
    for field in ["method", "iterations", "status"] {
        assert_eq!(answers[0][field], answers[1][field], "{field}");
    }
    assert_eq!(answers[0]["method"], "mprgp");
    assert_eq!(answers[0]["contact"]["force"], answers[1]["contact"]["force"]);
    assert_eq!(answers[0]["certificate"]["bound_is_measured"], true);
    assert!(answers[0]["certificate"]["energy_error_bound"].as_f64().unwrap() <= 1e-6);
    let report = desk.run(&["solve", "problem", "--method", "mprgp"]).ends_with(0).stdout;
    assert!(report.lines().any(|line| line.contains("energy error") && line.ends_with(", measured")), "{report}");
    let rough = desk.run(&["solve", "problem", "--method", "mprgp", "--accuracy", "1e-3"]).ends_with(0).stdout;
    assert!(rough.contains("certified to 1.0e-3, each relative") && rough.contains(", measured"), "{rough}");
}

/// A square without supports, pushed against a row at each node of its top, and its nodes. Two opposite rows guide a
/// corner along x.
fn unsupported() -> (ContactProblem, Vec<[f64; 3]>) {
    let plane = json!({"plane": {"point": [0, 1], "normal": [0, 1]}});
    let model = built(&clamped_square(30, json!([{"boundary": "top", "approach": "+y", "shape": plane}]), 0.0));
    let body = model.body();
    let free = vec![None; body.nodal_dofs()];
    let dofs = signorini::fem::DofMap::new(free).unwrap();
    let stiffness = signorini::fem::stiffness(body, &dofs).unwrap();
    let mut entries: Vec<_> = model.rows().iter().enumerate().map(|(row, at)| (row, 2 * at.node + 1, 1.0)).collect();
    let rows = model.rows().len() + 2;
    entries.extend([(rows - 2, 0, 1.0), (rows - 1, 0, -1.0)]);
    let contact = signorini::SparseMatrix::from_triplets(rows, body.nodal_dofs(), &entries).unwrap();
    let mut load = vec![0.0; body.nodal_dofs()];
    load.iter_mut().skip(1).step_by(2).for_each(|force| *force = 1.0);
    let problem = ContactProblem::new(stiffness, load, contact, vec![0.0; rows]).unwrap();
    (problem, model.mesh().nodes().to_vec())
}

#[test]
fn coordinates_give_the_rigid_body_modes() {
    let (problem, nodes) = unsupported();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &problem);
    let without = qp::read_problem(folder.path()).unwrap();
    assert!(without.near_null().is_none());
    let columns = [0, 1].map(|axis| nodes.iter().map(|node| format!("{:e}\n", node[axis])).collect::<String>());
    let head = format!("%%MatrixMarket matrix array real general\n{} 2\n", nodes.len());
    fs::write(folder.path().join("coordinates.mtx"), format!("{head}{}{}", columns[0], columns[1])).unwrap();
    let with = qp::read_problem(folder.path()).unwrap();
    assert_eq!(with.near_null().unwrap().count(), 3);
    // The rotation has no energy: K times the rotation is rounding.
    let rotation = &with.near_null().unwrap().vectors()[2];
    let moved = problem.stiffness().mul(rotation);
    let terms = problem.stiffness().mul_abs(rotation);
    assert!(moved.iter().zip(&terms).all(|(moved, terms)| moved.abs() <= 1e-13 * terms));
    let solution = solve(&with, &Settings::with_method(Method::Mprgp)).unwrap_or_else(|error| panic!("{error}"));
    let pushed: f64 = problem.load().iter().sum();
    assert!((solution.contact_force() - pushed).abs() <= 1e-8 * pushed, "the rows do not carry the whole load");
}

#[test]
fn files_that_do_not_match_are_named_with_the_allowed_size() {
    let problem = built(&clamped_block(2, -0.01)).problem().clone();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &problem);
    let dofs = problem.dofs();
    let refused = |name: &str, shape: [usize; 2], value: &str, words: &[&str]| {
        let values = format!("{value}\n").repeat(shape[0] * shape[1]);
        let text = format!("%%MatrixMarket matrix array real general\n{} {}\n{values}", shape[0], shape[1]);
        fs::write(folder.path().join(name), text).unwrap();
        let error = qp::read_problem(folder.path()).unwrap_err().to_string();
        fs::remove_file(folder.path().join(name)).unwrap();
        for word in [name].iter().chain(words) {
            assert!(error.contains(word), "{error:?} does not contain {word:?}");
        }
    };
    refused("near_null.mtx", [dofs - 1, 3], "1", &[&format!("it must have {dofs} rows")]);
    refused("near_null.mtx", [dofs, 2], "1", &["linearly independent"]);
    refused("coordinates.mtx", [dofs, 3], "1", &[&format!("there are {dofs}"), "a row for each node"]);
    refused("coordinates.mtx", [dofs / 3, 3], "1", &["linearly independent"]);
}
