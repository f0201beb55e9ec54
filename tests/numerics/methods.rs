//! The three methods on problems that are small enough to enumerate all contact sets.

use nalgebra::DMatrix;
use signorini::qp::{Error, LinearError};
use signorini::{
    ContactProblem, InteriorPoint, Method, Penalty, Settings, SparseMatrix, SymmetricMatrix, solve, solve_qp,
};
use support::endings::answer_by;
use support::oracles::{Dense, Draws, random};
use support::{cases, seed};

const EXACT: [Method; 2] = [Method::qp(), Method::ActiveSet];

/// Compares entries to within `tolerance` of the largest expected entry, or of 1e-3 if all are smaller.
#[track_caller]
fn agree(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let size = expected.iter().fold(1e-3, |size: f64, value| size.max(value.abs()));
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance * size, "{what}: entry {i} is {a}, expected {b} (largest {size})");
    }
}

/// GOAL: two springs in a row against a wall.
/// CONDITIONS: k = 2 and 1, a force of 3 at the second end, a gap of 1 there.
/// REFERENCE: derived in the test: u = (1/3, 1), lambda = -7/3.
#[test]
fn two_springs_pressed_against_a_wall_have_the_answer_of_the_closed_form() {
    let dense = Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.0, 3.0], &[&[0.0, 1.0]], &[1.0]);
    let solution = solve_qp(&dense.problem().unwrap()).unwrap();
    agree(&solution.displacement, &[1.0 / 3.0, 1.0], 1e-15, "u");
    agree(&solution.multiplier, &[2.0 / 3.0 - 3.0], 1e-15, "lambda");
    assert_eq!(solution.contact_set.count(), 1);
}

/// Clarabel reads one triangle of K; here no active-set step follows that could correct its answer.
#[test]
fn interior_point_without_polish_uses_the_coupling() {
    let dense = Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.0, 3.0], &[&[0.0, 1.0]], &[1.0]);
    let unpolished = Method::Qp(InteriorPoint { polish: false, ..InteriorPoint::default() });
    let settings = Settings::with_method(unpolished).with_tolerance(1e-6);
    let solution = solve(&dense.problem().unwrap(), &settings).unwrap();
    assert_eq!(solution.method, "qp-unpolished");
    agree(&solution.displacement, &[1.0 / 3.0, 1.0], 1e-6, "u");
}

/// The order of entries, and their division into terms, does not change the matrices.
#[test]
fn order_and_division_of_matrix_entries_change_no_bit_of_the_answer() {
    let entries = [(0, 0, 3.0), (1, 0, -1.0), (1, 1, 2.0), (2, 1, -1.0), (2, 2, 1.0)];
    let shuffled = [(2, 2, 0.5), (1, 1, 2.0), (2, 1, -1.0), (0, 0, 1.0), (2, 2, 0.5), (1, 0, -1.0), (0, 0, 2.0)];
    let [one, other] = [&entries[..], &shuffled[..]].map(|entries| {
        let stiffness = SparseMatrix::from_triplets(3, 3, entries).and_then(SymmetricMatrix::from_lower).unwrap();
        let contact = SparseMatrix::from_triplets(2, 3, &[(1, 2, 1.0), (0, 1, 1.0)]).unwrap();
        solve_qp(&ContactProblem::new(stiffness, vec![1.0, 0.0, 2.0], contact, vec![0.9, 1.0]).unwrap()).unwrap()
    });
    assert_eq!((one.displacement, one.multiplier), (other.displacement, other.multiplier));
}

/// Symmetric positive definite problems from the literature on pivoting, for which the plain loop cycles.
#[test]
fn cycling_examples_end_with_the_enumerated_answer_after_pivoting() {
    let cases = [
        Dense::lcp(&[&[4.0, 5.0, -5.0], &[5.0, 9.0, -5.0], &[-5.0, -5.0, 7.0]], &[2.0, 1.0, -3.0]),
        Dense::lcp(&[&[5.0, -2.0, -4.0], &[-2.0, 2.0, 3.0], &[-4.0, 3.0, 5.0]], &[4.0, -1.0, -3.0]),
    ];
    let exact = [[0.0, 4.0 / 19.0, 11.0 / 19.0], [0.0, 0.0, 0.6]];
    for (dense, x) in cases.iter().zip(exact) {
        for method in EXACT {
            let solution = answer_by(method, &dense.problem().unwrap());
            agree(&solution.displacement, &x, 1e-14, "u");
            agree(
                &solution.displacement,
                dense.enumerate().displacement.as_slice(),
                1e-13,
                "u compared with the enumeration",
            );
        }
    }
    let pivoted = cases
        .iter()
        .filter(|dense| answer_by(Method::ActiveSet, &dense.problem().unwrap()).method != "active-set")
        .count();
    assert!(pivoted >= 1, "no example made the plain loop cycle");
}

