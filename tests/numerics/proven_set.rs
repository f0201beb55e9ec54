//! The proven contact set: it is never wrong, at any accuracy, and it is complete if the answer is accurate.

use signorini::qp::{Condense, Method, Settings};
use signorini::{ContactProblem, InteriorPoint, Penalty, Solution, SparseMatrix, SymmetricMatrix, solve};
use support::endings::best;
use support::random::springs;
use support::scenes::built_example;
use support::{cases, seed};

/// Forces and distances below this share of the largest may be zero in the exact answer.
const WEAK: f64 = 1e-9;

fn answer(problem: &ContactProblem, mut settings: Settings) -> Solution {
    settings.prove = true;
    best(solve(problem, &settings))
}

/// Methods with settings from rough to exact.
fn ways() -> Vec<Settings> {
    let mut ways = Vec::new();
    for condense in [Condense::Auto, Condense::Never] {
        let base = |method| {
            let mut settings = Settings::with_method(method);
            settings.condense = condense;
            settings
        };
        for tolerance in [1e-1, 1e-2, 1e-4, 1e-8] {
            ways.push(base(Method::Qp(InteriorPoint { polish: false, tolerance })));
        }
        for last in [1e0, 1e2, 1e4, 1e8] {
            let ladder = Penalty { last, penetration_threshold: 0.0, ..Penalty::default() };
            ways.push(base(Method::Penalty(ladder)));
        }
        ways.push(base(Method::ActiveSet));
    }
    ways
}

#[test]
fn no_open_row_is_proven_closed_and_no_closed_row_open() {
    let (first, count) = (seed(0), cases(100, 1000));
    let (mut proven, mut wrong_sets, mut rows) = (0, 0, 0);
    for seed in first..first + count {
        let problem = springs(seed);
        let exact = answer(&problem, Settings::with_method(Method::ActiveSet));
        let strongest = exact.multiplier.iter().fold(0.0_f64, |most, value| most.max(-value));
        for settings in ways() {
            let found = answer(&problem, settings.clone());
            wrong_sets += u64::from(found.contact_set != exact.contact_set);
            let Some(set) = &found.proven else { continue };
            for row in 0..problem.rows() {
                rows += 1;
                if set.open.contains(row) {
                    assert!(-exact.multiplier[row] <= WEAK * strongest, "seed {seed}, row {row}, {settings:?}");
                    proven += 1;
                }
                if set.closed.contains(row) {
                    assert!(exact.multiplier[row] < 0.0, "seed {seed}, row {row}, {settings:?}");
                    assert!(!set.open.contains(row));
                    proven += 1;
                }
            }
        }
    }
    println!("{proven} of {rows} rows proven; {wrong_sets} answers with a wrong set");
    // The test is effective only if some answers are rough; nevertheless most rows are proven.
    assert!(wrong_sets > count);
    assert!(proven > rows / 2);
}

#[test]
fn every_row_of_an_exact_answer_is_proven_if_contact_is_strict() {
    let (first, mut undecided) = (seed(0), 0);
    for seed in first..first + cases(100, 1000) {
        let problem = springs(seed);
        let found = answer(&problem, Settings::with_method(Method::ActiveSet));
        let strongest = found.multiplier.iter().fold(0.0_f64, |most, value| most.max(-value));
        let violation = problem.violation(&found.displacement);
        let set = found.proven.expect("the body is supported by springs to the ground");
        for row in set.undecided() {
            let strict = -found.multiplier[row] > 1e-6 * strongest || -violation[row] > 1e-6;
            // Two rows on one dof may divide their force in any ratio.
            undecided += usize::from(strict && !shares_its_dofs(&problem, row));
        }
    }
    assert_eq!(undecided, 0);
}

fn shares_its_dofs(problem: &ContactProblem, row: usize) -> bool {
    let by_row = problem.contact().transposed();
    by_row.column(row).any(|(dof, _)| problem.contact().column(dof).count() > 1)
}

#[test]
fn the_rows_of_the_examples_are_proven_at_default_settings() {
    for name in support::program::examples() {
        let model = built_example(&name);
        for condense in [Condense::Auto, Condense::Never] {
            let mut settings = Settings::default();
            settings.condense = condense;
            if let Some(set) = answer(model.problem(), settings).proven {
                assert_eq!(set.undecided().collect::<Vec<_>>(), [0; 0], "{name}, {condense:?}");
            }
        }
    }
}

#[test]
fn a_grazing_row_is_undecided() {
    // A spring of stiffness 2 under a force of 4 moves by 2, exactly to the wall.
    let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]).unwrap();
    let stiffness = SymmetricMatrix::from_lower(one(2.0)).unwrap();
    let problem = ContactProblem::new(stiffness, vec![4.0], one(1.0), vec![2.0]).unwrap();
    let found = answer(&problem, Settings::default());
    assert_eq!(found.proven.unwrap().undecided().collect::<Vec<_>>(), [0]);
    // A force that is larger or smaller by a thousandth decides the state.
    for (load, closed) in [(4.004, true), (3.996, false)] {
        let found = answer(&problem.with_load(vec![load]).unwrap(), Settings::default()).proven.unwrap();
        assert_eq!((found.closed.contains(0), found.open.contains(0)), (closed, !closed));
    }
}

#[test]
fn a_row_that_touches_without_force_is_undecided_even_in_an_exact_answer() {
    let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]).unwrap();
    let problem =
        ContactProblem::new(SymmetricMatrix::from_lower(one(2.0)).unwrap(), vec![0.0], one(1.0), vec![0.0]).unwrap();
    assert_eq!(problem.certify(&[0.0], &[0.0]).unwrap().energy_error_bound, 0.0);
    assert_eq!(problem.prove(&[0.0], &[0.0]).unwrap().unwrap().undecided().collect::<Vec<_>>(), [0]);
}

#[test]
fn two_rows_that_share_both_their_dofs_are_proven_closed_by_a_shift_of_both() {
    // No dof belongs to only one of the rows. With K = 1 and B = (1, 1/2; 1/2, 1), forces of one at u = (1, 1) balance
    // a load of 5/2.
    let unit = [(0, 0, 1.0), (1, 1, 1.0)];
    let rows = [(0, 0, 1.0), (0, 1, 0.5), (1, 0, 0.5), (1, 1, 1.0)];
    let matrix = |entries: &[(usize, usize, f64)]| SparseMatrix::from_triplets(2, 2, entries).unwrap();
    let stiffness = SymmetricMatrix::from_lower(matrix(&unit)).unwrap();
    let problem = ContactProblem::new(stiffness, vec![2.5; 2], matrix(&rows), vec![1.5; 2]).unwrap();
    let proven = problem.prove(&[1.0; 2], &[-1.0; 2]).unwrap().unwrap();
    assert_eq!((proven.closed.count(), proven.open.count()), (2, 0));
}

#[test]
fn two_equal_rows_are_both_undecided() {
    let rows = SparseMatrix::from_triplets(2, 1, &[(0, 0, 1.0), (1, 0, 1.0)]).unwrap();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, 2.0)]).unwrap()).unwrap();
    let problem = ContactProblem::new(stiffness, vec![4.0], rows, vec![1.0, 1.0]).unwrap();
    let proven = problem.prove(&[1.0], &[-1.0, -1.0]).unwrap().unwrap();
    assert_eq!(proven.undecided().collect::<Vec<_>>(), [0, 1]);
    assert!(problem.prove(&[1.0, 2.0], &[-1.0, -1.0]).is_err());
}
