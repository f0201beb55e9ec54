//! GOAL: what the program prints is true. This is a short form of
//! `cargo run --release --example studies -- fuzz promises 18000 --program target/release/signorini`.
//!
//! CONDITIONS: 300 problems of springs and dense matrices, run as a user runs them. Printed bounds, certified answers
//! and refusals are compared with exact arithmetic, and `verify` gets the exact answers. 40 long chains of rows.

use std::sync::LazyLock;

use rayon::prelude::*;
use serde_json::json;

use support::oracles::promises::draw::chain;
use support::oracles::promises::program::{Ending, Program, write};
use support::oracles::promises::trial::{Class, Findings, Sort, Trial};

const SEED: u64 = 1;

const PROBLEMS: u64 = 300;

fn program() -> Program {
    Program(env!("CARGO_BIN_EXE_signorini").into())
}

/// Class and findings of each problem.
static RUN: LazyLock<Vec<(Class, Findings)>> = LazyLock::new(|| {
    let desk = tempfile::tempdir().unwrap();
    let run = |number: u64| {
        let trial = Trial::draw(SEED, number);
        let mut findings = trial.run(&[program()], &desk.path().join(number.to_string())).unwrap();
        (trial.class, findings.remove(0))
    };
    (0..PROBLEMS).into_par_iter().map(run).collect()
});

#[track_caller]
fn assert_no_fault(sort: Sort) {
    let faults = RUN.iter().enumerate().flat_map(|(number, run)| run.1.faults.iter().map(move |fault| (number, fault)));
    let found: Vec<String> = faults
        .filter(|entry| entry.1.sort == sort)
        .map(|(number, fault)| format!("{number} of seed {SEED}: {}", fault.detail))
        .collect();
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn no_printed_bound_lies_below_the_error() {
    assert_no_fault(Sort::Bound);
}

#[test]
fn no_certified_answer_is_off_by_more_than_its_tolerance() {
    assert_no_fault(Sort::Wrong);
}

#[test]
fn verify_certifies_every_exact_answer_that_moves() {
    assert_no_fault(Sort::Exact);
}

#[test]
fn every_refusal_names_a_dof_and_its_digits() {
    assert_no_fault(Sort::Mute);
}

/// Otherwise the tests above would say nothing of a class.
#[test]
fn problems_of_every_class_are_drawn_and_nearly_all_certified() {
    for class in Class::ALL {
        let of_class: Vec<&Findings> = RUN.iter().filter(|run| run.0 == class).map(|run| &run.1).collect();
        let certified = of_class.iter().filter(|findings| findings.is_certified).count();
        assert!(certified >= 3 && 20 * certified >= 19 * of_class.len(), "{certified} of class {}", class.name());
    }
}

/// An ending that prints `relative` and E = `absolute` for an answer.
fn printed(code: i32, displacement: Vec<f64>, relative: f64, absolute: f64) -> Ending {
    let certificate = json!({"energy_error_bound": relative, "energy_error": absolute, "at_rest": false});
    let status = if code == 0 { "certified" } else { "not_certified" };
    let report = json!({"status": status, "certificate": certificate});
    Ending { code, report, answer: Some((displacement, Vec::new())), sentence: String::new() }
}

#[test]
fn false_bounds_wrong_answers_and_mute_refusals_are_found() {
    let sorts = |trial: &Trial, ending: &Ending| -> Vec<Sort> {
        trial.judged(ending).faults.iter().map(|fault| fault.sort).collect()
    };
    let moving = (0..PROBLEMS).map(|number| Trial::draw(SEED, number)).filter(|trial| trial.class == Class::Wall);
    for trial in moving.take(5) {
        let u = trial.rounded().0;
        // 2^-20 of u is off by 9.5e-7 of |u|_K.
        let off: Vec<f64> = u.iter().map(|u| u * (1.0 - 2.0_f64.powi(-20))).collect();
        let large = f64::MAX.sqrt();
        assert_eq!(sorts(&trial, &printed(0, u, 1e-14, large)), []);
        assert_eq!(sorts(&trial, &printed(0, off.clone(), 1e-6, large)), [Sort::Wrong]);
        assert_eq!(sorts(&trial, &printed(4, off.clone(), 9e-7, large)), [Sort::Bound, Sort::Mute]);
        assert_eq!(sorts(&trial, &printed(4, off, 1e-6, 0.0)), [Sort::Bound, Sort::Mute]);
    }
    // A body at rest that the program moves: the bound is relative to nothing.
    let resting = (0..PROBLEMS).map(|number| Trial::draw(SEED, number)).find(|trial| trial.class == Class::Rest);
    let resting = resting.expect("a problem at rest");
    let moved = vec![1e-300; resting.case.dofs()];
    assert_eq!(sorts(&resting, &printed(0, moved, 0.5, 1.0)), [Sort::Bound, Sort::Wrong]);
}

/// Rows in a long row carry their forces from end to end; a bound that follows them one row at a time finds no end.
#[test]
fn long_chains_of_rows_are_certified() {
    let desk = tempfile::tempdir().unwrap();
    let refused = (0..40_u64).into_par_iter().filter_map(|number| {
        let directory = desk.path().join(number.to_string());
        write(&directory, &chain(SEED, number).unwrap()).unwrap();
        let ending = program().solve(&directory).unwrap();
        (!ending.is_certified()).then(|| format!("{number} of seed {SEED}: {}", ending.sentence))
    });
    let refused: Vec<String> = refused.collect();
    assert!(refused.is_empty(), "{refused:#?}");
}
