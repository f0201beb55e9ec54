//! The dual active-set method on its own, and as the last fallback of the others: rows that are dependent, equal, or
//! nearly parallel in energy, against all contact sets enumerated, exact answers and the conditions of the solution.

use crate::oracles::{Dense, Draws, random};
use nalgebra::{DMatrix, DVector};
use signorini::method::{Outcome, ScaledProblem, dual_active_set};
use signorini::sparse::AugmentedMatrix;
use signorini::{ContactProblem, Error};

/// Runs the method on a problem as it stands; `definite` is what is known of its stiffness.
fn run(problem: &ContactProblem, definite: bool) -> Result<Outcome, Error> {
    let augmented = AugmentedMatrix::new(problem.stiffness(), problem.contact()).unwrap();
    let found = dual_active_set::solve(&ScaledProblem::new(problem, &augmented, definite))?;
    Ok(found.expect("small enough"))
}

/// `|u - u*|_K / |u*|_K`.
fn energy_error(dense: &Dense, displacement: &[f64], exact: &DVector<f64>) -> f64 {
    let off = DVector::from_column_slice(displacement) - exact;
    let square = |x: &DVector<f64>| x.dot(&(&dense.stiffness * x)).max(0.0);
    let size = square(exact);
    (square(&off) / if size > 0.0 { size } else { 1.0 }).sqrt()
}

/// Conditions that hold to rounding: a hundred units in the last place of the terms.
const ROUNDED: f64 = 100.0 * f64::EPSILON;

/// Largest violations of the conditions of the solution, each beside its own terms: force, penetration, pull,
/// complementarity beside the energies.
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

/// Rows in other units, from 1e-8 to 1e8, and half of them equal to the row before or the sum of the two before.
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
    let mut draws = Draws::new(17);
    for case in 0..1000 {
        let (n, m) = (1 + draws.below(6), 1 + draws.below(9));
        let dense = random(&mut draws, n, m);
        let outcome = run(&dense.problem().unwrap(), true).unwrap();
        let error = energy_error(&dense, &outcome.displacement, &dense.enumerate().displacement);
        assert!(outcome.settled && error <= 1e-11, "case {case}: {error:e}");
    }
}

/// Enumeration loses digits where rows are scaled and nearly singular sets are tried; the conditions do not.
#[test]
fn equal_and_dependent_rows_in_other_units_leave_the_answer_as_it_is() {
    let mut draws = Draws::new(18);
    for case in 0..1000 {
        let (n, m) = (1 + draws.below(6), 1 + draws.below(9));
        let mut dense = random(&mut draws, n, m);
        make_dependent(&mut draws, &mut dense);
        let outcome = run(&dense.problem().unwrap(), true).unwrap();
        let found = conditions(&dense, &outcome);
        assert!(outcome.settled && found.iter().all(|&value| value <= ROUNDED), "case {case}: {found:?}");
    }
}

/// Springs of 1e-2 to 1e2 between `n` dofs and to the ground, rows `u_i+1 - u_i <= g`, and one dof that nothing but 1e-6
/// and its rows hold: nearly all that a row moves is that dof, so that its two rows are nearly parallel in energy.
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
    let mut draws = Draws::new(3);
    for case in 0..1000 {
        let n = 6 + draws.below(55);
        let dense = network(&mut draws, n);
        let outcome = run(&dense.problem().unwrap(), true).unwrap();
        let found = conditions(&dense, &outcome);
        assert!(outcome.settled && found.iter().all(|&value| value <= ROUNDED), "case {case}: {found:?}");
    }
}

/// Several hundred closed rows: the basis is updated, not made again for each.
#[test]
fn a_network_of_600_dofs_is_solved_to_rounding() {
    let mut draws = Draws::new(4);
    let dense = network(&mut draws, 600);
    let outcome = run(&dense.problem().unwrap(), true).unwrap();
    let found = conditions(&dense, &outcome);
    assert!(outcome.settled && found.iter().all(|&value| value <= ROUNDED), "{found:?}");
    assert!(outcome.contact_set.count() > 200, "{}", outcome.contact_set.count());
}

/// A free chain, cut in places, under a load that only its rows balance.
#[test]
fn bodies_that_only_their_rows_hold_are_solved_to_rounding() {
    let mut draws = Draws::new(6);
    let mut settled = 0;
    for case in 0..1000 {
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
        let outcome = run(&dense.problem().unwrap(), false).unwrap();
        let found = conditions(&dense, &outcome);
        settled += usize::from(outcome.settled);
        assert!(!outcome.settled || found.iter().all(|&value| value <= ROUNDED), "case {case}: {found:?}");
    }
    assert!(settled >= 990, "{settled} of 1000");
}

/// A last row that contradicts a sum of others by `overlap`, all of them in other units. All numbers have few digits, so that
/// the rows depend on each other exactly.
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
    let mut draws = Draws::new(5);
    for case in 0..1000 {
        let overlap = 2.0_f64.powi(-(draws.below(20) as i32));
        let dense = contradicting(&mut draws, overlap);
        let problem = dense.problem().unwrap();
        let Err(Error::Infeasible { rows, weights, .. }) = run(&problem, true) else {
            panic!("case {case}: an overlap of {overlap:e} is not found");
        };
        assert!(problem.overlap(&rows, &weights).is_some(), "case {case}: {rows:?} {weights:?}");
    }
}

/// The same rows with one entry changed in its last place: some displacement, however large, meets them.
#[test]
fn rows_that_contradict_each_other_but_for_rounding_are_not_called_infeasible() {
    let mut draws = Draws::new(7);
    for case in 0..1000 {
        let mut dense = contradicting(&mut draws, 0.125);
        let last = dense.gap.len() - 1;
        // Beyond rows of full rank nothing can be met: the last row gets a dof of its own.
        let n = dense.load.len();
        dense.stiffness = dense.stiffness.insert_row(n, 0.0).insert_column(n, 0.0);
        dense.stiffness[(n, n)] = 1.0;
        dense.contact = dense.contact.insert_column(n, 0.0);
        dense.contact[(last, n)] = dense.contact.row(last).amax() * f64::EPSILON;
        dense.load = dense.load.insert_row(n, 0.0);
        let found = run(&dense.problem().unwrap(), true);
        assert!(!matches!(found, Err(Error::Infeasible { .. })), "case {case}: {found:?}");
    }
}
