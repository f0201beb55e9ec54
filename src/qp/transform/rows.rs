//! Rows that can never close are removed; rows that contradict each other are named.

use std::collections::HashMap;

use crate::error::Error;
use crate::qp::linear::{Accumulator, SparseMatrix, exponent, ldexp};
use crate::solution::ContactSet;

/// Two opposed gaps meet if they overlap by less than this times their size: the rows are an equality.
const MEETING: f64 = 4.0 * f64::EPSILON;

/// A row divided by its first entry: dofs and the bits of their coefficients.
type Direction = Vec<(usize, u64)>;

/// The row with the smallest gap, and that gap, on each of the two sides of a direction.
type Nearest = [Option<(usize, f64)>; 2];

/// The rows that can close: those with an obstacle (finite gap) and with a dof to move.
#[derive(Clone, Debug, PartialEq)]
pub struct RowSelection {
    /// The transposed contact rows: the entries of a row are a column.
    by_row: SparseMatrix,
    kept: Vec<usize>,
}

impl RowSelection {
    /// Selects the rows of `contact` (m x n) that can close under `gap` (m).
    ///
    /// # Errors
    /// [`Error::Infeasible`] for a row without dofs and with a negative gap, and for two opposed rows with overlapping gaps.
    pub fn of(contact: &SparseMatrix, gap: &[f64]) -> Result<Self, Error> {
        Self::of_transposed(contact.transposed(), gap)
    }

    /// The selection from the same rows under another gap.
    ///
    /// # Errors
    /// As [`RowSelection::of`].
    pub fn under(&self, gap: &[f64]) -> Result<Self, Error> {
        Self::of_transposed(self.by_row.clone(), gap)
    }

    fn of_transposed(by_row: SparseMatrix, gap: &[f64]) -> Result<Self, Error> {
        let is_empty = |row: usize| by_row.column(row).all(|(_, value)| value == 0.0);
        if let Some(row) = (0..gap.len()).find(|&row| gap[row] < 0.0 && is_empty(row)) {
            let reason =
                format!("contact row {row} has no free dof, but its gap is {:e}: it must not be negative", gap[row]);
            return Err(Error::Infeasible { reason, rows: vec![row], weights: vec![1.0], overlap: -gap[row] });
        }
        let kept: Vec<usize> = (0..gap.len()).filter(|&row| gap[row].is_finite() && !is_empty(row)).collect();

        // Opposed rows are equal after division by their first entry, except for the sign of that entry.
        let mut nearest: HashMap<Direction, Nearest> = HashMap::new();
        for &row in &kept {
            let mut entries = by_row.column(row).filter(|entry| entry.1 != 0.0).peekable();
            let Some(&(_, first)) = entries.peek() else { continue };
            let direction = entries.map(|(dof, value)| (dof, (value / first).to_bits())).collect();
            let (side, distance) = (usize::from(first < 0.0), gap[row] / first.abs());
            let place = &mut nearest.entry(direction).or_default()[side];
            if place.is_none_or(|(_, other)| distance < other) {
                *place = Some((row, distance));
            }
        }
        let crossing = nearest.values().filter_map(|sides| match sides {
            [Some((a, above)), Some((b, below))]
                if above + below < -MEETING * above.abs().max(below.abs()) && are_parallel(&by_row, *a, *b) =>
            {
                Some((*a, *b, above + below))
            }
            _ => None,
        });
        if let Some((a, b, overlap)) = crossing.min_by_key(|&(a, b, _)| a.min(b)) {
            let rows = vec![a.min(b), a.max(b)];
            let reason =
                format!("contact rows {} and {} oppose each other and overlap by {:e}", rows[0], rows[1], -overlap);
            // The rows cancel if each is divided by its first entry.
            let first = |row: usize| by_row.column(row).map(|entry| entry.1.abs()).find(|&value| value > 0.0);
            let weights = rows.iter().map(|&row| first(row).map_or(0.0, |first| 1.0 / first)).collect();
            return Err(Error::Infeasible { reason, rows, weights, overlap: -overlap });
        }
        Ok(RowSelection { by_row, kept })
    }

    /// The index of each selected row in the original problem.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The selected rows alone.
    pub fn contact(&self, contact: &SparseMatrix) -> SparseMatrix {
        contact.select_rows(&self.kept)
    }

    /// The gaps of the selected rows.
    pub fn gap(&self, gap: &[f64]) -> Vec<f64> {
        self.kept.iter().map(|&row| gap[row]).collect()
    }

    /// Multipliers of all rows from those of the selected ones: a row that cannot close carries none.
    pub fn expand_multiplier(&self, multiplier: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.by_row.columns()];
        for (&row, &value) in self.kept.iter().zip(multiplier) {
            all[row] = value;
        }
        all
    }

    /// The contact set in the original rows.
    pub fn expand_set(&self, set: &ContactSet) -> ContactSet {
        let mut all = ContactSet::open(self.by_row.columns());
        set.iter().for_each(|row| all.insert(self.kept[row]));
        all
    }

    /// The contact set in the selected rows.
    pub fn restrict_set(&self, set: &ContactSet) -> ContactSet {
        ContactSet::from_fn(self.kept.len(), |row| set.contains(self.kept[row]))
    }
}

/// Returns `true` if two rows with entries in the same places are multiples of each other, to the last bit. Quotients that are
/// equal only by rounding do not count: then some displacement meets both rows.
fn are_parallel(by_row: &SparseMatrix, a: usize, b: usize) -> bool {
    let entries = |row: usize| by_row.column(row).filter(|entry| entry.1 != 0.0).map(|entry| entry.1);
    let (Some(first_a), Some(first_b)) = (entries(a).next(), entries(b).next()) else { return false };
    // Scaled to order one, so that no product leaves the range of doubles.
    let of_order_one = |value: f64, first: f64| ldexp(value, -exponent(first));
    entries(a).zip(entries(b)).all(|(at_a, at_b)| {
        let mut difference = Accumulator::new(&[0.0]);
        difference.add_product(0, of_order_one(at_a, first_a), of_order_one(first_b, first_b));
        difference.add_product(0, -of_order_one(at_b, first_b), of_order_one(first_a, first_a));
        difference.into_sums()[0] == 0.0
    })
}
