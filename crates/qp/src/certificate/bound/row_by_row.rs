//! The bound if the contact boundary is not known: the rows are repaired by their own dofs, and the body follows.

use super::closed_rows::{Placed, balancing, placed, watched_rows};
use super::{Answer, EnergyNorm, ErrorBound, add_sizes, allowed, shift_length, squares};
use crate::linear::{Blocks, Iterate};
use crate::problem::ContactProblem;

/// Rounding of a sum, relative to the sum of its terms.
const SUM_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Steps in which the rest of the body adapts to the rows that were put at their gaps; each costs a product with K.
const RELAXATIONS: usize = 20;

/// Possible rounding error of B u - g from rounding of u, row by row.
pub fn negligible(problem: &ContactProblem, displacement: &[f64]) -> Vec<f64> {
    let magnitude: Vec<f64> = displacement.iter().map(|value| SUM_ROUNDING * value).collect();
    problem.contact.mul_abs(&magnitude)
}

/// The bound from a displacement with the `closed` rows moved to their gaps, and all others out of their obstacles.
/// Only the closed rows keep their forces, or all if none are named.
pub fn bound_row_by_row(norm: &EnergyNorm, answer: &Answer, closed: Option<Vec<bool>>) -> ErrorBound {
    let problem = answer.problem;
    let watched = watched_rows(problem, &norm.watch);
    let negligible = negligible(problem, answer.displacement);
    let touches = |row: usize| {
        let violation = answer.violation[row];
        let is_pressed = answer.multiplier[row] < 0.0 && violation >= -negligible[row];
        violation > 0.0 || is_pressed || problem.is_two_sided(row)
    };
    let keeps_all = closed.is_none();
    let at_gap = closed.unwrap_or_else(|| (0..problem.rows()).map(touches).collect());
    let Some(Placed { shift: mut repair, rest, closed }) = placed(&watched, answer.displacement, at_gap) else {
        return ErrorBound::none();
    };
    let is_moved = repair.iter().any(|&change| change != 0.0);
    let keeps = |row: usize| problem.gap[row].is_finite() && (keeps_all || closed[row]);
    let kept: Vec<f64> = (0..problem.rows())
        .map(|row| if keeps(row) { allowed(problem, row, answer.multiplier[row]) } else { 0.0 })
        .collect();
    let mut residual = residual_at(answer, &[&kept], &repair);
    if !keeps_all && is_moved {
        let mut held = vec![false; problem.dofs()];
        for row in (0..problem.rows()).filter(|&row| closed[row]) {
            watched.by_row.column(row).filter(|entry| entry.1 != 0.0).for_each(|(dof, _)| held[dof] = true);
        }
        let follow = relaxed(problem, &residual, &held);
        let both: Vec<f64> = repair.iter().zip(&follow).map(|(a, b)| a + b).collect();
        let (moved_by, terms, moves) =
            (problem.contact.mul(&both), problem.contact.mul_abs(&both), problem.contact.mul_abs(&follow));
        let is_feasible = |row: usize| {
            let (violation, moved) = (answer.violation[row], moved_by[row]);
            moves[row] == 0.0 || violation + moved <= -SUM_ROUNDING * (violation.abs() + terms[row])
        };
        if (0..problem.rows()).all(is_feasible) {
            repair = both;
            residual = residual_at(answer, &[&kept], &repair);
        }
    }
    let mut multiplier = kept.clone();
    if !keeps_all && let Some(forces) = balancing(&watched, &closed, &residual) {
        let change = |row: usize| allowed(problem, row, kept[row] + forces[row]) != 0.0;
        let change: Vec<f64> =
            (0..problem.rows()).map(|row| if change(row) { forces[row] } else { -kept[row] }).collect();
        // Not rounded: a sum of two multipliers may leave more than all other forces on a dof.
        let left = residual_at(answer, &[&kept, &change], &repair);
        if size_alone(problem, &left) < size_alone(problem, &residual) {
            multiplier.iter_mut().zip(&change).for_each(|(mu, change)| *mu += change);
            residual = left;
        }
    }
    with_slack(norm, answer, &Placed { shift: repair, rest, closed }, [&residual, &multiplier])
}

