//! The bounds without a contact boundary: rows are repaired by their own dofs, with a factor or with a hierarchy.
//!
//! For a feasible v and multipliers mu <= 0 that push only where v touches,
//!
//! ```text
//! |u - u*|_K <= |u - v|_K + |f + B' mu - K v|_{K^-1}
//! ```
//!
//! v is the answer with the rows that press or penetrate moved to their gaps together. For an answer of MPRGP this move
//! is rounding, because its rows are bounds that it keeps. The dual norm comes from the cycles of the hierarchy.
//!
//! A dof without stiffness, such as the travel of an obstacle, has no energy. On the others the inequality holds if the
//! forces on the dof balance: those of its rows are enlarged by the share that its residual lacks.
//!
//! Parts that no coupling joins are blocks of K, and the inequality holds for each by itself. If a coupling is too weak
//! to join two parts into one, the parts have no bound of their own.

use super::closed_rows::{Placed, balancing, placed, watched_rows};
use super::{Answer, EnergyNorm, ErrorBound, Measured, add_sizes, allowed, shift_length, squares};
use crate::certificate::energy_norm::{ROUNDED_BOUND, springs_on};
use crate::certificate::mode::not_convex_along;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::linear::{Blocks, Iterate, SparseMatrix, SymmetricMatrix};
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

/// The bound from `closed` rows moved to their gaps, and others out of obstacles. All keep forces if none are named.
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
    let mut residual = answer.problem.accurate_balance(answer.displacement, multipliers).residual;
    residual.iter_mut().zip(answer.problem.accurate_forces(repair).sums()).for_each(|(entry, force)| *entry -= force);
    residual
}

/// The square of a force in the energy norm of dofs that stand alone.
fn size_alone(problem: &ContactProblem, force: &[f64]) -> f64 {
    let squares = force.iter().zip(&problem.diagonal().values).filter(|entry| *entry.1 > 0.0);
    squares.map(|(force, stiffness)| force * force / stiffness).sum()
}

fn with_slack(norm: &EnergyNorm, answer: &Answer, at: &Placed, [residual, multiplier]: [&[f64]; 2]) -> ErrorBound {
    let problem = answer.problem;
    let Placed { shift: repair, rest, closed } = at;
    let parts = problem.parts();
    let moved_by = problem.contact.mul(repair);
    let mut slack_work = vec![0.0; parts.count()];
    for row in 0..problem.rows() {
        if multiplier[row] != 0.0 && !closed[row] {
            slack_work[parts.of_row[row]] += (answer.violation[row] + moved_by[row]).min(0.0) * multiplier[row];
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
        let each = sizes.iter_mut().zip(squares.zip(&slack_work));
        each.for_each(|(size, (square, &slack))| *size += length(square, slack));
        sizes
    });
    ErrorBound { whole, of_parts }
}

/// A displacement that follows the force `residual` on all dofs that are not `held`, by a few conjugate gradients.
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

