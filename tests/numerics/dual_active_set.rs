//! The dual active-set method alone, and as the last fallback of the other methods. Rows are dependent, equal, or
//! nearly parallel in energy; answers are compared with the enumeration of all contact sets, with exact answers and
//! with the conditions of the solution.

use nalgebra::{DMatrix, DVector};
use signorini::qp::{Ending, Error, Outcome};
use signorini::{ContactProblem, Method, Settings, SparseMatrix, SymmetricMatrix, solve};
use support::oracles::{Dense, Draws, random};
use support::{cases, seed};

/// `|u - u*|_K / |u*|_K`.
fn energy_error(dense: &Dense, displacement: &[f64], exact: &DVector<f64>) -> f64 {
    let off = DVector::from_column_slice(displacement) - exact;
    let square = |x: &DVector<f64>| x.dot(&(&dense.stiffness * x)).max(0.0);
    let size = square(exact);
    (square(&off) / if size > 0.0 { size } else { 1.0 }).sqrt()
}

/// The conditions must hold to rounding: a hundred units in the last place of the terms.
const ROUNDED: f64 = 100.0 * f64::EPSILON;

/// Largest violations of the conditions of the solution, each relative to its terms: force, penetration, tension,
/// complementarity relative to the energies.
fn conditions(dense: &Dense, outcome: &Outcome) -> [f64; 4] {
    let u = DVector::from_column_slice(&outcome.displacement);
    let lambda = DVector::from_column_slice(&outcome.multiplier);
    let transposed = dense.contact.transpose();
    let residual = &dense.stiffness * &u - &dense.load - &transposed * &lambda;
    let forces = dense.stiffness.abs() * u.abs() + dense.load.abs() + transposed.abs() * lambda.abs();
    let violation = &dense.contact * &u - &dense.gap;
    let lengths = dense.contact.abs() * u.abs() + dense.gap.abs();
    let worst = |values: &DVector<f64>, terms: &DVector<f64>| {
        let shares = values.iter().zip(terms.iter()).filter(|entry| *entry.0 > 0.0).map(|(value, term)| value / term);
        shares.fold(0.0, f64::max)
    };
    let energy = u.dot(&(&dense.stiffness * &u)).max(dense.load.abs().dot(&u.abs()));
    let work = lambda.dot(&violation).abs();
    let complementarity = if work == 0.0 { 0.0 } else { work / energy };
    [worst(&residual.abs(), &forces), worst(&violation, &lengths), lambda.max().max(0.0), complementarity]
}

/// Scales rows by 1e-8 to 1e8, and replaces half of the rows by the row before or by the sum of the two rows before.
fn make_dependent(draws: &mut Draws, dense: &mut Dense) {
    for row in 1..dense.gap.len() {
        let before = (dense.contact.row(row - 1).into_owned(), dense.gap[row - 1]);
        let (direction, gap) = match draws.below(4) {
            0 => before,
            1 if row > 1 => (before.0 + dense.contact.row(row - 2), before.1 + dense.gap[row - 2]),
            _ => continue,
        };
        dense.contact.set_row(row, &direction);
        dense.gap[row] = gap;
    }
    scale_rows(draws, dense);
}

fn scale_rows(draws: &mut Draws, dense: &mut Dense) {
    for row in 0..dense.gap.len() {
        let factor = 10.0_f64.powi(draws.below(17) as i32 - 8);
        let direction = dense.contact.row(row) * factor;
        dense.contact.set_row(row, &direction);
        dense.gap[row] *= factor;
    }
}

#[test]
fn random_problems_have_the_answer_of_the_best_of_all_contact_sets() {
    let mut draws = Draws::new(seed(17));
    for case in 0..cases(100, 1000) {
        let (n, m) = (1 + draws.below(6), 1 + draws.below(9));
        let dense = random(&mut draws, n, m);
        let outcome = dense.problem().unwrap().dual_active_set(true).unwrap();
        let error = energy_error(&dense, &outcome.displacement, &dense.enumerate().displacement);
        assert!(outcome.is_settled() && error <= 1e-11, "case {case}: {error:e}");
    }
}