#[test]
fn weakly_active_rows_do_not_prolong_the_loop() {
    let dense = Dense::lcp(&[&[12.0, -2.0, -2.0], &[-2.0, 1.0, 1.0], &[-2.0, 1.0, 3.0]], &[0.0, -4.0, -4.0]);
    for method in EXACT {
        let solution = answer_by(method, &dense.problem().unwrap());
        agree(&solution.displacement, &[1.0, 6.0, 0.0], 1e-13, "x");
        assert!(solution.history.len() <= 8, "{} iterations", solution.history.len());
    }
}

#[test]
fn random_problems_agree_with_enumeration() {
    let mut draws = Draws::new(seed(1));
    for case in 0..cases(100, 400) {
        let (n, m) = (1 + draws.below(6), 1 + draws.below(8));
        let dense = random(&mut draws, n, m);
        let exact = dense.enumerate();
        for method in EXACT {
            let solution = answer_by(method, &dense.problem().unwrap());
            agree(&solution.displacement, exact.displacement.as_slice(), 1e-10, &format!("case {case}, {method:?}"));
        }
        let solution = answer_by(Method::penalty(), &dense.problem().unwrap());
        let error = nalgebra::DVector::from_row_slice(&solution.displacement) - &exact.displacement;
        let energy_norm = |u: &nalgebra::DVector<f64>| u.dot(&(&dense.stiffness * u)).max(0.0).sqrt();
        let (distance, bound) =
            (energy_norm(&error) / energy_norm(&exact.displacement), solution.certificate.energy_error_bound);
        // 1e-12, because the enumerated answer is rounded as well.
        assert!(distance <= bound * (1.0 + 1e-3) + 1e-12, "case {case}: {distance:e} exceeds the stated {bound:e}");
    }
}

/// If every row is clearly closed or clearly open, the contact set must be exactly that of the enumeration.
#[test]
fn contact_sets_of_random_problems_are_those_of_the_enumeration() {
    /// Above the rounding of both answers, for data of order one.
    const CLEAR: f64 = 1e-7;
    let mut draws = Draws::new(seed(12));
    let (mut clear, cases) = (0, cases(1_000, 10_000));
    for case in 0..cases {
        let (n, m) = (1 + draws.below(6), 1 + draws.below(10));
        let dense = random(&mut draws, n, m);
        let exact = dense.enumerate();
        let distance = &dense.gap - &dense.contact * &exact.displacement;
        let presses = |row: usize| exact.closed.contains(&row) && exact.multiplier[row] < -CLEAR;
        let stands_off = |row: usize| !exact.closed.contains(&row) && distance[row] > CLEAR;
        if !(0..m).all(|row| presses(row) || stands_off(row)) {
            continue;
        }
        clear += 1;
        for method in EXACT {
            let solution = answer_by(method, &dense.problem().unwrap());
            let closed: Vec<usize> = solution.contact_set.iter().collect();
            assert_eq!(closed, exact.closed, "case {case}, {method:?}");
        }
    }
    assert!(clear > cases * 9 / 10, "{clear} of {cases}");
}

