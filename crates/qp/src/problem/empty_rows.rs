//! Rows without entries: their gaps are met or not, whatever moves.

use crate::linear::SparseMatrix;

/// The gap of a row without entries is rounding if it is below this share of the largest.
const OF_LARGEST: f64 = 16.0 * f64::EPSILON;

/// The rows of a matrix without an entry.
pub(super) fn without_entries(contact: &SparseMatrix) -> Vec<usize> {
    let mut has_entry = vec![false; contact.rows()];
    (0..contact.columns()).for_each(|dof| contact.with_rows(dof, &mut has_entry, |has, b| *has |= b != 0.0));
    (0..contact.rows()).filter(|&row| !has_entry[row]).collect()
}

/// Sets the gaps of these rows to zero where they are rounding beside the largest; returns the rows with their former
/// gaps.
pub(super) fn settle(without_entries: &[usize], gap: &mut [f64]) -> Vec<(usize, f64)> {
    let size = OF_LARGEST * largest_finite(gap);
    let is_rounding = |row: &usize| gap[*row] != 0.0 && gap[*row].abs() <= size;
    let rows: Vec<usize> = without_entries.iter().copied().filter(is_rounding).collect();
    rows.into_iter().map(|row| (row, std::mem::take(&mut gap[row]))).collect()
}

/// The largest magnitude of the finite gaps.
pub(super) fn largest_finite(gap: &[f64]) -> f64 {
    gap.iter().filter(|gap| gap.is_finite()).fold(0.0, |most, gap| gap.abs().max(most))
}
