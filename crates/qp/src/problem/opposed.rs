//! Rows that contradict each other at sight: a row that nothing moves, and two rows that oppose each other.

use std::collections::HashMap;

use crate::error::Error;
use crate::linear::{Accumulator, SparseMatrix, exponent, ldexp};

/// Two opposed gaps meet if they overlap by less than this times their size: the rows are an equality.
const MEETING: f64 = 4.0 * f64::EPSILON;

/// A row divided by its first entry: dofs and the bits of their coefficients.
type Direction = Vec<(usize, u64)>;

/// Rows with the size of their first entry, on each of the two sides of a direction.
type Sides = [Vec<(usize, f64)>; 2];

/// The rows of a contact matrix that may contradict each other at some gaps.
#[derive(Clone, Debug)]
pub(super) struct OpposedRows {
    /// The rows without an entry.
    unmoved: Vec<usize>,
    /// The directions with rows on both sides.
    directions: Vec<Sides>,
    /// The transposed rows, if there are such directions.
    by_row: Option<SparseMatrix>,
}

impl OpposedRows {
    /// The rows of `contact` (m x n).
    pub fn of(contact: &SparseMatrix) -> Self {
        let by_row = contact.transposed();
        let entries = |row: usize| by_row.column(row).filter(|entry| entry.1 != 0.0);
        let mut unmoved = Vec::new();
        let mut directions: HashMap<Direction, Sides> = HashMap::new();
        for row in 0..contact.rows() {
            let Some((_, first)) = entries(row).next() else {
                unmoved.push(row);
                continue;
            };
            // Opposed rows are equal after division by their first entry, except for the sign of that entry.
            let direction = entries(row).map(|(dof, value)| (dof, (value / first).to_bits())).collect();
            directions.entry(direction).or_default()[usize::from(first < 0.0)].push((row, first.abs()));
        }
        let is_opposed = |sides: &Sides| sides.iter().all(|side| !side.is_empty());
        let directions: Vec<Sides> = directions.into_values().filter(is_opposed).collect();
        let by_row = (!directions.is_empty()).then_some(by_row);
        OpposedRows { unmoved, directions, by_row }
    }

    /// Checks that no rows contradict each other at sight under `gap` (length m).
    ///
    /// # Errors
    /// [`Error::Infeasible`] for a row without dofs and with a negative gap, and for two opposed rows with overlapping gaps.
    pub fn check(&self, gap: &[f64]) -> Result<(), Error> {
        if let Some(&row) = self.unmoved.iter().find(|&&row| gap[row] < 0.0) {
            let reason =
                format!("contact row {row} has no free dof, but its gap is {:e}: it must not be negative", gap[row]);
            return Err(Error::Infeasible { reason, rows: vec![row], weights: vec![1.0], overlap: -gap[row] });
        }
        let nearest = |side: &[(usize, f64)]| {
            let distances = side
                .iter()
                .filter(|entry| gap[entry.0].is_finite())
                .map(|&(row, first)| (row, first, gap[row] / first));
            distances.min_by(|a, b| a.2.total_cmp(&b.2))
        };
        let crossing = self.directions.iter().filter_map(|[above, below]| {
            let (a, b) = (nearest(above)?, nearest(below)?);
            let overlaps = a.2 + b.2 < -MEETING * a.2.abs().max(b.2.abs());
            let are_parallel = |by_row: &SparseMatrix| are_parallel(by_row, a.0, b.0);
            (overlaps && self.by_row.as_ref().is_some_and(are_parallel)).then_some(if a.0 < b.0 {
                [a, b]
            } else {
                [b, a]
            })
        });
        let Some(rows) = crossing.min_by_key(|rows| rows[0].0) else { return Ok(()) };
        let overlap = -(rows[0].2 + rows[1].2);
        let [first, second] = rows.map(|row| row.0);
        let reason = format!("contact rows {first} and {second} oppose each other and overlap by {overlap:e}");
        // The rows cancel if each is divided by its first entry.
        let weights = rows.iter().map(|row| 1.0 / row.1).collect();
        Err(Error::Infeasible { reason, rows: vec![first, second], weights, overlap })
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