/// A row that just touches is neither proven closed nor proven open.
#[test]
fn grazing_rows_are_proven_neither_closed_nor_open() {
    for dofs in 3..30 {
        // A row of springs whose end is pressed onto its wall: every other dof just reaches its wall, except the first,
        // whose wall is farther away.
        let mut dense = Dense::new(&[], &[], &[], &[]);
        dense.stiffness = nalgebra::DMatrix::from_fn(dofs, dofs, |i, j| match i.abs_diff(j) {
            0 if i == dofs - 1 => 1.0,
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        dense.load = nalgebra::DVector::from_fn(dofs, |dof, _| if dof == dofs - 1 { 2.0 } else { 0.0 });
        dense.contact = nalgebra::DMatrix::identity(dofs, dofs);
        dense.gap = nalgebra::DVector::from_fn(dofs, |row, _| if row == 0 { 1.5 } else { (row + 1) as f64 });
        let problem = dense.problem().unwrap();
        let solution = solve_qp(&problem).unwrap();
        let proven = problem.prove(&solution.displacement, &solution.multiplier).unwrap();
        let proven = proven.expect("the stiffness is definite");
        assert_eq!(proven.undecided().collect::<Vec<_>>(), (1..dofs - 1).collect::<Vec<_>>(), "{dofs} dofs");
        assert!(proven.closed.contains(dofs - 1) && proven.open.contains(0));
    }
}

#[test]
fn plain_loop_ends_although_it_meets_cycles_in_random_symmetric_problems_of_order_three() {
    /// The plain loop ends when it meets a set again, at the latest after all eight sets; pivoting meets at most these
    /// eight, and a few blocks before single pivots.
    const LONGEST: usize = 8 + 1 + 8 + 3;
    let mut draws = Draws::new(seed(2));
    let (mut pivoted, mut single, mut longest) = (0, 0, 0);
    for case in 0..cases(10_000, 100_000) {
        let a = nalgebra::DMatrix::from_fn(3, 3, |_, _| (7.0 * draws.signed()).round());
        let matrix = &a * a.transpose() + nalgebra::DMatrix::identity(3, 3) * 0.1;
        let rows: Vec<Vec<f64>> =
            (0..3).map(|i| (0..3).map(|j| (matrix[(i, j)] + matrix[(j, i)]) / 2.0).collect()).collect();
        let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
        let q: Vec<f64> = (0..3).map(|_| draws.signed()).collect();
        let dense = Dense::lcp(&rows, &q);
        let solution = answer_by(Method::ActiveSet, &dense.problem().unwrap());
        agree(&solution.displacement, dense.enumerate().displacement.as_slice(), 1e-9, &format!("case {case}"));
        pivoted += usize::from(solution.method != "active-set");
        single += usize::from(solution.method == "active-set-single-pivoting");
        longest = longest.max(solution.history.len());
    }
    println!("{pivoted} by pivoting, {single} of these by single rows; at most {longest} iterations");
    assert!(pivoted > 0, "no problem made the plain loop cycle: the fallback was not exercised");
    assert!(longest <= LONGEST, "{longest} iterations");
}

/// A rod of two nodes without supports, k = 1; a wall at 0.5 in front of its second node.
fn rod(load: [f64; 2]) -> Dense {
    Dense::new(&[&[1.0, -1.0], &[-1.0, 1.0]], &load, &[&[0.0, 1.0]], &[0.5])
}

#[test]
fn floating_rod_pressed_onto_the_wall_is_solved() {
    for method in EXACT {
        let solution = answer_by(method, &rod([1.0, 0.5]).problem().unwrap());
        agree(&solution.displacement, &[1.5, 0.5], 1e-12, "u");
        agree(&solution.multiplier, &[-1.5], 1e-12, "lambda");
        assert!(
            solution.certificate.energy_error_bound < 1e-12,
            "K is singular, but the row that presses holds the rod"
        );
    }
}

#[test]
fn floating_rod_pulled_away_is_unbounded_with_the_escape_direction() {
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        match solve(&rod([-1.0, 0.0]).problem().unwrap(), &Settings::with_method(method)) {
            Err(Error::Unbounded { direction, .. }) => agree(&direction, &[-1.0, -1.0], 1e-9, "direction"),
            other => panic!("{method:?}: {other:?}"),
        }
    }
}

#[test]
fn floating_rod_without_load_is_not_unique() {
    for method in [Method::qp(), Method::ActiveSet] {
        let result = solve(&rod([0.0, 0.0]).problem().unwrap(), &Settings::with_method(method));
        assert!(matches!(result, Err(Error::UnderHeld { .. })), "{method:?}: {result:?}");
    }
}

#[test]
fn rod_without_support_or_wall_is_under_held_or_unbounded_by_its_load() {
    let mut dense = rod([1.0, -1.0]);
    dense.gap[0] = f64::INFINITY;
    assert!(matches!(solve_qp(&dense.problem().unwrap()), Err(Error::UnderHeld { .. })));
    dense.load[0] = 2.0;
    assert!(matches!(solve_qp(&dense.problem().unwrap()), Err(Error::Unbounded { .. })));
}

#[test]
fn indefinite_stiffness_is_refused() {
    for shear in [1.2, 2.0, 5.0] {
        let contact: [&[f64]; 2] = [&[1.0, 0.0], &[0.0, 1.0]];
        let dense = Dense::new(&[&[1.0, shear], &[shear, 1.0]], &[0.0, 1.0], &contact, &[1.0, 1.0]);
        let result = solve_qp(&dense.problem().unwrap());
        assert!(matches!(result, Err(Error::Linear(LinearError::NotConvex { .. }))), "{shear}: {result:?}");
    }
    let negative = Dense::new(&[&[-1.0]], &[0.0], &[&[1.0]], &[1.0]).problem();
    assert!(matches!(negative, Err(Error::Linear(LinearError::NotConvex { .. }))), "{negative:?}");
}

#[test]
fn bounds_that_cross_are_infeasible_and_bounds_that_meet_are_an_equality() {
    let two_sided = |lower: f64, upper: f64| {
        let contact: [&[f64]; 2] = [&[0.0, 1.0], &[0.0, -1.0]];
        Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.0, 3.0], &contact, &[upper, -lower])
    };
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        match solve(&two_sided(1.0, 1.0 - 1e-9).problem().unwrap(), &Settings::with_method(method)) {
            Err(Error::Infeasible { rows, .. }) => assert_eq!(rows, [0, 1]),
            other => panic!("{method:?}: {other:?}"),
        }
    }
    for method in EXACT {
        let solution = answer_by(method, &two_sided(1.0, 1.0).problem().unwrap());
        agree(&solution.displacement, &[1.0 / 3.0, 1.0], 1e-14, "u");
        let net = solution.multiplier[0] - solution.multiplier[1];
        assert!((net + 7.0 / 3.0).abs() < 1e-12, "net force {net}");
    }
}