/// An upper bound on `|u - u*|_K`, as far as the cycles find the least eigenvalues; `None` if they find none, or if
/// `watch` is over before that. A stiffness that the hierarchy has found singular gets springs on the rows that
/// press, but only if no direction of negative energy is found, because springs would hide it.
pub fn energy_error_bound_by(
    multigrid: &Multigrid,
    answer: &Answer,
    watch: &Watch,
) -> Option<(ErrorBound, Option<Measured>)> {
    let problem = answer.problem;
    let touches = |row: usize| answer.multiplier[row] < 0.0 || answer.violation[row] > 0.0 || problem.is_two_sided(row);
    let at_gap = (0..problem.rows()).map(touches).collect();
    let watched = watched_rows(problem, watch);
    let placed = placed(&watched, answer.displacement, at_gap)?;
    // Neither a force that pulls nor one on an open row is a multiplier.
    let keeps = |row: usize| if placed.closed[row] { allowed(problem, row, answer.multiplier[row]) } else { 0.0 };
    let kept: Vec<f64> = (0..problem.rows()).map(keeps).collect();
    let is_dropped = kept.iter().zip(answer.multiplier).any(|(kept, given)| kept != given);
    let mut residual = match is_dropped {
        true => problem.accurate_residual(answer.displacement, &kept),
        false => answer.residual.clone(),
    };
    if !balance_travels(problem, &watched.by_row, &kept, &mut residual) {
        return None;
    }
    let parts = problem.parts();
    let are_apart = parts.count() == 1 || parts.are_apart(&problem.stiffness);
    let blocks = if are_apart { Blocks { of_unknown: &parts.of_dof, count: parts.count() } } else { Blocks::ONE };
    let dual = |held: &SymmetricMatrix| {
        multigrid.preconditioning(held).dual_norms(&residual, blocks.of_unknown, blocks.count, watch)
    };
    let springs = multigrid.is_shifted().then(|| springs_on(problem, answer.displacement, answer.multiplier));
    let left = match &springs {
        None => dual(&problem.stiffness),
        Some(_) if !is_semidefinite_by(problem, multigrid, watch) => None,
        Some(springs) => {
            springs.added_to(&problem.stiffness, &problem.contact).ok().flatten().and_then(|held| dual(&held))
        }
    }?;
    let ritz = left.iter().fold(f64::INFINITY, |least, dual| dual.ritz.min(least));
    let left: Vec<f64> = left.iter().map(|dual| ROUNDED_BOUND * dual.most).collect();
    let left_on = |row: usize| left[if are_apart { parts.of_row[row] } else { 0 }];
    if springs.is_some_and(|springs| !springs.hold(&placed.closed, |row| -kept[row], left_on)) {
        return None;
    }
    let of_residual = left.iter().map(|left| left * left).sum::<f64>().sqrt();
    let measured = (!is_dropped && !multigrid.is_shifted()).then_some(Measured { of_residual, ritz });
    let mut moved = placed.rest;
    match are_apart {
        true => add_sizes(problem, &placed.shift, &mut moved),
        false => moved = vec![moved.iter().sum::<f64>() + shift_length(problem, &placed.shift)],
    }
    // A shift of the answer changes its residual too, by K times the shift.
    let bounds: Vec<f64> = moved.iter().zip(&left).map(|(moved, left)| 2.0 * ROUNDED_BOUND * moved + left).collect();
    let whole = bounds.iter().map(|bound| bound * bound).sum::<f64>().sqrt();
    let of_parts = match (parts.count(), are_apart) {
        (1, _) => None,
        (_, true) => Some(bounds),
        (count, false) => Some(vec![f64::INFINITY; count]),
    };
    Some((ErrorBound { whole, of_parts }, measured))
}

/// Turns the `residual` of multipliers into that of others which balance every dof without stiffness: those of its
/// rows times one factor. Returns `false` if there is no factor that keeps their signs.
fn balance_travels(problem: &ContactProblem, by_row: &SparseMatrix, multiplier: &[f64], residual: &mut [f64]) -> bool {
    let travels = problem.without_stiffness();
    let mut enlarged = vec![0.0; problem.rows()];
    for &travel in &travels {
        if residual[travel] == 0.0 {
            continue;
        }
        let pushed: f64 = problem.contact.column(travel).map(|(row, c)| c * multiplier[row]).sum();
        let share = -residual[travel] / pushed;
        if !share.is_finite() || share < -1.0 {
            return false;
        }
        for (row, _) in problem.contact.column(travel).filter(|entry| entry.1 != 0.0) {
            // A row of two travels would have two factors.
            if enlarged[row] != 0.0 {
                return false;
            }
            enlarged[row] = share * multiplier[row];
            by_row.column(row).for_each(|(dof, b)| residual[dof] += b * enlarged[row]);
        }
    }
    travels.iter().for_each(|&travel| residual[travel] = 0.0);
    true
}

