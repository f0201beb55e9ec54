//! What follows from the matrices of a problem: its parts, rows without entries, and rows that oppose each other.

use std::collections::HashMap;

use crate::error::{Error, Result};
use crate::linear::{Accumulator, Forest, SparseMatrix, SymmetricMatrix, exponent, ldexp};

/// A coupling below this share of `sqrt(K_ii K_jj)` does not make two dofs one part.
const WEAK_COUPLING: f64 = 1e-6;

#[derive(Clone, Debug)]
pub struct Diagonal {
    /// K_ii of each dof.
    pub values: Vec<f64>,
    /// `sqrt(K_ii)` of each dof.
    pub roots: Vec<f64>,
}

/// The connected components of K and B, which share almost no energy: a coupling or a row with an obstacle joins dofs.
///
/// An answer may be right for a stiff part and wrong for a soft one beside it, because the energy of the soft part is
/// too small to show in that of the whole. Therefore a certificate measures every part in its own scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// The part of each dof, length n, numbered from 0 in the order of their first dofs.
    pub of_dof: Vec<usize>,
    /// The part of each row; 0 for a row without dofs.
    pub of_row: Vec<usize>,
    count: usize,
    /// The body of each dof and their number: the components of K alone; nothing and zero if there is but one.
    bodies: (Vec<usize>, usize),
}

impl Parts {
    /// The parts of a stiffness under contact rows with these gaps; rows with an infinite gap join nothing.
    pub fn of(stiffness: &SymmetricMatrix, diagonal: &Diagonal, contact: &SparseMatrix, gap: &[f64]) -> Self {
        let roots = &diagonal.roots;
        let mut forest = Forest::new(roots.len());
        for (column, &own) in roots.iter().enumerate() {
            if forest.is_one_tree() {
                break;
            }
            for (row, value) in stiffness.lower().column(column) {
                if row != column && value.abs() > WEAK_COUPLING * own * roots[row] {
                    forest.join(column, row);
                }
            }
        }
        let bodies = if forest.is_one_tree() { Default::default() } else { forest.clone().into_trees() };
        let mut first: Vec<Option<usize>> = vec![None; contact.rows()];
        let dofs = if forest.is_one_tree() { 0 } else { roots.len() };
        for dof in 0..dofs {
            let bounded = |entry: &(usize, f64)| entry.1 != 0.0 && gap[entry.0].is_finite();
            for (row, _) in contact.column(dof).filter(bounded) {
                forest.join(*first[row].get_or_insert(dof), dof);
            }
        }
        let (of_dof, count) = forest.into_trees();
        let mut of_row = vec![0; contact.rows()];
        if count > 1 {
            contact.triplets().filter(|entry| entry.2 != 0.0).for_each(|(row, dof, _)| of_row[row] = of_dof[dof]);
        }
        Parts { of_dof, of_row, count, bodies }
    }

    /// Number of parts, at least one: a problem without dofs has an empty one.
    pub fn count(&self) -> usize {
        self.count.max(1)
    }

    /// Returns `true` if the stiffness has no coupling of two parts, not even a weak one.
    pub fn are_apart(&self, stiffness: &SymmetricMatrix) -> bool {
        stiffness.lower().triplets().all(|(row, column, value)| value == 0.0 || self.of_dof[row] == self.of_dof[column])
    }

    pub fn bodies(&self) -> usize {
        self.bodies.1.max(1)
    }

    /// The body of a dof: K alone joins its dofs.
    pub fn body_of_dof(&self, dof: usize) -> usize {
        self.bodies.0.get(dof).copied().unwrap_or(0)
    }

    /// The sum of `term(dof)` over the dofs of each part.
    pub fn sums(&self, term: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.count()];
        self.of_dof.iter().enumerate().for_each(|(dof, &part)| sums[part] += term(dof));
        sums
    }
}

/// The gap of a row without entries is rounding if it is below this share of the largest.
const OF_LARGEST: f64 = 16.0 * f64::EPSILON;

/// Gaps that other QP solvers treat as infinite; any other finite gap is a length.
const NO_OBSTACLE: [f64; 2] = [1e20, 1e30];

