//! Rows held as equations and eliminated: u = Z y with B_C Z = 0.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::error::{Error, LinearError};
use crate::linear::{SparseMatrix, SymmetricMatrix};

/// What is left of a row below this share of its largest entry is rounding: the row follows from those before it.
const DEPENDENT: f64 = 1e-12;

/// A sparse vector, places increasing.
type Entries = Vec<(usize, f64)>;

/// The space in which some rows B_C u vanish, with as many unknowns fewer as there are independent rows.
#[derive(Clone, Debug)]
pub(super) struct Bonded {
    /// The transpose of Z: its column i is the row of Z of unknown i.
    lift: SparseMatrix,
    pivots: Vec<BondedUnknown>,
}

/// An unknown that a combination of rows determines.
#[derive(Clone, Debug)]
struct BondedUnknown {
    unknown: usize,
    /// The combination of rows, by their indices in B: one at the unknown, zero at the unknowns of other pivots.
    entries: Entries,
    made_of: Entries,
}

impl Bonded {
    /// The space in which the rows of B (m x n) with the indices `closed` vanish. The unknowns of `first` are
    /// eliminated where they can be; otherwise that with the largest entry of a row.
    pub fn of(rows: &SparseMatrix, closed: &[usize], first: &[usize]) -> Result<Self, Error> {
        let by_row = rows.transposed();
        let mut pivots: Vec<BondedUnknown> = Vec::with_capacity(closed.len());
        // The pivot that determines an unknown, and the pivots that may have an entry there.
        let (mut pivot_of, mut holders) = (HashMap::new(), HashMap::<usize, Vec<usize>>::new());
        for &row in closed {
            if row >= rows.rows() {
                let (rows, columns) = (rows.rows(), rows.columns());
                return Err(LinearError::IndexOutOfRange { row, column: 0, rows, columns }.into());
            }
            let given: Entries = by_row.column(row).filter(|entry| entry.1 != 0.0).collect();
            let size = given.iter().fold(0.0, |size: f64, entry| size.max(entry.1.abs()));
            let (mut entries, mut made_of) = (given.clone(), vec![(row, 1.0)]);
            for (unknown, value) in given {
                if let Some(&known) = pivot_of.get(&unknown) {
                    let BondedUnknown { entries: other, made_of: of_other, .. }: &BondedUnknown = &pivots[known];
                    entries = plus(&entries, -value, other);
                    made_of = plus(&made_of, -value, of_other);
                    entries.retain(|entry| entry.0 != unknown);
                }
            }
            entries.retain(|entry| entry.1.abs() > DEPENDENT * size);
            let by_size = |a: &&(usize, f64), b: &&(usize, f64)| a.1.abs().total_cmp(&b.1.abs());
            let wished = entries.iter().find(|entry| first.contains(&entry.0));
            let Some(&(unknown, value)) = wished.or_else(|| entries.iter().max_by(by_size)) else { continue };
            entries.iter_mut().chain(&mut made_of).for_each(|entry| entry.1 /= value);
            let number = pivots.len();
            for holder in holders.remove(&unknown).unwrap_or_default() {
                let other = &mut pivots[holder];
                let Some(share) = other.entries.iter().find(|entry| entry.0 == unknown).map(|entry| entry.1) else {
                    continue;
                };
                other.entries = plus(&other.entries, -share, &entries);
                other.entries.retain(|entry| entry.0 != unknown);
                other.made_of = plus(&other.made_of, -share, &made_of);
                let added = entries.iter().filter(|entry| entry.0 != unknown);
                added.for_each(|entry| holders.entry(entry.0).or_default().push(holder));
            }
            let others = entries.iter().filter(|entry| entry.0 != unknown);
            others.for_each(|entry| holders.entry(entry.0).or_default().push(number));
            pivot_of.insert(unknown, number);
            pivots.push(BondedUnknown { unknown, entries, made_of });
        }
        // The place of each unknown that is left.
        let (mut place, mut kept) = (vec![0; rows.columns()], 0);
        for unknown in (0..rows.columns()).filter(|unknown| !pivot_of.contains_key(unknown)) {
            (place[unknown], kept) = (kept, kept + 1);
        }
        let (mut starts, mut of, mut values) = (vec![0], Vec::new(), Vec::new());
        for unknown in 0..rows.columns() {
            match pivot_of.get(&unknown) {
                Some(&pivot) => {
                    for &(other, value) in pivots[pivot].entries.iter().filter(|entry| entry.0 != unknown) {
                        of.push(place[other] as u32);
                        values.push(-value);
                    }
                }
                None => {
                    of.push(place[unknown] as u32);
                    values.push(1.0);
                }
            }
            starts.push(of.len());
        }
        Ok(Bonded { lift: SparseMatrix::from_parts(kept, starts, of, values), pivots })
    }