/// Returns `true` if conjugate gradients with the cycles end in time, and meet no direction of negative energy.
fn is_semidefinite_by(problem: &ContactProblem, multigrid: &Multigrid, watch: &Watch) -> bool {
    match multigrid.preconditioning(&problem.stiffness).negative_direction(watch) {
        Some(direction) => not_convex_along(problem, &direction).is_none(),
        None => !watch.is_over(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::multigrid::NearNullSpace;

    /// Points along a side of the square.
    const SIDE: usize = 48;

    /// Rounding of sums over all points.
    const ROUNDING: f64 = 1e-9;

    /// Five points on a square: 4 and `more` on the diagonal, -1 to each neighbour. The walls are at one.
    fn square(more: f64, walls: &[(usize, usize, f64)]) -> ContactProblem {
        let dofs = SIDE * SIDE;
        let mut entries: Vec<_> = (0..dofs).map(|own| (own, own, 4.0 + more)).collect();
        entries.extend((0..dofs).filter(|own| own % SIDE + 1 < SIDE).map(|own| (own + 1, own, -1.0)));
        entries.extend((0..dofs - SIDE).map(|own| (own + SIDE, own, -1.0)));
        ContactProblem::of_entries(&entries, &vec![0.0; dofs], walls, &vec![1.0; walls.len()])
    }

    fn cycles(problem: &ContactProblem) -> Multigrid {
        let near_null = NearNullSpace::constants(problem.stiffness()).unwrap();
        Multigrid::new(problem.stiffness(), &near_null, 1).unwrap()
    }

    #[test]
    fn a_stiffness_is_semidefinite_unless_a_direction_of_negative_energy_is_met_or_time_is_over() {
        let multigrid = cycles(&square(0.0, &[]));
        // The least eigenvalue is 8 sin^2(pi / 98), less than a hundredth.
        for (more, is_semidefinite) in [(0.0, true), (-0.1, false)] {
            let problem = square(more, &[]);
            assert_eq!(is_semidefinite_by(&problem, &multigrid, &Watch::default()), is_semidefinite, "{more}");
            assert!(!is_semidefinite_by(&problem, &multigrid, &Watch::default().within(0.0)), "{more}");
        }
    }

    #[test]
    fn rows_that_press_over_an_open_gap_are_moved_to_it_at_the_cost_of_their_shifts() {
        // A wall before each point, and the load under which they press there by 1 - 0.1 K 1 or more.
        let dofs = SIDE * SIDE;
        let problem = square(0.0, &(0..dofs).map(|dof| (dof, dof, 1.0)).collect::<Vec<_>>());
        let load = problem.stiffness().mul(&vec![0.9; dofs]).iter().map(|force| force + 1.0).collect();
        let problem = problem.with_load(load).unwrap();
        let multigrid = cycles(&problem);
        assert!(multigrid.unknowns().len() > 1);
        // Forces that balance u = 0.9, which is open by 0.1 everywhere.
        let (u, lambda) = (vec![0.9; dofs], vec![-1.0; dofs]);
        let bound_of = |multiplier: &[f64]| {
            let answer = Answer::of(&problem, &u, multiplier);
            energy_error_bound_by(&multigrid, &answer, &Watch::default()).unwrap()
        };
        let (bound, measured) = bound_of(&lambda);
        // The exact answer is one everywhere, and K 1 is one at each edge: the error is 0.1 sqrt(1'K 1), twice.
        let of_shift = 0.1 * (4.0 * SIDE as f64).sqrt();
        assert!((bound.whole / (2.0 * of_shift) - 1.0).abs() < 1e-5, "{bound:?}");
        assert!(measured.unwrap().of_residual < 1e-10);
        // A force that pulls does not count, and is left as a residual.
        let pulls = vec![1.0; dofs];
        let (bound, measured) = bound_of(&pulls);
        assert!(measured.is_none() && bound.whole > 0.1 * (4.0 * SIDE as f64).sqrt(), "{bound:?}");
        // The bound is that of the same displacements without forces.
        let (without, _) = bound_of(&vec![0.0; dofs]);
        assert!((bound.whole / without.whole - 1.0).abs() < ROUNDING, "{bound:?} {without:?}");
    }

    #[test]
    fn the_forces_of_a_travel_are_enlarged_until_they_balance_it() {
        // Rows 1 and 2 press with 3 and 1 against a travel with the load 5: each lacks a quarter of its force.
        let entries = [(0, 0, 1.0), (0, 2, 1.0), (1, 1, 2.0), (1, 2, 1.0)];
        let stiffness = [(0, 0, 1.0), (1, 1, 1.0)];
        let problem = ContactProblem::of_entries(&stiffness, &[0.0, 0.0, 5.0], &entries, &[0.0; 2]);
        let by_row = problem.contact.transposed();
        let mut residual = vec![0.1, 0.2, 1.0];
        assert!(balance_travels(&problem, &by_row, &[-3.0, -1.0], &mut residual));
        for (found, exact) in residual.iter().zip([0.1 - 0.75, 0.2 - 0.5, 0.0]) {
            assert!((found - exact).abs() < ROUNDING, "{residual:?}");
        }
        // Without a force no factor helps; against pulls, it would have to turn them.
        assert!(!balance_travels(&problem, &by_row, &[0.0, 0.0], &mut [0.0, 0.0, 5.0]));
        assert!(!balance_travels(&problem, &by_row, &[1.0, 1.0], &mut [0.0, 0.0, 7.0]));
    }

    #[test]
    fn the_rest_of_the_body_follows_a_force_to_its_equilibrium() {
        // A chain of springs, K = tridiag(-1, 2, -1), has (n - i) / n of a force on the first dof at dof i.
        let entries: Vec<_> = (0..4).map(|i| (i, i, 2.0)).chain((1..4).map(|i| (i, i - 1, -1.0))).collect();
        let problem = ContactProblem::of_entries(&entries, &[0.0; 4], &[], &[]);
        for (last_is_held, exact) in [(false, [0.8, 0.6, 0.4, 0.2]), (true, [0.75, 0.5, 0.25, 0.0])] {
            let found = relaxed(&problem, &[1.0, 0.0, 0.0, 0.0], &[false, false, false, last_is_held]);
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < SUM_ROUNDING;
            assert!(found.iter().zip(&exact).all(is_near), "{found:?}");
        }
    }
}