/// Two opposed gaps meet if they overlap by less than this times their size: the rows are an equality.
const MEETING: f64 = 4.0 * f64::EPSILON;

/// A row divided by its first entry: dofs and the bits of their coefficients.
type Direction = Vec<(usize, u64)>;

/// Rows with the size of their first entry, on each of the two sides of a direction.
type Sides = [Vec<(usize, f64)>; 2];

/// Two opposed rows that meet exactly: `opposed` is `-ratio` times `row`, in coefficients and gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equality {
    pub row: usize,
    pub opposed: usize,
    pub ratio: f64,
}

/// The rows of a contact matrix that may contradict each other at some gaps.
#[derive(Clone, Debug)]
pub struct OpposedRows {
    /// The directions with rows on both sides.
    directions: Vec<Sides>,
    /// The transposed rows, if there are such directions.
    by_row: Option<SparseMatrix>,
}

impl OpposedRows {
    /// The rows of `contact` (m x n).
    pub fn of(contact: &SparseMatrix) -> Self {
        // Number, first value, and last dof and value of the entries of each row.
        let mut ends = vec![(0_usize, 0.0_f64, 0_usize, 0.0_f64); contact.rows()];
        for (row, dof, value) in contact.triplets().filter(|entry| entry.2 != 0.0) {
            let (count, first, ..) = ends[row];
            ends[row] = (count + 1, if count == 0 { value } else { first }, dof, value);
        }
        // Only rows that are alike in this may be opposed: number of entries, the last of them, and its quotient.
        let likeness = |row: &usize| {
            let (count, first, last, value) = ends[*row];
            (count, last, (value / first).to_bits())
        };
        let mut moved: Vec<usize> = (0..contact.rows()).filter(|&row| ends[row].0 > 0).collect();
        moved.sort_by_cached_key(likeness);
        let alike = moved.chunk_by(|a, b| likeness(a) == likeness(b)).filter(|rows| rows.len() > 1);
        let alike: Vec<usize> = alike.flatten().copied().collect();
        if alike.is_empty() {
            return OpposedRows { directions: Vec::new(), by_row: None };
        }
        let by_row = contact.transposed();
        let mut directions: HashMap<Direction, Sides> = HashMap::new();
        for row in alike {
            let first = ends[row].1;
            let entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            // Opposed rows are equal after division by their first entry, except for the sign of that entry.
            let direction = entries.map(|(dof, value)| (dof, (value / first).to_bits())).collect();
            directions.entry(direction).or_default()[usize::from(first < 0.0)].push((row, first.abs()));
        }
        let is_opposed = |sides: &Sides| sides.iter().all(|side| !side.is_empty());
        let directions: Vec<Sides> = directions.into_values().filter(is_opposed).collect();
        let by_row = (!directions.is_empty()).then_some(by_row);
        OpposedRows { directions, by_row }
    }

    /// Checks that no rows, of which these are without entries, contradict each other at sight under `gap` (length m).
    pub fn check(&self, without_entries: &[usize], gap: &[f64]) -> Result<()> {
        if let Some(&row) = without_entries.iter().find(|&&row| gap[row] < 0.0) {
            let reason =
                format!("contact row {row} has no free dof, but its gap is {:e}: it must not be negative", gap[row]);
            return Err(Error::Infeasible { reason, rows: vec![row], weights: vec![1.0], overlap: -gap[row] });
        }
        let crossing = self.nearest(gap).filter(|[a, b]| {
            let overlaps = a.2 + b.2 < -MEETING * a.2.abs().max(b.2.abs());
            overlaps && self.are_parallel(a.0, b.0)
        });
        let Some(rows) = crossing.min_by_key(|rows| rows[0].0) else { return Ok(()) };
        let overlap = -(rows[0].2 + rows[1].2);
        let [first, second] = rows.map(|row| row.0);
        let reason = format!("contact rows {first} and {second} oppose each other and overlap by {overlap:e}");
        // The rows cancel if each is divided by its first entry.
        let weights = rows.iter().map(|row| 1.0 / row.1).collect();
        Err(Error::Infeasible { reason, rows: vec![first, second], weights, overlap })
    }

