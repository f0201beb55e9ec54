//! The bound on the energy norm of an answer's error if K has a hierarchy and no factor.
//!
//! As in the bound with a factor, for a feasible v and multipliers mu <= 0 that push only where v touches,
//!
//! ```text
//! |u - u*|_K <= |u - v|_K + |f + B' mu - K v|_{K^-1}
//! ```
//!
//! v is the answer with the rows that press or penetrate moved to their gaps together. For an answer of MPRGP this move
//! is rounding, because its rows are bounds that it keeps. The dual norm comes from the cycles of the hierarchy.
//!
//! A dof without stiffness, such as the travel of an obstacle, has no energy. K is definite on the others, and the
//! inequality holds for these if the forces on the dof balance: the multipliers of its rows are enlarged by the share
//! that its residual lacks.
//!
//! Parts that no coupling joins are blocks of K, and the inequality holds for each by itself. If a coupling is too weak
//! to join two parts into one, the parts have no bound of their own.

use super::closed_rows::{placed, watched_rows};
use super::{Answer, ErrorBound, Measured, add_sizes, allowed, shift_length};
use crate::certificate::energy_norm::{ROUNDED_BOUND, springs_on};
use crate::certificate::mode::not_convex_along;
use crate::linear::multigrid::Multigrid;
use crate::linear::watch::Watch;
use crate::linear::{Blocks, SparseMatrix, SymmetricMatrix};
use crate::problem::ContactProblem;

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
    let blocks = match are_apart {
        true => Blocks { of_unknown: &parts.of_dof, count: parts.count() },
        false => Blocks::ONE,
    };
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
    let left_on = |row: usize| left[if are_apart { parts.of_row(row) } else { 0 }];
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

/// Returns `true` if conjugate gradients with the cycles meet no direction of negative energy beyond rounding and
/// `watch` is not over before they end.
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

    /// Five points on a square: 4 on the diagonal, -1 to each neighbour, and `more` on the diagonal. The walls are at
    /// one.
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
        // Five points on a square, a wall before each at 1, and the load under which they press there by 1 - 0.1 K 1 or
        // more.
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
        // The exact answer is one everywhere: K 1 is one at each edge, so that the error is 0.1 sqrt(1'K 1), once for
        // the answer and once for its residual.
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
}
