//! A problem in exact numbers.

use super::case::Case;
use super::dyadic::Dyadic;

/// A problem in exact numbers: K (n x n), f (n), B (m x n), g (m), all rows bounded.
#[derive(Clone, Debug)]
pub struct Exact {
    pub stiffness: Vec<Vec<Dyadic>>,
    pub load: Vec<Dyadic>,
    pub contact: Vec<Vec<Dyadic>>,
    pub gap: Vec<Dyadic>,
    /// For each row its index among all rows of the case; rows without a bound are left out.
    pub rows: Vec<usize>,
}

/// The gap of a row as the problem states it: that of a row without entries counts as zero if it is at most 16 units in
/// the last place of the largest gap.
fn counted_gap(case: &Case, row: usize) -> f64 {
    let lengths = (0..case.gap.len()).filter(|&row| case.is_bounded(row)).map(|row| case.gap[row].abs());
    let largest = lengths.fold(0.0, f64::max);
    let is_empty = case.contact[row].iter().all(|&b| b == 0.0);
    if is_empty && case.gap[row].abs() <= largest / 2f64.powi(48) { 0.0 } else { case.gap[row] }
}

impl Exact {
    pub fn new(case: &Case) -> Self {
        let exact = |values: &[f64]| values.iter().map(|&value| Dyadic::from(value)).collect::<Vec<_>>();
        let rows: Vec<usize> = (0..case.gap.len()).filter(|&row| case.is_bounded(row)).collect();
        Exact {
            stiffness: case.stiffness.iter().map(|row| exact(row)).collect(),
            load: exact(&case.load),
            contact: rows.iter().map(|&row| exact(&case.contact[row])).collect(),
            gap: rows.iter().map(|&row| Dyadic::from(counted_gap(case, row))).collect(),
            rows,
        }
    }

    pub fn dofs(&self) -> usize {
        self.load.len()
    }
}