    /// The equalities under `gap` (length m), in the order of their first rows.
    pub fn equalities(&self, gap: &[f64]) -> Vec<Equality> {
        let meet = |[a, b]: &[(usize, f64, f64); 2]| {
            // Not rounded: rows that meet only almost leave room between them, or none.
            let mut distance = Accumulator::new(&[0.0]);
            let unit = -exponent(a.1.max(b.1));
            distance.add_product(0, gap[a.0], ldexp(b.1, unit));
            distance.add_product(0, gap[b.0], ldexp(a.1, unit));
            distance.into_sums()[0] == 0.0 && self.are_parallel(a.0, b.0)
        };
        let of = |[a, b]: [(usize, f64, f64); 2]| Equality { row: a.0, opposed: b.0, ratio: b.1 / a.1 };
        let mut equalities: Vec<Equality> = self.nearest(gap).filter(meet).map(of).collect();
        equalities.sort_by_key(|equality| equality.row);
        equalities
    }

    /// The nearest row on each side of a direction, the smaller number first: row, first entry, distance.
    fn nearest(&self, gap: &[f64]) -> impl Iterator<Item = [(usize, f64, f64); 2]> {
        let nearest = |side: &[(usize, f64)]| {
            let finite = side.iter().filter(|entry| gap[entry.0].is_finite());
            finite.map(|&(row, first)| (row, first, gap[row] / first)).min_by(|a, b| a.2.total_cmp(&b.2))
        };
        self.directions.iter().filter_map(move |[above, below]| {
            let (a, b) = (nearest(above)?, nearest(below)?);
            Some(if a.0 < b.0 { [a, b] } else { [b, a] })
        })
    }

    fn are_parallel(&self, a: usize, b: usize) -> bool {
        self.by_row.as_ref().is_some_and(|by_row| are_parallel(by_row, a, b))
    }
}

/// Returns `true` if two rows are multiples to the last bit: if only by rounding, some displacement meets both.
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

/// The rows of a matrix without an entry.
pub fn without_entries(contact: &SparseMatrix) -> Vec<usize> {
    let mut has_entry = vec![false; contact.rows()];
    (0..contact.columns()).for_each(|dof| contact.with_rows(dof, &mut has_entry, |has, b| *has |= b != 0.0));
    (0..contact.rows()).filter(|&row| !has_entry[row]).collect()
}

/// Makes given gaps those of a problem: `+inf` for [`NO_OBSTACLE`], zero for rounding. Returns such rows and gaps.
pub fn settle(without_entries: &[usize], gap: &mut [f64]) -> Vec<(usize, f64)> {
    gap.iter_mut().filter(|gap| NO_OBSTACLE.contains(gap)).for_each(|gap| *gap = f64::INFINITY);
    let size = OF_LARGEST * largest_finite(gap);
    let is_rounding = |row: &usize| gap[*row] != 0.0 && gap[*row].abs() <= size;
    let rows: Vec<usize> = without_entries.iter().copied().filter(is_rounding).collect();
    rows.into_iter().map(|row| (row, std::mem::take(&mut gap[row]))).collect()
}

/// The largest magnitude of the finite gaps.
pub fn largest_finite(gap: &[f64]) -> f64 {
    gap.iter().filter(|gap| gap.is_finite()).fold(0.0, |most, gap| gap.abs().max(most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_opposed_rows_are_an_equality_if_they_leave_no_room_to_the_last_bit() {
        let rows = |gap: [f64; 3]| {
            let entries = [(0, 0, 1.0), (0, 1, -2.0), (1, 1, 1.0), (2, 0, -3.0), (2, 1, 6.0)];
            OpposedRows::of(&SparseMatrix::from_triplets(3, 2, &entries).unwrap()).equalities(&gap)
        };
        assert_eq!(rows([2.0, 1.0, -6.0]), [Equality { row: 0, opposed: 2, ratio: 3.0 }]);
        assert_eq!(rows([2.0, 1.0, -6.0 + 8.0 * f64::EPSILON]), []);
        assert_eq!(rows([2.0, 1.0, f64::INFINITY]), []);
    }
}