/// Three inclined rows that no displacement of one node meets; a verified Farkas vector shows the contradiction.
#[test]
fn rows_that_contradict_in_three_directions_are_infeasible() {
    let contact: [&[f64]; 3] = [&[0.0, 1.0], &[0.8, -0.6], &[-0.8, -0.6]];
    let dense = Dense::new(&[&[2.0, 0.0], &[0.0, 1.0]], &[0.3, 1.0], &contact, &[-0.5, 0.1, 0.1]);
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        match solve(&dense.problem().unwrap(), &Settings::with_method(method)) {
            Err(Error::Infeasible { rows, .. }) => assert_eq!(rows, [0, 1, 2]),
            other => panic!("{method:?}: {other:?}"),
        }
    }
}

#[test]
fn duplicate_rows_share_the_force() {
    let contact: [&[f64]; 3] = [&[0.0, 1.0], &[0.0, 1.0], &[0.0, 2.0]];
    let dense = Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.0, 3.0], &contact, &[1.0, 1.0, 2.0]);
    for method in EXACT {
        let solution = answer_by(method, &dense.problem().unwrap());
        agree(&solution.displacement, &[1.0 / 3.0, 1.0], 1e-14, "u");
        let sum = solution.multiplier[0] + solution.multiplier[1] + 2.0 * solution.multiplier[2];
        assert!((sum + 7.0 / 3.0).abs() < 1e-13, "sum of the multipliers {sum}");
    }
}

/// k = 1, f = 2, g = 0.3: lambda = -1.7 exactly. The error falls as k/eps and does not end in rounding.
#[test]
fn penalty_error_falls_tenfold_from_rung_to_rung() {
    let dense = Dense::new(&[&[1.0]], &[2.0], &[&[1.0]], &[0.3]);
    let mut errors = Vec::new();
    for rung in 0..9 {
        let ladder = Penalty { last: 10.0_f64.powi(rung), ..Penalty::default() };
        let settings = Settings::with_method(Method::Penalty(ladder));
        let lambda = match solve(&dense.problem().unwrap(), &settings) {
            Ok(solution) => solution.multiplier[0],
            Err(Error::NotCertified { solution, .. }) => solution.multiplier[0],
            Err(error) => panic!("{error}"),
        };
        errors.push((lambda / -1.7 - 1.0).abs());
    }
    for (rung, error) in errors.iter().enumerate() {
        let expected = 1.0 / (1.0 + 10.0_f64.powi(rung as i32));
        assert!((error / expected - 1.0).abs() < 1e-2, "eps = 1e{rung}: {error:e}, expected {expected:e}");
    }
}

