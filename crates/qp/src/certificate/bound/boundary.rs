//! The bound if the energy norm knows the contact boundary: the answer is repaired in energy, all rows together.
//!
//! The sweep of a force `alpha r + B' x` through the factor differs from that of `alpha r` on the boundary only; r is
//! swept once. With Z = L_tt^-1 B_t' multipliers eta move the rows by c Z'Z eta. Two repairs are tried:
//!
//! * v is the equilibrium of the rows that look closed. If all these rows push, v is the exact answer, and the bound is
//!   the error itself;
//! * the rows that look closed are put at their gaps by the smallest shift, and keep the forces of the answer.

use super::general::bound_row_by_row;
use super::repair::{Repair, Witness};
use super::{Answer, EnergyNorm, ErrorBound, rounding_of_residual, rows_that_look_closed, underflow};
use crate::problem::ContactProblem;

/// Repairs that start from the witness of the previous one.
const MOST_NEAR: usize = 4;

/// If the way to the witness makes up this share of a bound, the bound cannot become much better.
const FAR: f64 = 0.5;

/// Another repair is worth its time if the last one brought the bound below this share of the previous one.
const GAINS: f64 = 0.1;

/// Rounding of forces that cancel each other does no harm below this share of the bound.
const SMALL: f64 = 1e-3;

/// With springs, a factor that loses more than this is too inaccurate for the energy of a shift.
const LOST_WITH_SPRINGS: f64 = 1e4;

pub fn energy_error_bound(norm: &EnergyNorm, answer: &Answer) -> ErrorBound {
    let closed = rows_that_look_closed(answer);
    // A bound that was cut short is not used.
    let is_whole = |bound: &ErrorBound| bound.whole.is_finite() || !norm.is_over();
    let bound = bound_on_boundary(norm, answer, &closed)
        .filter(is_whole)
        .unwrap_or_else(|| bound_row_by_row(norm, answer, Some(closed)).smaller(bound_row_by_row(norm, answer, None)));
    let (underflow, rounding) = (underflow(answer), rounding_of_residual(answer));
    let with_lost = |bound: f64, rounding: f64| norm.rounding() * bound + underflow + norm.loss() * rounding;
    let of_part = |(bound, rounding): (f64, &f64)| with_lost(bound, *rounding);
    ErrorBound {
        whole: with_lost(bound.whole, rounding.iter().sum()),
        of_parts: bound.of_parts.map(|parts| parts.into_iter().zip(&rounding).map(of_part).collect()),
    }
}

/// The bound from the repair on the boundary; `None` without one, or if the rows that look closed cannot be met.
pub fn bound_on_boundary(norm: &EnergyNorm, answer: &Answer, closed: &[bool]) -> Option<ErrorBound> {
    let own = beside_springs(norm, answer);
    let (repair, witness, bound, is_sharp) = first_repair(norm, &own, closed)?;
    if is_sharp { Some(bound) } else { repeated(&repair, witness, answer).0 }
}

/// The answer moved to the witness of its own bound, in doubles; `None` if there is none.
pub fn repaired(problem: &ContactProblem, norm: &EnergyNorm, u: &[f64], lambda: &[f64]) -> Option<Moved> {
    let answer = Answer::of(problem, u, lambda);
    let own = beside_springs(norm, &answer);
    let (repair, witness, _, is_sharp) = first_repair(norm, &own, &rows_that_look_closed(&answer))?;
    Some(if is_sharp { repair.answer(&witness) } else { repeated(&repair, witness, &answer).1 })
}

/// The answer with the forces of the springs of the norm in its residual.
fn beside_springs<'a>(norm: &EnergyNorm, answer: &Answer<'a>) -> Answer<'a> {
    let residual = match &norm.springs {
        Some(springs) => springs.residual(&answer.problem.contact, &answer.residual, &answer.violation),
        None => answer.residual.clone(),
    };
    Answer { residual, violation: answer.violation.clone(), ..*answer }
}

/// Repairs, each from the witness of the last: the best bound, if there is one, with the answer moved to its witness.
///
/// The rounding of a large shift may be a large distance between rows that follow from others, and forces that
/// cancel each other leave what the factor has rounded. A repair from the witness itself has small shifts, forces
/// and changes of force; the distance of the answer from there needs no factor.
fn repeated(repair: &Repair, mut witness: Witness, answer: &Answer) -> (Option<ErrorBound>, Moved) {
    let problem = answer.problem;
    let norm = repair.norm;
    let mut multipliers = vec![answer.multiplier.to_vec()];
    let mut next = (repair.answer(&witness), repair.expanded(&witness.change));
    let mut best: (Option<ErrorBound>, Moved) = (None, next.0.clone());
    for _ in 0..MOST_NEAR {
        let ((moved, multiplier), change) = next;
        // Multipliers stay sums: rounded, they would leave more than all other forces on a dof with little stiffness.
        let rounded = |row: usize| if multiplier[row] != 0.0 && !witness.passes[row] { 1.0 } else { 0.0 };
        multipliers.iter_mut().flat_map(|part| part.iter_mut().enumerate()).for_each(|(row, x)| *x *= rounded(row));
        multipliers.push(change);
        let parts: Vec<&[f64]> = multipliers.iter().map(Vec::as_slice).collect();
        let violation = problem.accurate_violation(&moved);
        let residual = problem.accurate_balance(&moved, &parts).residual;
        let near = Answer { displacement: &moved, multiplier: &multiplier, residual, violation, ..*answer };
        let near = beside_springs(norm, &near);
        let Some(repair) = Repair::new(norm, &near) else { break };
        let Some(settled) = repair.best_witness(&witness.closed) else { break };
        witness = settled;
        let step: Vec<f64> = moved.iter().zip(answer.displacement).map(|(v, u)| v - u).collect();
        let of_near = repair.bound(&witness);
        let size = of_near.size();
        let bound = of_near.farther(problem, &step);
        let size_of_best = best.0.as_ref().map_or(f64::INFINITY, ErrorBound::size);
        let is_last = gains_nothing(size, bound.size(), size_of_best);
        next = (repair.answer(&witness), repair.expanded(&witness.change));
        if best.0.is_none() || bound.size() <= size_of_best {
            best = (Some(bound), next.0.clone());
        }
        if is_last {
            break;
        }
    }
    best
}

