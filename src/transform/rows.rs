//! Rows that can never close are taken out; rows that contradict each other are named.

use std::collections::HashMap;

use crate::error::Error;
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// Two opposed gaps that overlap by less than this times their size meet: the rows are an equality.
const MEETING: f64 = 4.0 * f64::EPSILON;

/// A row divided by its first entry: dofs and the bits of their coefficients.
type Direction = Vec<(usize, u64)>;

/// The row with the smallest gap, and that gap, on each of the two sides of a direction.
type Nearest = [Option<(usize, f64)>; 2];

/// The rows that can close: those with an obstacle (finite gap) and with a dof to move.
#[derive(Clone, Debug)]
pub struct RowSelection {
    rows: usize,
    kept: Vec<usize>,
    problem: ContactProblem,
}

impl RowSelection {
    /// Selects the rows of `problem` that can close.
    ///
    /// # Errors
    /// [`Error::Infeasible`] for a row without dofs whose gap is negative, and for two opposed rows whose gaps overlap.
    pub fn of(problem: &ContactProblem) -> Result<Self, Error> {
        let by_row = problem.contact().transposed();
        let gap = problem.gap();
        let is_empty = |row: usize| by_row.column(row).all(|(_, value)| value == 0.0);
        if let Some(row) = (0..problem.rows()).find(|&row| gap[row] < 0.0 && is_empty(row)) {
            let reason =
                format!("contact row {row} has no free dof, but its gap is {:e}: it must not be negative", gap[row]);
            return Err(Error::Infeasible { reason, rows: vec![row] });
        }
        let kept: Vec<usize> = (0..problem.rows()).filter(|&row| gap[row].is_finite() && !is_empty(row)).collect();

        // Opposed rows are alike after division by their first entry, and differ in its sign.
        let mut nearest: HashMap<Direction, Nearest> = HashMap::new();
        for &row in &kept {
            let entries: Vec<(usize, f64)> = by_row.column(row).filter(|entry| entry.1 != 0.0).collect();
            let first = entries[0].1;
            let direction = entries.iter().map(|&(dof, value)| (dof, (value / first).to_bits())).collect();
            let (side, distance) = (usize::from(first < 0.0), gap[row] / first.abs());
            let place = &mut nearest.entry(direction).or_default()[side];
            if place.is_none_or(|(_, other)| distance < other) {
                *place = Some((row, distance));
            }
        }
        let crossing = nearest.values().filter_map(|sides| match sides {
            [Some((a, above)), Some((b, below))] if above + below < -MEETING * above.abs().max(below.abs()) => {
                Some(((*a).min(*b), (*a).max(*b), above + below))
            }
            _ => None,
        });
        if let Some((a, b, overlap)) = crossing.min_by_key(|pair| pair.0) {
            let reason = format!("contact rows {a} and {b} oppose each other and overlap by {:e}", -overlap);
            return Err(Error::Infeasible { reason, rows: vec![a, b] });
        }

        let contact = problem.contact().select_rows(&kept);
        let gap = kept.iter().map(|&row| gap[row]).collect();
        let problem = ContactProblem::new(problem.stiffness().clone(), problem.load().to_vec(), contact, gap)?;
        Ok(RowSelection { rows: by_row.columns(), kept, problem })
    }

    /// The problem of the selected rows alone.
    pub fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// The index in the original problem of each selected row.
    pub fn kept(&self) -> &[usize] {
        &self.kept
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
        set.iter().for_each(|row| all.set(self.kept[row], true));
        all
    }

    /// The contact set in the selected rows.
    pub fn restrict_set(&self, set: &ContactSet) -> ContactSet {
        ContactSet::from_fn(self.kept.len(), |row| set.contains(self.kept[row]))
    }
}
