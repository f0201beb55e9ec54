//! `signorini verify` accepts the right answer of a problem directory and rejects every other.

use crate::promised::{CERTIFICATE, has, vectors};
use support::program::{Desk, Problem, Run, matrix, scene, vector};

/// Verifies the answer in the problem directory `p`.
pub fn verify(desk: &Desk, format: &str) -> Run {
    let (u, lambda) = ("p/u.mtx", "p/lambda.mtx");
    desk.run(&["verify", "p", "--displacement", u, "--multiplier", lambda, "--format", format])
}

#[test]
fn verify_accepts_what_solve_wrote_and_rejects_each_single_changed_entry() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    desk.run(&["export", "block.json", "p"]).ends_with(0);
    desk.run(&["solve", "p", "--out", "p"]).ends_with(0);
    let report = verify(&desk, "json").ends_with(0).json();
    has(&report, &[("status", "string"), ("tolerance", "number")]);
    has(&report["certificate"], &CERTIFICATE);
    has(&report["model"], &[("dofs", "count"), ("contact_rows", "count")]);
    assert!(verify(&desk, "text").ends_with(0).stdout.contains("certified to 1.0e-9"));

    let (u, lambda) = vectors(&desk, "p");
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let text = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(f64::to_string).collect();
        vector(&words.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let mut changes = 0;
    for (name, values) in [("u", &u), ("lambda", &lambda)] {
        for index in 0..values.len() {
            // A change of a hundred tolerances of the largest entry.
            let mut changed = values.clone();
            changed[index] += 1e-7 * largest(values);
            desk.write(&format!("p/{name}.mtx"), text(&changed));
            let report = verify(&desk, "json").ends_with(4).json();
            assert_eq!(report["status"], "not_certified", "entry {index} of {name}");
            changes += 1;
        }
        desk.write(&format!("p/{name}.mtx"), text(values));
    }
    assert!(changes > 20);
    verify(&desk, "text").ends_with(0);
}

#[test]
fn verify_rejects_a_multiplier_of_the_wrong_sign() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    desk.write("p/u.mtx", vector(&["0.55", "0.1"]));
    desk.write("p/lambda.mtx", vector(&["1.35"]));
    assert!(verify(&desk, "text").ends_with(4).stdout.contains("NOT certified"));
    desk.write("p/lambda.mtx", vector(&["-1.35"]));
    verify(&desk, "text").ends_with(0);
}

/// The rows contradict each other: two at sight, three only together (`u_1 <= -1`, `u_2 <= -1`, `u_1 + u_2 >= 0`).
#[test]
fn verify_reports_the_infeasibility_of_solve() {
    let b = matrix("general", "3 2", &["1 1 1", "2 2 1", "3 1 -1", "3 2 -1"]);
    let together = Problem { b, g: vector(&["-1", "-1", "0"]), ..Problem::right() };
    for (problem, rows) in [(Problem::infeasible(), 2), (together, 3)] {
        let desk = Desk::new();
        desk.problem("p", &problem);
        let of_solve = desk.run(&["solve", "p", "--format", "json"]).fails_with(3, &["infeasible"]).json();
        desk.write("p/u.mtx", vector(&["-1", "-1"]));
        desk.write("p/lambda.mtx", vector(&vec!["0"; rows]));
        let of_verify = verify(&desk, "json").fails_with(3, &["infeasible"]).json();
        assert_eq!(of_verify["message"], of_solve["message"]);
    }
}

/// Exports a cube whose stiffness has a hierarchy of several levels, with the answer of multigrid in its problem
/// directory.
#[cfg(target_os = "linux")]
fn solved_cube(desk: &Desk, cells: usize) {
    desk.write("cube.json", crate::blocks::cube(cells, "hex8").to_string());
    desk.run(&["export", "cube.json", "p", "--format", "petsc"]).ends_with(0);
    desk.run(&["solve", "cube.json", "--method", "mprgp", "--no-proof", "--pictures", "none", "--out", "o"])
        .ends_with(0);
    for file in ["u.mtx", "lambda.mtx"] {
        desk.write(&format!("p/{file}"), std::fs::read(desk.path("o").join(file)).unwrap());
    }
}

/// Arguments that leave no time for a factor.
#[cfg(target_os = "linux")]
const WITHOUT_FACTOR: [&str; 8] =
    ["verify", "p", "--displacement", "p/u.mtx", "--multiplier", "p/lambda.mtx", "--factor-time", "1e-9"];

/// Both bounds are above the error of the changed answer, which is the energy of the change of one dof.
#[cfg(target_os = "linux")]
#[test]
fn without_time_for_a_factor_the_bound_is_measured_and_at_most_twice_the_proven_one() {
    let desk = Desk::new();
    solved_cube(&desk, 12);
    let without = |desk: &Desk| desk.run(&[&WITHOUT_FACTOR[..], &["--format", "json"]].concat());
    let (measured, proven) = (without(&desk).ends_with(0).json(), verify(&desk, "json").ends_with(0).json());
    assert_eq!(measured["certificate"]["bound_is_measured"], true);
    // A bound from a factor is not called measured.
    assert!(proven["certificate"]["bound_is_measured"].is_null());
    for condition in ["stationarity", "penetration", "adhesion", "complementarity", "duality_gap"] {
        assert_eq!(measured["certificate"][condition], proven["certificate"][condition], "{condition}");
    }
    let (mut u, _) = vectors(&desk, "p");
    let largest = u.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let middle = u.len() / 2;
    u[middle] += 1e-6 * largest;
    let words: Vec<String> = u.iter().map(f64::to_string).collect();
    desk.write("p/u.mtx", vector(&words.iter().map(String::as_str).collect::<Vec<_>>()));
    let (measured, proven) = (without(&desk).ends_with(4).json(), verify(&desk, "json").ends_with(4).json());
    let [measured, proven] =
        [&measured, &proven].map(|report| report["certificate"]["energy_error_bound"].as_f64().unwrap());
    // The proven bound equals the error except for a repair of the rows; the measured one counts its remainder twice.
    assert!(measured > 0.99 * proven && measured < 2.0 * proven, "{measured:e} {proven:e}");
}

/// The memory contains the hierarchy and the problem, but neither the files nor a second matrix. A matrix in a file of
/// PETSc has 12 bytes per entry; hierarchy and problem take about twice as much.
#[cfg(target_os = "linux")]
#[test]
fn verify_without_a_factor_takes_only_the_memory_of_the_hierarchy_and_refuses_a_smaller_limit() {
    let desk = Desk::new();
    solved_cube(&desk, 24);
    let file = std::fs::metadata(desk.path("p/K.petsc")).unwrap().len() as f64;
    let peak = desk.peak(&WITHOUT_FACTOR) - signorini::qp::Estimate::START;
    assert!(peak < 2.4 * file, "{:.2} times the file of the stiffness", peak / file);
    let refused = desk.run(&[&WITHOUT_FACTOR[..], &["--max-memory", "30MB"]].concat());
    refused.fails_with(1, &["the problem does not fit into 30 MB of memory"]);
}
