//! Rows that contradict each other: the certificate of an infeasible problem, recomputed from the problem itself.

use crate::error::Error;
use crate::linear::{Accumulator, largest};
use crate::problem::ContactProblem;

/// Rows must overlap by this share of their weighted gaps, beyond the rounding of the gaps themselves.
const OVERLAP: f64 = 4.0 * f64::EPSILON;

/// Weights that do not cancel exactly prove nothing about a displacement that is large enough. A contradiction counts
/// if such a displacement would have to be this many times larger than the gaps.
const FAR: f64 = 1e8;

impl ContactProblem {
    /// The error that no displacement satisfies the contact rows `rows` together, by these weights.
    pub(crate) fn infeasible(&self, rows: &[usize], weights: &[f64]) -> Error {
        let overlap = self.overlap(rows, weights).unwrap_or(0.0);
        let by = if overlap > 0.0 { format!(": they overlap by {overlap:.3e}") } else { String::new() };
        let (rows, weights) = self.weights_of_given(rows, weights);
        let (contact, equalities): (Vec<usize>, Vec<usize>) = rows.iter().partition(|&&row| row < self.inequalities());
        let equalities: Vec<usize> = equalities.into_iter().map(|row| row - self.inequalities()).collect();
        let named = match (contact.is_empty(), equalities.is_empty()) {
            (_, true) => format!("the contact rows {contact:?}"),
            (true, false) => format!("the equality rows {equalities:?}"),
            (false, false) => format!("the contact rows {contact:?} and the equality rows {equalities:?}"),
        };
        let reason = format!("no displacement satisfies {named} together{by} (indices from 0)");
        Error::Infeasible { reason, rows, weights, overlap }
    }

    /// The length by which the contact rows `rows` overlap under the weights y, one for each row: `-g'y` if the largest
    /// weight is one. `None` if y proves nothing.
    ///
    /// By Farkas' lemma no displacement satisfies `B u <= g` if and only if there are weights `y >= 0` with `B'y = 0`
    /// and `g'y < 0`: the rows, weighted, would ask for `0 <= g'y`. Doubles may leave a share s of the terms `|B|'y` of
    /// a dof: then a displacement that meets the rows is at least as large as `-g'y / s`, in the same terms, which must
    /// be 1e8 times `|g|'y`. All sums have twice the working precision, and neither scaled rows nor scaled dofs change
    /// the verdict.
    pub fn overlap(&self, rows: &[usize], weights: &[f64]) -> Option<f64> {
        let size = largest(weights);
        let known = rows.iter().all(|&row| row < self.rows()) && rows.len() == weights.len();
        if !(known && size > 0.0 && size.is_finite()) || weights.iter().any(|&weight| weight.is_nan() || weight < 0.0) {
            return None;
        }
        let mut y = vec![0.0; self.rows()];
        rows.iter().zip(weights).for_each(|(&row, &weight)| y[row] += weight / size);
        let mut left = Accumulator::new(&vec![0.0; self.dofs()]);
        self.contact.triplets().for_each(|(row, dof, b)| left.add_product(dof, b, y[row]));
        let terms = self.contact.mul_abs_transposed(&y);
        let left_over = left.into_sums().into_iter().zip(&terms).filter(|entry| *entry.1 > 0.0);
        let share = left_over.fold(0.0, |most: f64, (left, terms)| most.max(left.abs() / terms));
        let mut sum = Accumulator::new(&[0.0]);
        let weighted = || y.iter().zip(&self.gap).filter(|(weight, _)| **weight > 0.0);
        weighted().for_each(|(&weight, &gap)| sum.add_product(0, -weight, gap));
        let overlap = sum.into_sums()[0];
        let doubt = OVERLAP.max(FAR * share) * weighted().map(|(weight, gap)| weight * gap.abs()).sum::<f64>();
        (overlap > doubt).then_some(overlap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dof between two rows: `u <= g_0` and `-b u <= g_1`.
    fn between(b: f64, gap: [f64; 2]) -> ContactProblem {
        ContactProblem::of_entries(&[(0, 0, 1.0)], &[0.0], &[(0, 0, 1.0), (1, 0, -b)], &gap)
    }

    #[test]
    fn two_walls_overlap_by_the_length_that_is_missing_between_them() {
        // u <= -1 and u >= -1/2.
        let problem = between(1.0, [-1.0, 0.5]);
        for weights in [[1.0, 1.0], [3.0, 3.0]] {
            assert_eq!(problem.overlap(&[0, 1], &weights), Some(0.5));
            assert_eq!(problem.overlap(&[1, 0], &weights), Some(0.5));
        }
        // Half the weights on the same row twice.
        assert_eq!(problem.overlap(&[0, 1, 1], &[1.0, 0.5, 0.5]), Some(0.5));
        assert_eq!(between(1.0, [1.0, -0.5]).overlap(&[0, 1], &[1.0, 1.0]), None);
    }

    #[test]
    fn weights_that_do_not_cancel_or_are_none_prove_nothing() {
        let problem = between(1.0, [-1.0, 0.5]);
        for weights in [[1.0, 0.5], [1.0, -1.0], [0.0, 0.0], [f64::NAN, 1.0], [f64::INFINITY, f64::INFINITY]] {
            assert_eq!(problem.overlap(&[0, 1], &weights), None, "{weights:?}");
        }
        assert_eq!(problem.overlap(&[0, 2], &[1.0, 1.0]), None);
        assert_eq!(problem.overlap(&[0], &[1.0, 1.0]), None);
    }

    #[test]
    fn rows_must_overlap_by_more_than_rounding_of_their_gaps() {
        // The gaps are 1 and the doubles next below -1; four units in the last place of both together are 8.
        for (units, proven) in [(7.0, false), (9.0, true)] {
            let gap = -1.0 - units * f64::EPSILON;
            assert_eq!(between(1.0, [1.0, gap]).overlap(&[0, 1], &[1.0, 1.0]).is_some(), proven, "{units}");
        }
    }

    #[test]
    fn rows_that_cancel_to_a_billionth_contradict_each_other_unless_a_far_displacement_meets_both() {
        // 1 - b of the terms 1 + b are left, a share of 5e-10. A displacement 1e8 times the gaps would need 5 % of the
        // terms.
        for (gap, proven) in [([-1.0, 0.92], false), ([-1.0, 0.89], true)] {
            let found = between(1.0 - 1e-9, gap).overlap(&[0, 1], &[1.0, 1.0]);
            assert_eq!(found.is_some(), proven, "{gap:?}: {found:?}");
        }
    }
}