/// The forces that are out of balance at an answer moved by `repair`, with multipliers that are sums.
fn residual_at(answer: &Answer, multipliers: &[&[f64]], repair: &[f64]) -> Vec<f64> {
    let mut residual = answer.problem.accurate_residual_of(answer.displacement, multipliers);
    residual.iter_mut().zip(answer.problem.accurate_forces(repair).sums()).for_each(|(entry, force)| *entry -= force);
    residual
}

/// The square of a force in the energy norm of dofs that stand alone.
fn size_alone(problem: &ContactProblem, force: &[f64]) -> f64 {
    let squares = force.iter().zip(&problem.diagonal().values).filter(|entry| *entry.1 > 0.0);
    squares.map(|(force, stiffness)| force * force / stiffness).sum()
}

/// The bound of an answer moved to this place, with this residual there and these multipliers.
fn with_slack(norm: &EnergyNorm, answer: &Answer, at: &Placed, [residual, multiplier]: [&[f64]; 2]) -> ErrorBound {
    let problem = answer.problem;
    let Placed { shift: repair, rest, closed } = at;
    let parts = problem.parts();
    let moved_by = problem.contact.mul(repair);
    let mut slack_work = vec![0.0; parts.count()];
    for row in 0..problem.rows() {
        if multiplier[row] != 0.0 && !closed[row] {
            slack_work[parts.of_row(row)] += (answer.violation[row] + moved_by[row]).min(0.0) * multiplier[row];
        }
    }
    let length = |square: f64, slack: f64| (square + 2.0 * slack).max(0.0).sqrt();
    let total = |values: &[f64]| values.iter().sum::<f64>();
    // A shift of the answer changes its residual too, by K times the shift.
    let left = length(norm.of_force(residual).powi(2), total(&slack_work));
    let rounding = |row: usize| f64::EPSILON * answer.multiplier[row].abs();
    let force = |row: usize| if closed[row] { -multiplier[row] - rounding(row) } else { 0.0 };
    if norm.springs.as_ref().is_some_and(|springs| !springs.hold(closed, force, |_| left)) {
        return ErrorBound::none();
    }
    let whole = left + shift_length(problem, repair) + 2.0 * total(rest);
    let of_parts = (parts.count() > 1).then(|| {
        let mut sizes = rest.iter().map(|cost| 2.0 * cost).collect::<Vec<f64>>();
        add_sizes(problem, repair, &mut sizes);
        let squares = squares(problem, true, &norm.displacement(residual));
        sizes
            .iter_mut()
            .zip(squares.zip(&slack_work))
            .for_each(|(size, (square, &slack))| *size += length(square, slack));
        sizes
    });
    ErrorBound { whole, of_parts }
}

/// A displacement d that follows the force `residual` on all dofs that are not `held`, by a few steps of conjugate
/// gradients.
fn relaxed(problem: &ContactProblem, residual: &[f64], held: &[bool]) -> Vec<f64> {
    let diagonal = &problem.diagonal().values;
    let free = |mut values: Vec<f64>| {
        values.iter_mut().zip(held).filter(|entry| *entry.1).for_each(|(value, _)| *value = 0.0);
        values
    };
    let mut iterate = Iterate::new(vec![0.0; problem.dofs()], free(residual.to_vec()), Blocks::ONE);
    for _ in 0..RELAXATIONS {
        let scaled = iterate.rest.iter().zip(diagonal).map(|(rest, diagonal)| rest / diagonal).collect();
        if !iterate.step(scaled, |p| free(problem.stiffness.mul(p))) {
            break;
        }
    }
    iterate.solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_the_body_follows_a_force_to_its_equilibrium() {
        // A chain of four springs between two walls: K = tridiag(-1, 2, -1) has (n - i) / n of a force on the first dof
        // at dof i.
        let entries: Vec<_> = (0..4).map(|i| (i, i, 2.0)).chain((1..4).map(|i| (i, i - 1, -1.0))).collect();
        let problem = ContactProblem::of_entries(&entries, &[0.0; 4], &[], &[]);
        for (last_is_held, exact) in [(false, [0.8, 0.6, 0.4, 0.2]), (true, [0.75, 0.5, 0.25, 0.0])] {
            let found = relaxed(&problem, &[1.0, 0.0, 0.0, 0.0], &[false, false, false, last_is_held]);
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < SUM_ROUNDING;
            assert!(found.iter().zip(&exact).all(is_near), "{found:?}");
        }
    }
}