/// Enumeration loses digits if rows are scaled and nearly singular sets are tried; the conditions of the solution do
/// not.
#[test]
fn conditions_hold_to_rounding_with_equal_and_dependent_rows_in_other_units() {
    let mut draws = Draws::new(seed(18));
    for case in 0..cases(100, 1000) {
        let (n, m) = (1 + draws.below(6), 1 + draws.below(9));
        let mut dense = random(&mut draws, n, m);
        make_dependent(&mut draws, &mut dense);
        let outcome = dense.problem().unwrap().dual_active_set(true).unwrap();
        let found = conditions(&dense, &outcome);
        assert!(outcome.is_settled() && found.iter().all(|&value| value <= ROUNDED), "case {case}: {found:?}");
    }
}

/// Springs of 1e-2 to 1e2 between `n` dofs and to the ground, rows `u_i+1 - u_i <= g`, and one dof held only by a
/// spring of 1e-6 and its rows. Its two rows move almost nothing else, so that they are nearly parallel in energy.
fn network(draws: &mut Draws, n: usize) -> Dense {
    let loose = draws.below(n);
    let mut stiffness = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in [draws.below(n), draws.below(n)] {
            if i == j || i == loose || j == loose {
                continue;
            }
            let spring = 10.0_f64.powf(2.0 * draws.signed());
            stiffness[(i, i)] += spring;
            stiffness[(j, j)] += spring;
            stiffness[(i, j)] -= spring;
            stiffness[(j, i)] -= spring;
        }
        stiffness[(i, i)] += if i == loose { 1e-6 } else { draws.uniform() };
    }
    let mut contact = DMatrix::zeros(n - 1, n);
    (0..n - 1).for_each(|row| (contact[(row, row)], contact[(row, row + 1)]) = (-1.0, 1.0));
    let inside = DVector::from_fn(n, |_, _| 4.0 * draws.signed());
    let gap = &contact * &inside + DVector::from_fn(n - 1, |_, _| draws.uniform());
    let load = &stiffness * DVector::from_fn(n, |_, _| 6.0 * draws.signed());
    Dense { stiffness, load, contact, gap }
}

#[test]
fn networks_with_a_weakly_held_part_are_solved_to_rounding() {
    let mut draws = Draws::new(seed(3));
    for case in 0..cases(100, 1000) {
        let n = 6 + draws.below(55);
        let dense = network(&mut draws, n);
        let outcome = dense.problem().unwrap().dual_active_set(true).unwrap();
        let found = conditions(&dense, &outcome);
        assert!(outcome.is_settled() && found.iter().all(|&value| value <= ROUNDED), "case {case}: {found:?}");
    }
}

/// With several hundred closed rows, the basis must be updated for each row, not computed anew.
#[test]
fn a_network_of_600_dofs_is_solved_to_rounding() {
    let mut draws = Draws::new(4);
    let dense = network(&mut draws, 600);
    let outcome = dense.problem().unwrap().dual_active_set(true).unwrap();
    let found = conditions(&dense, &outcome);
    assert!(outcome.is_settled() && found.iter().all(|&value| value <= ROUNDED), "{found:?}");
    assert!(outcome.contact_set.count() > 200, "{}", outcome.contact_set.count());
}

