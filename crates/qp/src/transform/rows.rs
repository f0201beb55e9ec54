//! Rows that can never close are removed.

use crate::linear::SparseMatrix;
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// The rows that can close: those with an obstacle (finite gap) and with a dof to move.
#[derive(Clone, Debug, PartialEq)]
pub struct RowSelection {
    rows: usize,
    /// The index of each selected row in the original problem.
    pub kept: Vec<usize>,
}

impl RowSelection {
    /// Selects the rows of a problem that can close.
    pub fn of(problem: &ContactProblem) -> Self {
        let (gap, mut acts) = (problem.gap(), vec![true; problem.rows()]);
        problem.without_entries.iter().for_each(|&row| acts[row] = false);
        RowSelection {
            rows: gap.len(),
            kept: (0..gap.len()).filter(|&row| gap[row].is_finite() && acts[row]).collect(),
        }
    }

    /// The selected rows alone.
    pub fn contact(&self, contact: &SparseMatrix) -> SparseMatrix {
        if self.kept.len() == self.rows { contact.clone() } else { contact.select_rows(&self.kept) }
    }

    /// The gaps of the selected rows.
    pub fn gap(&self, gap: &[f64]) -> Vec<f64> {
        self.kept.iter().map(|&row| gap[row]).collect()
    }

    /// Multipliers of all rows from those of the selected ones: a row that cannot close carries none.
    pub fn expand_multiplier(&self, multiplier: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.rows];
        for (&row, &value) in self.kept.iter().zip(multiplier) {
            all[row] = value;
        }
        all
    }

    /// The contact set in the original rows.
    pub fn expand_set(&self, set: &ContactSet) -> ContactSet {
        let mut all = ContactSet::open(self.rows);
        set.iter().for_each(|row| all.insert(self.kept[row]));
        all
    }

    /// The contact set in the selected rows.
    pub fn restrict_set(&self, set: &ContactSet) -> ContactSet {
        ContactSet::from_fn(self.kept.len(), |row| set.contains(self.kept[row]))
    }
}
