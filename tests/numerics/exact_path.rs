//! GOAL: between two gaps the answer is a polyline with exactly known corners.
//!
//! REFERENCE: independent solves at random gaps; enumeration of all contact sets for few rows.

use signorini::qp::{Error, LinearError};
use signorini::{Condense, Prepared, Settings, SparseMatrix, SymmetricMatrix, solve_qp};
use support::oracles::{Draws, random};
use support::scenes::built_example;

/// The path and an independent solve differ by rounding times the condition number of the compliance.
const SAME: f64 = 1e-10;

fn indentation() -> signorini::Model {
    built_example("indentation")
}

#[test]
fn path_agrees_with_independent_solves_at_random_gaps() {
    let model = indentation();
    let problem = model.problem();
    let prepared = Prepared::new(problem, &Settings::default()).unwrap();
    let at = |gap: f64| model.with_gap(gap).unwrap().problem().gap().to_vec();
    let path = prepared.path(&at(0.002), &at(-0.1)).unwrap();
    let mut draws = Draws::new(8);
    for _ in 0..30 {
        let t = draws.uniform();
        let independent = solve_qp(&problem.with_gap(path.gap(t)).unwrap()).unwrap();
        let largest = independent.multiplier.iter().fold(1e-300, |largest: f64, value| largest.max(value.abs()));
        for (a, b) in path.multiplier(t).iter().zip(&independent.multiplier) {
            assert!((a - b).abs() <= SAME * largest, "t = {t}: {a} and {b}");
        }
        assert_eq!(path.contact_set(t), independent.contact_set, "t = {t}");
        let whole = path.solution(t).unwrap();
        assert!((whole.contact_force() - independent.contact_force()).abs() <= SAME * independent.contact_force());
    }
}

#[test]
fn events_of_a_symmetric_indentation_after_the_first_close_pairs_of_rows() {
    let model = indentation();
    let prepared = Prepared::new(model.problem(), &Settings::default()).unwrap();
    let at = |gap: f64| model.with_gap(gap).unwrap().problem().gap().to_vec();
    let path = prepared.path(&at(0.002), &at(-0.1)).unwrap();
    let events = path.events();
    // The node under the apex touches first, then the others in pairs, one on each side: 29 rows are closed at the end.
    assert_eq!(events.len(), 29, "{events:?}");
    assert!((events[0].at - 0.002 / 0.102).abs() < 1e-14 && events[0].row == 20, "{:?}", events[0]);
    for pair in events[1..].chunks(2) {
        assert!(pair.iter().all(|event| event.touches) && (pair[0].at - pair[1].at).abs() < 1e-11, "{pair:?}");
        assert_eq!(pair[0].row + pair[1].row, 40, "{pair:?}");
    }
    assert!(path.corners().windows(2).all(|pair| pair[0] <= pair[1]));
}

/// Problems with many dofs without rows, so that they condense, and gaps that change at random: rows close, open and
/// close again. The path must agree with enumeration everywhere, including its corners.
#[test]
fn rows_that_touch_release_and_touch_again_agree_with_independent_solves() {
    let mut draws = Draws::new(9);
    let (mut touches, mut releases, mut returns) = (0, 0, 0);
    for case in 0..800 {
        let dense = random(&mut draws, 6, 5);
        // Forty more dofs, a chain of springs attached to the first dof.
        let n = 46;
        let mut entries = Vec::new();
        for i in 0..6 {
            (0..=i).for_each(|j| entries.push((i, j, dense.stiffness[(i, j)])));
        }
        for i in 6..n {
            let before = if i == 6 { 0 } else { i - 1 };
            entries.extend([(i, i, 1.0), (before, before, 1.0), (i, before, -1.0), (i, i, 0.1)]);
        }
        let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &entries).unwrap()).unwrap();
        let rows: Vec<_> = (0..5)
            .flat_map(|row| (0..6).map(move |dof| (row, dof)))
            .map(|(row, dof)| (row, dof, dense.contact[(row, dof)]))
            .filter(|entry| entry.2 != 0.0)
            .collect();
        let mut load = vec![0.0; n];
        load[..6].copy_from_slice(dense.load.as_slice());
        let contact = SparseMatrix::from_triplets(5, n, &rows).unwrap();
        let from: Vec<f64> = dense.gap.as_slice().to_vec();
        let to: Vec<f64> = from.iter().map(|gap| gap + 2.0 * draws.signed()).collect();
        let problem = signorini::ContactProblem::new(stiffness, load, contact, from.clone()).unwrap();
        let prepared = Prepared::new(&problem, &Settings::default()).unwrap();
        let path = match prepared.path(&from, &to) {
            Ok(path) => path,
            // The gaps at the end may contradict each other, or there may be too many rows to condense.
            Err(
                Error::Infeasible { .. } | Error::NotCondensed { .. } | Error::Linear(LinearError::Numerical { .. }),
            ) => {
                continue;
            }
            Err(error) => panic!("case {case}: {error}"),
        };
        for event in path.events() {
            touches += usize::from(event.touches);
            releases += usize::from(!event.touches);
        }
        returns += (0..5).filter(|&row| path.events().iter().filter(|event| event.row == row).count() > 1).count();
        let mut places = path.corners();
        places.extend((0..10).map(|_| draws.uniform()));
        for t in places {
            let Ok(independent) = solve_qp(&problem.with_gap(path.gap(t)).unwrap()) else { continue };
            let largest = independent.multiplier.iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
            // Rows may be parallel by chance: their effect on the body is unique, their multipliers are not.
            let force = problem.contact().mul_transposed(&path.multiplier(t));
            for (a, b) in force.iter().zip(problem.contact().mul_transposed(&independent.multiplier)) {
                assert!((a - b).abs() <= 1e-8 * largest, "case {case}, t = {t}: {a} and {b}");
            }
        }
    }
    assert!(touches > 200 && releases > 200 && returns > 3, "{touches} touch, {releases} release, {returns} return");
}

#[test]
fn a_problem_that_is_not_condensed_has_no_path() {
    let model = indentation();
    let prepared = Prepared::new(model.problem(), &Settings::default().with_condensation(Condense::Never)).unwrap();
    let gap = model.problem().gap();
    let result = prepared.path(gap, gap);
    assert!(matches!(result, Err(Error::NotCondensed { .. })));
}