/// A chain without supports, cut in places, under a load that only its rows balance.
#[test]
fn bodies_held_by_their_rows_alone_are_solved_to_rounding() {
    let mut draws = Draws::new(seed(6));
    let (mut settled, count) = (0, cases(100, 1000));
    for case in 0..count {
        let (n, m) = (2 + draws.below(5), 1 + draws.below(8));
        let mut dense = random(&mut draws, n, m);
        dense.stiffness.fill(0.0);
        for i in (0..n - 1).filter(|_| draws.uniform() < 0.8).collect::<Vec<_>>() {
            let spring = 10.0_f64.powf(2.0 * draws.signed());
            dense.stiffness[(i, i)] += spring;
            dense.stiffness[(i + 1, i + 1)] += spring;
            dense.stiffness[(i, i + 1)] -= spring;
            dense.stiffness[(i + 1, i)] -= spring;
        }
        let push = dense.contact.transpose() * DVector::from_fn(m, |_, _| draws.uniform());
        dense.load = &dense.stiffness * DVector::from_fn(n, |_, _| draws.signed()) + push;
        let outcome = dense.problem().unwrap().dual_active_set(false).unwrap();
        let found = conditions(&dense, &outcome);
        settled += usize::from(outcome.is_settled());
        assert!(!outcome.is_settled() || found.iter().all(|&value| value <= ROUNDED), "case {case}: {found:?}");
    }
    assert!(100 * settled >= 99 * count, "{settled} of {count}");
}

/// The last row contradicts a sum of other rows by `overlap`; each row has other units. All numbers have few digits, so
/// that the rows depend on each other exactly.
fn contradicting(draws: &mut Draws, overlap: f64) -> Dense {
    let few = |value: f64| (value * 1024.0).round() / 1024.0;
    let (n, m) = (2 + draws.below(6), 3 + draws.below(8));
    let mut dense = random(draws, n, m);
    dense.contact.apply(|value| *value = few(*value));
    dense.gap.apply(|value| *value = few(*value));
    let others = 1 + draws.below(m - 1);
    let weights = DVector::from_fn(m, |row, _| if row < others { few(draws.uniform()) + 1.0 } else { 0.0 });
    dense.contact.set_row(m - 1, &(-weights.transpose() * &dense.contact));
    dense.gap[m - 1] = -weights.dot(&dense.gap) - overlap;
    for row in 0..m {
        let unit = 2.0_f64.powi(draws.below(55) as i32 - 27);
        let direction = dense.contact.row(row) * unit;
        dense.contact.set_row(row, &direction);
        dense.gap[row] *= unit;
    }
    dense
}

#[test]
fn contradicting_rows_are_found_with_weights_that_the_problem_verifies() {
    let mut draws = Draws::new(seed(5));
    for case in 0..cases(100, 1000) {
        let overlap = 2.0_f64.powi(-(draws.below(20) as i32));
        let dense = contradicting(&mut draws, overlap);
        let problem = dense.problem().unwrap();
        let Ending::Infeasible { rows, weights } = problem.dual_active_set(true).unwrap().ending else {
            panic!("case {case}: an overlap of {overlap:e} is not found");
        };
        assert!(problem.overlap(&rows, &weights).is_some(), "case {case}: {rows:?} {weights:?}");
    }
}

/// The same rows with one entry changed in its last place: then a displacement, however large, meets them.
#[test]
fn rows_that_miss_a_contradiction_by_one_rounding_are_not_called_infeasible() {
    let mut draws = Draws::new(seed(7));
    for case in 0..cases(100, 1000) {
        let mut dense = contradicting(&mut draws, 0.125);
        let last = dense.gap.len() - 1;
        // If the other rows have full rank, no displacement meets all rows; so the last row gets an additional dof.
        let n = dense.load.len();
        dense.stiffness = dense.stiffness.insert_row(n, 0.0).insert_column(n, 0.0);
        dense.stiffness[(n, n)] = 1.0;
        dense.contact = dense.contact.insert_column(n, 0.0);
        dense.contact[(last, n)] = dense.contact.row(last).amax() * f64::EPSILON;
        dense.load = dense.load.insert_row(n, 0.0);
        let found = dense.problem().unwrap().dual_active_set(true);
        assert!(
            found.as_ref().is_ok_and(|found| !matches!(found.ending, Ending::Infeasible { .. })),
            "case {case}: {found:?}"
        );
    }
}