    /// Returns `true` if no row is held, so that Z is the identity.
    pub fn is_free(&self) -> bool {
        self.pivots.is_empty()
    }

    /// The matrix `Z'A Z` of a matrix A (n x n).
    pub fn reduced<'a>(&self, matrix: &'a SymmetricMatrix) -> Result<Cow<'a, SymmetricMatrix>, Error> {
        match self.is_free() && matrix.dim() == self.lift.columns() {
            true => Ok(Cow::Borrowed(matrix)),
            false => Ok(Cow::Owned(matrix.congruent(&self.lift)?)),
        }
    }

    /// The unknowns u = Z y, length n, of those that are left, y.
    pub fn lifted(&self, y: &[f64]) -> Vec<f64> {
        self.lift.mul_transposed(y)
    }

    /// The multipliers of the first `rows` rows of B: with those of the others `B' lambda` equals `force` (length n),
    /// which must be such a sum. Rows that are not closed, or follow from others, have zero.
    pub fn multiplier(&self, rows: usize, force: &[f64]) -> Vec<f64> {
        let mut multiplier = vec![0.0; rows];
        for BondedUnknown { unknown, made_of, .. } in &self.pivots {
            for &(row, share) in made_of.iter().filter(|entry| entry.0 < rows) {
                multiplier[row] += share * force[*unknown];
            }
        }
        multiplier
    }
}

/// The sum of a vector and another one times a factor.
fn plus(one: &Entries, factor: f64, other: &Entries) -> Entries {
    let mut sum = Vec::with_capacity(one.len() + other.len());
    let (mut left, mut right) = (one.iter().peekable(), other.iter().peekable());
    loop {
        match (left.peek(), right.peek()) {
            (Some(&&(place, value)), Some(&&(second, by))) if place == second => {
                sum.push((place, value + factor * by));
                left.next();
                right.next();
            }
            (Some(&&(place, value)), Some(&&(second, _))) if place < second => {
                sum.push((place, value));
                left.next();
            }
            (_, Some(&&(second, by))) => {
                sum.push((second, factor * by));
                right.next();
            }
            (Some(&&(place, value)), None) => {
                sum.push((place, value));
                left.next();
            }
            (None, None) => return sum,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bonded(rows: &[&[f64]], first: &[usize]) -> (SparseMatrix, Bonded) {
        let entries = rows.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(j, &b)| (i, j, b)));
        let entries: Vec<_> = entries.filter(|entry| entry.2 != 0.0).collect();
        let matrix = SparseMatrix::from_triplets(rows.len(), rows[0].len(), &entries).unwrap();
        let closed: Vec<usize> = (0..rows.len()).collect();
        let bonded = Bonded::of(&matrix, &closed, first).unwrap();
        (matrix, bonded)
    }

    #[test]
    fn rows_vanish_on_every_lifted_vector_and_forces_are_sums_of_rows() {
        // Chains of shared unknowns, and a row that follows from two others.
        let rows: &[&[f64]] = &[
            &[1.0, -0.5, 0.0, 0.0, 0.0, 2.0],
            &[0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
            &[0.0, 0.0, 0.7, 0.3, 0.0, -1.0],
            &[1.0, 0.5, -1.0, 0.0, 0.0, 2.0],
        ];
        for first in [&[][..], &[5], &[2, 3]] {
            let (matrix, bonded) = bonded(rows, first);
            assert_eq!(bonded.lift.rows(), 3);
            assert!(first.iter().take(1).all(|&unknown| bonded.pivots.iter().any(|pivot| pivot.unknown == unknown)));
            let lifted = bonded.lifted(&[0.3, -2.0, 1.1]);
            assert!(matrix.mul(&lifted).iter().all(|left| left.abs() < 1e-14), "{lifted:?}");
            let force = matrix.mul_transposed(&[0.2, -1.0, 3.0, 0.4]);
            let back = matrix.mul_transposed(&bonded.multiplier(4, &force));
            assert!(force.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-13), "{force:?} {back:?}");
        }
    }
}