#[test]
fn answers_scale_bit_for_bit_with_powers_of_two() {
    let mut draws = Draws::new(3);
    for case in 0..50 {
        let (n, m) = (1 + draws.below(5), 1 + draws.below(5));
        let dense = random(&mut draws, n, m);
        for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
            let reference = answer_by(method, &dense.problem().unwrap());
            for (a, b) in [(8.0, 0.5), (2.0_f64.powi(-301), 2.0_f64.powi(77)), (2.0_f64.powi(333), 2.0_f64.powi(-300))]
            {
                let mut other = dense.clone();
                other.stiffness *= a;
                other.load *= a * b;
                other.gap *= b;
                let scaled = answer_by(method, &other.problem().unwrap());
                for (x, y) in reference.displacement.iter().zip(&scaled.displacement) {
                    assert_eq!(x * b, *y, "case {case}, {method:?}: displacement");
                }
                for (x, y) in reference.multiplier.iter().zip(&scaled.multiplier) {
                    assert_eq!(x * a * b, *y, "case {case}, {method:?}: multiplier");
                }
            }
        }
    }
}

#[test]
fn rows_without_obstacle_and_rows_without_dofs_do_not_constrain_the_answer() {
    let contact: [&[f64]; 3] = [&[0.0, 1.0], &[0.0, 0.0], &[1.0, 0.0]];
    let mut dense =
        Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.0, 3.0], &contact, &[f64::INFINITY, 0.2, f64::INFINITY]);
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        let solution = answer_by(method, &dense.problem().unwrap());
        agree(&solution.displacement, &[1.5, 4.5], 1e-14, "u");
        assert_eq!(solution.multiplier, [0.0; 3]);
    }
    dense.gap[1] = -0.2;
    match solve_qp(&dense.problem().unwrap()) {
        Err(Error::Infeasible { rows, .. }) => assert_eq!(rows, [1]),
        other => panic!("{other:?}"),
    }
}

#[test]
fn empty_and_unloaded_problems_have_the_answer_zero() {
    let empty = Dense::new(&[], &[], &[], &[]);
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        let solution = answer_by(method, &empty.problem().unwrap());
        assert!(solution.displacement.is_empty() && solution.contact_force() == 0.0);
    }
    let still = Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.0, 0.0], &[&[0.0, 1.0]], &[0.0]);
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        let solution = answer_by(method, &still.problem().unwrap());
        assert_eq!((solution.displacement, solution.multiplier), (vec![0.0; 2], vec![0.0]));
    }
}

/// An interior-point method with the tolerance 1e-12 may end far from it. The plan then makes another attempt, and
/// keeps the better answer.
#[test]
fn an_interior_point_that_comes_no_further_is_followed_by_a_better_attempt() {
    const TOLD: InteriorPoint = InteriorPoint { polish: false, tolerance: 1e-12 };
    let mut farthest = 0.0_f64;
    let first = seed(0);
    // Few cases end far from it: fewer than these would have none.
    for case in first..first + cases(4_000, 40_000) {
        let mut random = Draws::new(case);
        let n = 2 + (case % 12) as usize;
        // Scales of the dofs that differ by up to eight orders of magnitude.
        let scale: Vec<f64> = (0..n).map(|_| 10.0_f64.powf(4.0 * random.signed())).collect();
        let factor = DMatrix::from_fn(n, n, |_, _| random.signed());
        let product: DMatrix<f64> = &factor * factor.transpose() + DMatrix::identity(n, n) * 1e-3;
        let lower = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let entries: Vec<_> = lower.map(|(i, j)| (i, j, scale[i] * scale[j] * product[(i, j)])).collect();
        let rows: Vec<_> = (0..n).map(|dof| (dof, dof, 1.0)).collect();
        let problem = ContactProblem::new(
            SparseMatrix::from_triplets(n, n, &entries).and_then(SymmetricMatrix::from_lower).unwrap(),
            scale.iter().map(|scale| scale * random.signed()).collect(),
            SparseMatrix::from_triplets(n, n, &rows).unwrap(),
            scale.iter().map(|scale| 0.1 * random.signed().abs() / scale).collect(),
        );
        let problem = problem.unwrap();
        let settings = Settings::with_method(Method::Qp(TOLD));
        let solution = match solve(&problem, &settings) {
            Ok(solution) => solution,
            // Clarabel reached its own tolerance: its answer is kept as it is.
            Err(Error::NotCertified { solution, .. }) if solution.method == "qp-unpolished" => continue,
            Err(error) => panic!("case {case}: {error}"),
        };
        // Without a tolerance of the certificate, the same method shows how far it came, with its true bound.
        if solution.method != "qp-unpolished" {
            let mut accepting = settings.clone();
            accepting.tolerance = None;
            let alone = solve(&problem, &accepting).unwrap();
            assert_eq!(alone.method, "qp-unpolished", "case {case}");
            farthest = farthest.max(alone.certificate.energy_error_bound);
        }
    }
    assert!(farthest > 1e-3, "no case ends far from its tolerance: {farthest:e}");
}
