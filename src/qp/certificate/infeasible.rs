//! Rows that contradict each other: the certificate of an infeasible problem, recomputed from the problem itself.

use crate::qp::linear::{Accumulator, largest};
use crate::qp::problem::ContactProblem;

/// Rows must overlap by this share of their weighted gaps, beyond the rounding of the gaps themselves.
const OVERLAP: f64 = 4.0 * f64::EPSILON;

/// Weights that do not cancel exactly prove nothing about a displacement that is large enough. A contradiction counts
/// where such a displacement would have to be this many times larger than the gaps.
const FAR: f64 = 1e8;

impl ContactProblem {
    /// By how much the contact rows `rows` overlap under the weights y, one for each of them, in length: `-g'y` for the
    /// largest weight 1. `None` where y proves nothing.
    ///
    /// By Farkas' lemma no displacement satisfies `B u <= g` if and only if there are weights `y >= 0` with `B'y = 0` and
    /// `g'y < 0`: the rows, weighted, would ask for `0 <= g'y`. Doubles may leave a share s of the terms `|B|'y` of a dof:
    /// then a displacement that meets the rows is at least as large as `-g'y / s`, in the same terms, which must be 1e8
    /// times `|g|'y`. All sums have twice the working precision, and neither scaled rows nor scaled dofs change the verdict.
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
