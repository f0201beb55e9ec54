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

impl Exact {
    pub fn new(case: &Case) -> Self {
        let exact = |values: &[f64]| values.iter().map(|&value| Dyadic::from(value)).collect::<Vec<_>>();
        let rows: Vec<usize> = (0..case.gap.len()).filter(|&row| case.is_bounded(row)).collect();
        Exact {
            stiffness: case.stiffness.iter().map(|row| exact(row)).collect(),
            load: exact(&case.load),
            contact: rows.iter().map(|&row| exact(&case.contact[row])).collect(),
            gap: rows.iter().map(|&row| Dyadic::from(case.gap[row])).collect(),
            rows,
        }
    }

    pub fn dofs(&self) -> usize {
        self.load.len()
    }
}
