//! Rows that contradict each other: the certificate of an infeasible problem, recomputed from the problem itself.

use super::ContactProblem;
use crate::sparse::largest;

/// Weighted rows cancel when what is left of them is this small beside their entries: the accuracy of the method that
/// found the weights.
const CANCELLED: f64 = 1e-7;

impl ContactProblem {
    /// By how much the contact rows `rows` overlap under the weights y, one for each of them, in length: `-g'y` for the
    /// largest weight 1. `None` where y proves nothing.
    ///
    /// By Farkas' lemma no displacement satisfies `B u <= g` if and only if there are weights `y >= 0` with `B'y = 0` and
    /// `g'y < 0`: the rows, weighted, would ask for `0 <= g'y`.
    pub fn overlap(&self, rows: &[usize], weights: &[f64]) -> Option<f64> {
        let size = largest(weights);
        let known = rows.iter().all(|&row| row < self.rows()) && rows.len() == weights.len();
        if !(known && size > 0.0 && size.is_finite()) || weights.iter().any(|&weight| weight.is_nan() || weight < 0.0) {
            return None;
        }
        let mut y = vec![0.0; self.rows()];
        rows.iter().zip(weights).for_each(|(&row, &weight)| y[row] += weight / size);
        let (left, terms) = (self.contact.mul_transposed(&y), self.contact.abs().mul_transposed(&y));
        let cancels = largest(&left) <= CANCELLED * largest(&terms);
        let products =
            || y.iter().zip(&self.gap).filter(|(weight, _)| **weight > 0.0).map(|(weight, gap)| weight * gap);
        let overlap = -products().sum::<f64>();
        // What the rows leave over may be worth as much as the gaps miss by, where the proof is not exact.
        let doubt = if largest(&left) > 0.0 {
            CANCELLED * products().fold(0.0, |most: f64, term| most.max(term.abs()))
        } else {
            0.0
        };
        (cancels && overlap > doubt).then_some(overlap)
    }
}