/// The methods on a factor; each has the dual active set as its last fallback.
const METHODS: [Method; 4] = [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty()];

#[track_caller]
fn agrees(dense: &Dense, displacement: &[f64], multiplier: &[f64]) {
    let problem = dense.problem().unwrap();
    for method in METHODS {
        let found =
            solve(&problem, &Settings::with_method(method)).unwrap_or_else(|error| panic!("{method:?}: {error}"));
        let exact = DVector::from_column_slice(displacement);
        assert!(energy_error(dense, &found.displacement, &exact) <= 1e-12, "{method:?}: {:?}", found.displacement);
        let strongest = multiplier.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        for (row, (value, exact)) in found.multiplier.iter().zip(multiplier).enumerate() {
            assert!((value - exact).abs() <= 1e-9 * strongest, "{method:?}, row {row}: {value:e}, not {exact:e}");
        }
    }
}

/// Stiffness 1 and 1e-6, rows u_0 + u_1 <= -1 and u_0 - u_1 <= -2: in energy they differ by 2e-3 from parallel.
#[test]
fn two_rows_that_share_a_soft_dof_are_both_closed_exactly() {
    let dense = Dense::new(&[&[1.0, 0.0], &[0.0, 1e-6]], &[0.0, 0.0], &[&[1.0, 1.0], &[1.0, -1.0]], &[-1.0, -2.0]);
    agrees(&dense, &[-1.5, 0.5], &[-0.74999975, -0.75000025]);
}

/// With K the identity and zero gaps, the answer is the point of the cone `B u <= 0` nearest to f. Here it is the apex,
/// at which all rows are closed, more rows than dofs. f is a sum of the first two rows, and only these have a force.
#[test]
fn an_apex_of_more_rows_than_dofs_has_the_multipliers_of_the_rows_that_push() {
    let rows: [&[f64]; 5] = [&[1.0, 0.0], &[0.0, 1.0], &[-1.0, 1e-3], &[-1.0, -1.0], &[1e-3, -1.0]];
    let dense = Dense::new(&[&[1.0, 0.0], &[0.0, 1.0]], &[1.0, 2.0], &rows, &[0.0; 5]);
    let found = dense.problem().unwrap().dual_active_set(true).unwrap();
    assert!(found.is_settled() && found.displacement.iter().all(|u| u.abs() <= 1e-15), "{found:?}");
    let force = dense.contact.transpose() * DVector::from_column_slice(&found.multiplier);
    assert!((force + dense.load).amax() <= 1e-15, "{found:?}");
}

/// Row 1, row 2 and twice row 3 add up to `0 <= -4`; row 0 does not contribute.
#[test]
fn every_method_finds_that_three_rows_contradict_each_other() {
    let rows: [&[f64]; 4] = [&[-1.0, 1.0, 1.0], &[1.0, 0.0, 1.0], &[-1.0, 0.0, 1.0], &[0.0, 0.0, -1.0]];
    let identity: [&[f64]; 3] = [&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0]];
    let problem = Dense::new(&identity, &[0.0; 3], &rows, &[-1.0; 4]).problem().unwrap();
    for method in METHODS {
        let Err(Error::Infeasible { rows, weights, overlap, .. }) = solve(&problem, &Settings::with_method(method))
        else {
            panic!("{method:?} finds no contradiction");
        };
        assert_eq!((&rows[..], overlap), (&[1, 2, 3][..], 2.0), "{method:?}");
        assert_eq!(problem.overlap(&rows, &weights), Some(overlap));
    }
}

#[test]
fn networks_are_certified_by_every_exact_method() {
    let mut draws = Draws::new(8);
    for case in 0..100 {
        let n = 6 + draws.below(20);
        let problem = network(&mut draws, n).problem().unwrap();
        for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
            if let Err(error) = solve(&problem, &Settings::with_method(method)) {
                panic!("case {case}, {method:?}: {error}");
            }
        }
    }
}

