//! GOAL: bars against a wall, and a string and a membrane over a flat obstacle. CONDITIONS: the obstacle problems are
//! given as matrices of linear elements; an indentation at three gaps. REFERENCE: `closed_forms::Bar`,
//! `closed_forms::ObstacleString`, `closed_forms::DiscMembrane`; for the indentation the stored answers of cvxpy and
//! OSQP.

use std::time::Instant;

use crate::closed_forms::{Bar, DiscMembrane, ObstacleString};
use serde_json::{Value, json};
use signorini::{ContactProblem, Error, Scene, SparseMatrix, SymmetricMatrix, solve_qp};

use super::answer::{Answer, Solved};

/// A bar of length 2 with EA = 100 and a gap of 0.03, under an end force of 4 and under a load of 4 per length.
pub fn bars() -> Result<Vec<Answer>, Error> {
    let closed = Bar { length: 2.0, axial_stiffness: 100.0, gap: 0.03 };
    let end = ("bar, end force", json!({"force": {"at": [2], "value": [4]}}), closed.reaction_to_end_force(4.0));
    let along = ("bar, distributed load", json!({"body-force": [40]}), closed.reaction_to_distributed_load(4.0));
    let bar = |(case, load, exact): (&str, Value, f64)| {
        let solved = Solved::of(&json!({
            "model": "bar",
            "body": {"bar": {"x": {"points": [0, 2], "divisions": [40]}, "area": 0.1}},
            "material": {"young": 1e3, "poisson": 0.3},
            "supports": [{"on": {"boundary": "left"}, "x": 0}],
            "loads": [load],
            "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2.03], "normal": [1]}}}],
        }))?;
        Ok(solved.answer(case, "force on the wall", solved.force(), exact))
    };
    [end, along].into_iter().map(bar).collect()
}

/// A string of 2000 linear elements and a membrane of 800, each on a flat obstacle.
pub fn obstacle_problems() -> Result<Vec<Answer>, Error> {
    let (string, membrane) = (ObstacleString { load: 1.0, gap: 0.08 }, DiscMembrane { load: 8.0, gap: 0.25 });
    let answer = |case: &str, cells, problem: &dyn Fn(usize) -> Result<ContactProblem, Error>, exact| {
        let clock = Instant::now();
        let problem = problem(cells)?;
        let ours = solve_qp(&problem)?.contact_force();
        let (unknowns, seconds) = (problem.dofs(), clock.elapsed().as_secs_f64());
        let (element, quantity) = ("raw QP", "force".into());
        Ok::<_, Error>(Answer { case: case.into(), element, unknowns, quantity, ours, exact, seconds })
    };
    Ok(vec![
        answer("string on an obstacle", 2000, &|cells| string_problem(&string, cells), string.force())?,
        answer("membrane over a disc", 800, &|cells| membrane_problem(&membrane, cells), membrane.force())?,
    ])
}

/// The string: -u'' = -q on (0, 1), fixed at both ends.
fn string_problem(string: &ObstacleString, cells: usize) -> Result<ContactProblem, Error> {
    let (n, h) = (cells - 1, 1.0 / cells as f64);
    let mut stiffness: Vec<_> = (0..n).map(|i| (i, i, 2.0 / h)).collect();
    stiffness.extend((1..n).map(|i| (i, i - 1, -1.0 / h)));
    pushed(&stiffness, vec![-string.load * h; n], string.gap)
}

/// The membrane: -(r u')' = -q r on (0, 1), fixed at r = 1, multiplied by 2 pi.
fn membrane_problem(membrane: &DiscMembrane, cells: usize) -> Result<ContactProblem, Error> {
    let h = 1.0 / cells as f64;
    let (mut stiffness, mut load) = (Vec::new(), vec![0.0; cells]);
    let circle = 2.0 * std::f64::consts::PI;
    for cell in 0..cells {
        let (left, right) = (cell as f64 * h, (cell + 1) as f64 * h);
        let k = circle * (left + right) / 2.0 / h;
        stiffness.push((cell, cell, k));
        load[cell] -= circle * membrane.load * h * (2.0 * left + right) / 6.0;
        if cell + 1 < cells {
            stiffness.extend([(cell + 1, cell, -k), (cell + 1, cell + 1, k)]);
            load[cell + 1] -= circle * membrane.load * h * (left + 2.0 * right) / 6.0;
        }
    }
    pushed(&stiffness, load, membrane.gap)
}

/// Makes a problem from entries of the lower triangle of K, with a row -u <= gap for every dof.
fn pushed(stiffness: &[(usize, usize, f64)], load: Vec<f64>, gap: f64) -> Result<ContactProblem, Error> {
    let n = load.len();
    let rows: Vec<_> = (0..n).map(|i| (i, i, -1.0)).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, stiffness)?)?;
    Ok(ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(n, n, &rows)?, vec![gap; n])?)
}

/// Compares the indentation at three gaps with the stored answers of cvxpy, Clarabel and OSQP.
pub fn stored_answers() -> Result<Vec<Answer>, Box<dyn std::error::Error>> {
    let root = crate::root();
    let stored: Value = serde_json::from_str(&std::fs::read_to_string(root.join("reference/results.json"))?)?;
    let base = Scene::read(root.join("examples/indentation.json"))?.build()?;
    let mut answers = Vec::new();
    for gap in [-0.01, -0.05, -0.1] {
        let clock = Instant::now();
        let model = base.with_gap(gap)?;
        let ours = solve_qp(model.problem())?.contact_force();
        answers.push(Answer {
            case: format!("indentation, gap {gap}, against cvxpy and OSQP"),
            element: model.mesh().kind_of(0).name(),
            unknowns: model.problem().dofs(),
            quantity: "force".into(),
            ours,
            exact: stored["cases"][format!("indentation {gap:.2}")]["force"].as_f64().ok_or("no stored force")?,
            seconds: clock.elapsed().as_secs_f64(),
        });
    }
    Ok(answers)
}
