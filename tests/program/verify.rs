//! `signorini verify` accepts the answer of a problem directory and no other.

use crate::program::{Desk, Problem, Run, scene, vector};
use crate::promised::{CERTIFICATE, has, vectors};

/// Judges the answer that stands beside the problem directory `p`.
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
            // A hundred tolerances of the largest entry.
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
fn verify_rejects_a_multiplier_of_the_other_sign() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    desk.write("p/u.mtx", vector(&["0.55", "0.1"]));
    desk.write("p/lambda.mtx", vector(&["1.35"]));
    assert!(verify(&desk, "text").ends_with(4).stdout.contains("NOT certified"));
    desk.write("p/lambda.mtx", vector(&["-1.35"]));
    verify(&desk, "text").ends_with(0);
}