/// A floating body of springs of 2^52 whose load is in balance to the last bit: condensation causes a rounding error in
/// it that must not count as a load.
#[test]
fn a_load_in_balance_does_not_drive_a_body_away() {
    let spring = 2.0_f64.powi(52);
    let line = |dof: usize| -> [f64; 5] {
        let mut line = [0.0; 5];
        (line[dof.saturating_sub(1)], line[(dof + 1).min(4)]) = (-spring, -spring);
        line[dof] = if dof == 0 || dof == 4 { spring } else { 2.0 * spring };
        line
    };
    let lines = [0, 1, 2, 3, 4].map(line);
    let stiffness: Vec<&[f64]> = lines.iter().map(|line| &line[..]).collect();
    let load = [0.3, 0.1, -0.7, 0.25, 0.05].map(|f: f64| (f * spring).round());
    let balance = load.iter().sum::<f64>();
    let load = [load[0] - balance, load[1], load[2], load[3], load[4]];
    assert_eq!(load.iter().sum::<f64>(), 0.0);
    // On one side of the body the rounding pulls away from the row, on the other it presses onto it.
    let ends = [-1.0, 1.0].map(|side| {
        let row = [0.0, 0.0, side, 0.0, 0.0];
        let problem = Dense::new(&stiffness, &load, &[&row[..]], &[0.5]).problem().unwrap();
        solve(&problem, &Settings::default()).map_or_else(|error| error.code(), |_| "certified")
    });
    assert!(ends.contains(&"under-held") && !ends.contains(&"unbounded"), "{ends:?}");
}

/// With zero stiffness and zero load, every displacement that meets the rows is an answer: the problem is semidefinite,
/// not indefinite.
#[test]
fn a_stiffness_of_zero_is_under_held_and_convex() {
    let empty = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(3, 3, &[]).unwrap()).unwrap();
    let rows = [(0, 0, -0.875), (0, 1, -0.75), (0, 2, -0.375), (1, 0, -1.5), (1, 1, 0.5), (1, 2, -0.5)];
    let last = [(2, 0, 0.5), (2, 1, 0.75), (2, 2, 0.25)];
    let contact = SparseMatrix::from_triplets(3, 3, &[&rows[..], &last].concat()).unwrap();
    let problem = ContactProblem::new(empty, vec![0.0; 3], contact, vec![-0.002, -0.0015, 0.0016]).unwrap();
    for method in METHODS {
        let error = solve(&problem, &Settings::with_method(method)).unwrap_err();
        assert_eq!(error.code(), "under-held", "{method:?}: {error}");
    }
}

/// A load that is large compared with the others acts on a dof that the motion does not move.
#[test]
fn a_motion_is_driven_only_by_the_loads_on_the_dofs_that_it_moves() {
    let dense = Dense::new(&[&[1.0, 0.0], &[0.0, 0.0]], &[1e12, -1.0], &[&[0.0, 1.0]], &[0.5]);
    let error = solve(&dense.problem().unwrap(), &Settings::default()).unwrap_err();
    assert_eq!(error.code(), "unbounded", "{error}");
}

/// Corrections shrink an answer of zero further and further; they must end before the limit of double precision.
#[test]
fn an_answer_at_an_apex_in_the_origin_is_certified() {
    let mut draws = Draws::new(9);
    for case in 0..200 {
        let mut dense = random(&mut draws, 4, 8);
        dense.gap.fill(0.0);
        dense.load = dense.contact.transpose() * DVector::from_fn(8, |_, _| draws.uniform());
        let problem = dense.problem().unwrap();
        let found = solve(&problem, &Settings::default());
        assert!(found.is_ok(), "case {case}: {:?}", found.err().map(|error| error.to_string()));
    }
}
