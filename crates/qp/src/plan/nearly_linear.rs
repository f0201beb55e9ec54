//! Programs that are nearly linear: a stiffness of low rank, and an answer in a corner of its rows.

use super::layout::is_crowded;
use crate::error::Error;
use crate::problem::ContactProblem;

/// Fewer motions without energy than this are found one by one, and cost little.
const FEW_MOTIONS: usize = 256;

/// A program is nearly linear if the stiffness holds less than one of this many directions.
const ONE_OF: usize = 4;

/// Most unknowns of a program that is looked at: its factor of low rank is dense.
const MOST_UNKNOWNS: usize = 20_000;

/// A pivot below this share of its diagonal entry is rounding.
const NO_PIVOT: f64 = 1e-10;

/// Refuses a nearly linear program: each of its motions without energy would have to be stopped by a row of its own.
pub(super) fn check(problem: &ContactProblem) -> Result<(), Error> {
    // An equality takes a direction away.
    let unknowns = problem.dofs().saturating_sub(problem.equalities().len());
    let most = unknowns.saturating_sub(FEW_MOTIONS).min(unknowns / ONE_OF);
    if most == 0 || unknowns <= FEW_MOTIONS || unknowns > MOST_UNKNOWNS || !is_crowded(problem) {
        return Ok(());
    }
    match rank_within(problem, most) {
        None => Ok(()),
        Some(rank) => Err(Error::NearlyLinear { rank, unknowns }),
    }
}

/// The rank of the stiffness, by a Cholesky factor with the largest pivots; `None` if it is above `most`.
///
/// # Source
/// N. J. Higham, *Analysis of the Cholesky decomposition of a semi-definite matrix*, in *Reliable Numerical
/// Computation*, Oxford University Press (1990) 161-185.
fn rank_within(problem: &ContactProblem, most: usize) -> Option<usize> {
    let (lower, diagonal) = (problem.stiffness().lower(), &problem.diagonal().values);
    let upper = lower.transposed();
    let mut left = diagonal.clone();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    loop {
        let is_pivot = |dof: &usize| left[*dof] > NO_PIVOT * diagonal[*dof];
        let share = |dof: usize| left[dof] / diagonal[dof];
        let Some(pivot) = (0..left.len()).filter(is_pivot).max_by(|&a, &b| share(a).total_cmp(&share(b))) else {
            return Some(columns.len());
        };
        if columns.len() == most {
            return None;
        }
        let mut column = vec![0.0; left.len()];
        lower.column(pivot).chain(upper.column(pivot)).for_each(|(dof, value)| column[dof] = value);
        for earlier in &columns {
            let share = earlier[pivot];
            column.iter_mut().zip(earlier).for_each(|(value, of_earlier)| *value -= share * of_earlier);
        }
        let root = left[pivot].sqrt();
        column.iter_mut().for_each(|value| *value /= root);
        left.iter_mut().zip(&column).for_each(|(left, value)| *left -= value * value);
        left[pivot] = 0.0;
        columns.push(column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `K = F'F` with F of `rank` rows, and twice as many rows as unknowns, of ten entries each.
    fn program(unknowns: usize, rank: usize) -> ContactProblem {
        let entry = |row: usize, dof: usize| (((row + 1) * (dof + 3) * 7919) % 1009) as f64 / 504.0 - 1.0;
        let of = |i: usize, j: usize| (0..rank).map(|row| entry(row, i) * entry(row, j)).sum::<f64>();
        let stiffness: Vec<_> =
            (0..unknowns).flat_map(|j| (j..unknowns).map(move |i| (i, j))).map(|(i, j)| (i, j, of(i, j))).collect();
        let rows: Vec<_> = (0..2 * unknowns)
            .flat_map(|row| (0..10).map(move |at| (row, (row + 37 * at) % unknowns, 1.0 + at as f64)))
            .collect();
        ContactProblem::of_entries(&stiffness, &vec![1.0; unknowns], &rows, &vec![1.0; 2 * unknowns])
    }

    #[test]
    fn the_rank_of_a_stiffness_is_counted_up_to_a_limit() {
        assert_eq!(rank_within(&program(40, 5), 10), Some(5));
        assert_eq!(rank_within(&program(40, 10), 10), Some(10));
        assert_eq!(rank_within(&program(40, 11), 10), None);
        assert_eq!(rank_within(&ContactProblem::of_entries(&[], &[0.0; 4], &[], &[]), 10), Some(0));
    }

    #[test]
    fn a_large_program_of_low_rank_is_refused_and_a_small_one_and_a_stiff_one_are_not() {
        assert!(check(&program(FEW_MOTIONS, 3)).is_ok());
        assert!(check(&program(400, 3)).unwrap_err().to_string().contains("holds 3 of 400 directions"));
        assert!(check(&program(400, 101)).is_ok());
        // A body of any size with one row for each node.
        let rows: Vec<_> = (0..400).map(|row| (row, row, 1.0)).collect();
        let chain: Vec<_> = (0..400).map(|dof| (dof, dof, 2.0)).collect();
        assert!(check(&ContactProblem::of_entries(&chain, &[0.0; 400], &rows, &[1.0; 400])).is_ok());
    }
}