type Moved = (Vec<f64>, Vec<f64>);

/// The first repair of an answer, its witness and its bound, and `true` if rounding takes no part in the bound, or the
/// whole bound is what rounding the displacement does. `None` if the boundary is not known, or if the rows that look
/// closed cannot be met together.
fn first_repair<'a>(
    norm: &'a EnergyNorm,
    answer: &'a Answer<'a>,
    closed: &[bool],
) -> Option<(Repair<'a>, Witness, ErrorBound, bool)> {
    let repair = Repair::new(norm, answer)?;
    let witness = repair.best_witness(closed)?;
    let bound = repair.bound(&witness);
    // With springs the shift is large and bends little: a factor that loses digits makes its energy mere rounding.
    let is_precise = norm.springs.is_none() || norm.loss() <= LOST_WITH_SPRINGS;
    let is_exact = !witness.is_rounded && is_precise;
    let is_rounding = answer.problem.parts().count() == 1 && bound.whole <= answer.rounding;
    let is_sharp = is_exact && (is_rounding || repair.vague(&witness) <= SMALL * bound.whole);
    Some((repair, witness, bound, is_sharp))
}

/// Returns `true` if another repair gains nothing. A repair gains the digits that the last one has, unless `rest`, the
/// bound without the way to the witness, is at most half of the `bound`, or little was gained on the `best` before.
fn gains_nothing(rest: f64, bound: f64, best: f64) -> bool {
    rest <= FAR * bound || bound >= GAINS * best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the repaired values of two dofs.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn an_answer_is_repaired_to_the_equilibrium_of_the_rows_that_look_closed() {
        // K = (2, -1; -1, 2) under forces of 3 and 1, a wall before the first dof at 1, and one far from the second. At
        // the wall the second dof is at 1, and a force of 2 is left on the first.
        let (stiffness, walls) = ([(0, 0, 2.0), (1, 0, -1.0), (1, 1, 2.0)], [(0, 0, 1.0), (1, 1, 1.0)]);
        let problem = ContactProblem::of_entries(&stiffness, &[3.0, 1.0], &walls, &[1.0, 9.0]);
        let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        for (u, lambda) in [([1.25, 0.5], [-1.0, 0.0]), ([1.0, 1.0], [-2.0, 0.0]), ([0.75, 2.0], [-5.0, -1e-3])] {
            let (moved, multiplier) = repaired(&problem, &norm, &u, &lambda).unwrap();
            let is_near = |a: &[f64], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDING);
            assert!(is_near(&moved, [1.0, 1.0]), "{u:?}: {moved:?}");
            assert!(is_near(&multiplier, [-2.0, 0.0]), "{u:?}: {multiplier:?}");
        }
    }

    #[test]
    fn forces_that_rows_pass_on_count_once_in_further_repairs() {
        // A spring of stiffness 4 under a force of 8, 1000 behind a wall at 1: a force of 4 is left at the wall. Forces
        // of 2e6 are locked between the wall and another row, or a copy of the wall has them beside a wall that pulls.
        let opposed = ([(0, 0, 1.0), (1, 0, -2.0)], -2.0 * (1.0 - f64::EPSILON), [-4.0 - 2e6, -1e6]);
        let copied = ([(0, 0, 1.0), (1, 0, 2.0)], 2.0, [5.0, -1e6]);
        for (rows, gap, lambda) in [opposed, copied] {
            let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0], &rows, &[1.0, gap]);
            let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
            let (moved, multiplier) = repaired(&problem, &norm, &[1001.0], &lambda).unwrap();
            let force = problem.contact().mul_transposed(&multiplier)[0];
            assert!((moved[0] - 1.0).abs() < ROUNDING && (force + 4.0).abs() < 4.0 * ROUNDING, "{moved:?}, {force}");
            // The way of 1000 against the stiffness is the error.
            let bound = bound_on_boundary(&norm, &Answer::of(&problem, &[1001.0], &lambda), &[true, true]).unwrap();
            assert!((bound.whole - 2000.0).abs() < 1e-6 * 2000.0, "{bound:?}");
        }
    }

    #[test]
    fn repairs_end_when_half_the_bound_is_the_way_or_a_tenth_of_the_last_is_not_reached() {
        // The way takes no part in the bound, and there is no previous bound, or one more than ten times as large.
        assert!(!gains_nothing(1.0, 1.0, f64::INFINITY) && !gains_nothing(2.0, 2.0, 20.5));
        // The way is half of the bound, then a little less.
        assert!(gains_nothing(1.0, 2.0, f64::INFINITY) && !gains_nothing(1.01, 2.0, f64::INFINITY));
        // The previous bound is ten times as large, then less than that.
        assert!(gains_nothing(2.0, 2.0, 20.0) && gains_nothing(2.0, 2.0, 1.0));
        // Without a bound no repair follows.
        assert!(gains_nothing(f64::INFINITY, f64::INFINITY, f64::INFINITY));
    }
}
