//! Symmetric matrices, stored by their lower triangle.

use std::ops::Range;

use super::columns::{Columns, Taken, places};
use super::dense::wide_product;
use super::dependence::merged;
use super::threads::{SharedRows, in_order};
use super::{Spare, SparseMatrix};
use crate::error::Error;

/// Number of entries that justify a separate part in a product on several threads.
const PART: usize = 250_000;

/// Largest number of parts of a product: each may need its own vector.
const MOST_PARTS: usize = 8;

/// A symmetric matrix, such as a stiffness or a mass; only its lower triangle is stored. Clones share their memory.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricMatrix {
    lower: SparseMatrix,
}

impl SymmetricMatrix {
    /// The same without entries beside the diagonal that are at most `share` of the root of the product of their
    /// diagonal entries.
    pub fn without_rounding(&self, share: f64) -> Self {
        let diagonal = self.diagonal();
        let is_rounding = |i: usize, j: usize, value: f64| {
            i != j && value * value <= share * share * (diagonal[i] * diagonal[j]).abs()
        };
        let kept: Vec<_> = self.lower.triplets().filter(|&(i, j, value)| !is_rounding(i, j, value)).collect();
        match SparseMatrix::from_triplets(self.dim(), self.dim(), &kept) {
            Ok(lower) if kept.len() < self.lower.entries() => SymmetricMatrix { lower },
            _ => self.clone(),
        }
    }

    /// From a matrix with both triangles, which must be alike (mirrored entries may differ by rounding, 1e-10 of the
    /// larger diagonal entry; the lower one is taken).
    ///
    /// # Errors
    /// [`Error::Shape`] if not square, [`Error::NotSymmetric`] if the triangles differ.
    pub fn from_full(full: &SparseMatrix) -> Result<Self, Error> {
        check_shape("stiffness", (full.rows(), full.columns()), (full.rows(), full.rows()))?;
        let (starts, values, rows) = (full.column_starts(), full.values(), full.row_indices().collect::<Vec<_>>());
        Ok(SymmetricMatrix { lower: Columns { starts, rows: &rows, values }.walked(Taken::Lower)?.0 })
    }

    /// From the values of both triangles, row by row, which must be alike as in [`SymmetricMatrix::from_full`]. Zeros
    /// are left out.
    ///
    /// # Errors
    /// Those of [`SparseMatrix::from_table`] and [`SymmetricMatrix::from_full`].
    pub fn from_table(dim: usize, values: &[f64]) -> Result<Self, Error> {
        let is_same = |row: usize| (0..row).all(|column| values[row * dim + column] == values[column * dim + row]);
        if Some(values.len()) != dim.checked_mul(dim) || !(0..dim).all(is_same) {
            return Self::from_full(&SparseMatrix::from_table(dim, dim, values)?);
        }
        // A column of the lower triangle is the end of a row.
        let end_of = |row: usize| (row..dim).zip(values[row * dim + row..(row + 1) * dim].iter().copied());
        Ok(SymmetricMatrix { lower: SparseMatrix::of_columns(dim, dim, dim * (dim + 1) / 2, end_of)? })
    }

    /// From the compressed columns of both triangles, which must be alike as in [`SymmetricMatrix::from_full`]:
    /// `column_starts` of length `dim + 1`, and for each entry its row, from 0 and increasing within a column, and its
    /// value. The indices have any type. One pass; only the lower triangle is copied.
    ///
    /// ```
    /// use signorini_linear::SymmetricMatrix;
    ///
    /// // [2 -1; -1 3]
    /// let matrix = SymmetricMatrix::from_csc(&[0_i32, 2, 4], &[0, 1, 0, 1], &[2.0, -1.0, -1.0, 3.0])?;
    /// assert_eq!(matrix.mul(&[1.0, 1.0]), [1.0, 2.0]);
    /// assert!(SymmetricMatrix::from_csc(&[0_i32, 2, 4], &[0, 1, 0, 1], &[2.0, -1.0, 1.0, 3.0]).is_err());
    /// # Ok::<(), signorini_linear::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Length`] for arrays that do not fit each other, [`Error::Pattern`] for starts that decrease or rows
    /// that do not increase, [`Error::IndexOutOfRange`] for a row beyond the last, [`Error::NotFinite`],
    /// [`Error::NotSymmetric`] if the triangles differ, [`Error::Numerical`] for lack of memory.
    pub fn from_csc<I>(column_starts: &[I], row_indices: &[I], values: &[f64]) -> Result<Self, Error>
    where
        I: Copy + TryInto<usize>,
    {
        let given = Columns { starts: column_starts, rows: row_indices, values };
        Ok(SymmetricMatrix { lower: given.walked(Taken::Lower)?.0 })
    }

    /// The same from compressed rows: `row_starts` of length `dim + 1`, and for each entry its column and its value.
    ///
    /// # Errors
    /// As [`SymmetricMatrix::from_csc`], with rows and columns exchanged.
    pub fn from_csr<I>(row_starts: &[I], column_indices: &[I], values: &[f64]) -> Result<Self, Error>
    where
        I: Copy + TryInto<usize>,
    {
        // Read as columns they are the transposed matrix; its upper triangle is the lower triangle of this matrix.
        let given = Columns { starts: row_starts, rows: column_indices, values };
        if let (lower, false) = given.walked(Taken::Upper)? {
            return Ok(SymmetricMatrix { lower });
        }
        let indices = |given: &[I]| given.iter().filter_map(|&index| index.try_into().ok()).collect();
        let (starts, columns) = (indices(row_starts), indices(column_indices));
        let transposed = SparseMatrix::from_csc(row_starts.len().saturating_sub(1), starts, columns, values.to_vec())?;
        Self::from_full(&transposed.transposed())
    }

    /// From the lower triangle alone (entries with row >= column).
    ///
    /// # Errors
    /// [`Error::Shape`] if not square, [`Error::NotSymmetric`] if an entry lies above the diagonal.
    pub fn from_lower(lower: SparseMatrix) -> Result<Self, Error> {
        check_shape("stiffness", (lower.rows(), lower.columns()), (lower.rows(), lower.rows()))?;
        let above = lower.triplets().find(|&(row, column, _)| row < column);
        let Some((row, column, value)) = above else { return Ok(SymmetricMatrix { lower }) };
        Err(Error::NotSymmetric { row, column, value, mirrored: 0.0 })
    }

    /// From a lower triangle that is known to be valid.
    pub(super) fn from_sorted_lower(lower: SparseMatrix) -> Self {
        SymmetricMatrix { lower }
    }

    /// The matrix with these numbers on its diagonal, in their order, and no others.
    pub fn of_diagonal(values: Vec<f64>) -> Self {
        let rows = (0..values.len() as u32).collect();
        Self::from_sorted_lower(SparseMatrix::from_parts(values.len(), (0..=values.len()).collect(), rows, values))
    }

    /// From the upper triangle alone (entries with row <= column).
    ///
    /// # Errors
    /// As [`SymmetricMatrix::from_lower`], for the other triangle.
    pub fn from_upper(upper: &SparseMatrix) -> Result<Self, Error> {
        Self::from_lower(upper.transposed())
    }

    /// The matrix with `count` more rows and columns of zeros at its end.
    pub fn with_empty(self, count: usize) -> Self {
        SymmetricMatrix { lower: self.lower.with_empty(count) }
    }

    /// The matrix `A + B' diag(w) B` for rows B (m x n) and weights w (m).
    ///
    /// # Errors
    /// As [`SparseMatrix::from_triplets`].
    pub fn plus_squares(&self, rows: &SparseMatrix, weights: &[f64]) -> Result<Self, Error> {
        let by_row = rows.transposed();
        let mut entries: Vec<(usize, usize, f64)> = self.lower.triplets().collect();
        for (row, &weight) in weights.iter().enumerate() {
            entries.extend(by_row.square(row).map(|(second, first, product)| (second, first, weight * product)));
        }
        Self::from_lower(SparseMatrix::from_triplets(self.dim(), self.dim(), &entries)?)
    }

    /// The matrix `a A + b B`, with a place for every entry of both.
    ///
    /// # Errors
    /// [`Error::Shape`] for a matrix of another size, [`Error::NotFinite`] if entries overflow.
    pub fn combined(&self, own: f64, factor: f64, other: &Self) -> Result<Self, Error> {
        check_shape("mass", (other.dim(), other.dim()), (self.dim(), self.dim()))?;
        let places = self.lower.entries().max(other.lower.entries());
        let (mut starts, mut rows, mut values) =
            (Vec::with_capacity(self.dim() + 1), Vec::with_capacity(places), Vec::with_capacity(places));
        starts.push(0);
        for column in 0..self.dim() {
            for (row, a, b) in merged(self.lower.column(column), other.lower.column(column)) {
                rows.push(row as u32);
                values.push(own * a.unwrap_or(0.0) + factor * b.unwrap_or(0.0));
            }
            starts.push(rows.len());
        }
        let lower = SparseMatrix::from_parts(self.dim(), starts, rows, values).finite()?;
        Ok(SymmetricMatrix { lower })
    }

    /// Every entry multiplied by a number, which may have a unit.
    ///
    /// # Errors
    /// [`Error::NotFinite`] if entries overflow.
    pub fn times(&self, factor: f64) -> Result<Self, Error> {
        let values = self.lower.values().iter().map(|value| factor * value).collect();
        Ok(SymmetricMatrix { lower: self.lower.with_values(values).finite()? })
    }

    /// The matrix P A P' with its columns in another order: column `order[k]` of A becomes column k.
    pub fn ordered(&self, order: &[usize]) -> Result<Self, Error> {
        let place = places(order);
        let entries: Vec<_> = (self.lower.triplets())
            .map(|(i, j, value)| (place[i].max(place[j]), place[i].min(place[j]), value))
            .collect();
        Self::from_lower(SparseMatrix::from_triplets(self.dim(), self.dim(), &entries)?)
    }

    /// Number of rows and columns of the symmetric matrix.
    pub fn dim(&self) -> usize {
        self.lower.columns()
    }

    /// Number of entries of both triangles.
    pub fn entries(&self) -> usize {
        let has_diagonal = |&column: &usize| self.lower.column_rows(column).first() == Some(&(column as u32));
        2 * self.lower.entries() - (0..self.dim()).filter(has_diagonal).count()
    }

    /// Number of entries in each row, both triangles.
    pub fn row_lengths(&self) -> Vec<u32> {
        let mut lengths: Vec<u32> = (0..self.dim()).map(|row| self.lower().column_rows(row).len() as u32).collect();
        self.lower().triplets().filter(|entry| entry.0 != entry.1).for_each(|(row, _, _)| lengths[row] += 1);
        lengths
    }

    /// Calls `take(columns, values)` for each row, from the first on, with its columns in their order.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn each_row<E>(&self, mut take: impl FnMut(&[u32], &[f64]) -> Result<(), E>) -> Result<(), E> {
        let upper = self.upper();
        (0..self.dim()).try_for_each(|row| {
            let left = upper.column(row).take_while(|entry| entry.0 < row);
            let entries = left.chain(self.lower().column(row)).map(|(column, value)| (column as u32, value));
            let (columns, values): (Vec<u32>, Vec<f64>) = entries.unzip();
            take(&columns, &values)
        })
    }

    /// The lower triangle, diagonal included.
    pub fn lower(&self) -> &SparseMatrix {
        &self.lower
    }

    /// The upper triangle, diagonal included.
    pub fn upper(&self) -> SparseMatrix {
        self.lower.transposed()
    }

    /// The diagonal, length `dim`, zero at places without an entry.
    pub fn diagonal(&self) -> Vec<f64> {
        let first = |column: usize| self.lower.column(column).next().filter(|entry| entry.0 == column);
        (0..self.dim()).map(|column| first(column).map_or(0.0, |entry| entry.1)).collect()
    }

    /// The product A x, length `dim`; `x` has length `dim`.
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        self.product(0..self.dim(), x, |value| value)
    }

    /// The products of A with columns of length `dim`, one after the other.
    pub fn mul_all(&self, columns: &[f64]) -> Vec<f64> {
        columns.chunks(self.dim().max(1)).flat_map(|column| self.mul(column)).collect()
    }

    /// The product A x, length `dim`, on this number of threads; `x` has length `dim`. The sums run over parts of the
    /// columns that depend on the matrix alone, so that the result does not depend on the threads.
    pub fn mul_on(&self, threads: usize, x: &[f64]) -> Vec<f64> {
        self.mul_with(threads, x, &Spare::default())
    }

    /// The same; the product, length n, is one of these work vectors.
    pub fn mul_with(&self, threads: usize, x: &[f64], spare: &Spare<f64>) -> Vec<f64> {
        let columns = SharedRows { starts: self.lower.column_starts(), threads: MOST_PARTS }.runs_of(PART);
        if columns.len() == 1 {
            return self.mul(x);
        }
        let runs = columns.chunks(columns.len().div_ceil(threads.clamp(1, columns.len()))).collect();
        let of_run = |run: &[Range<usize>]| -> Vec<Vec<f64>> {
            run.iter().map(|columns| self.product(columns.clone(), x, |value| value)).collect()
        };
        let sums: Vec<Vec<f64>> = in_order(runs, of_run).into_iter().flatten().collect();
        let mut y = spare.zeros(self.dim());
        for (columns, sum) in columns.iter().zip(sums) {
            y[columns.start..].iter_mut().zip(sum).for_each(|(y, sum)| *y += sum);
        }
        y
    }

    /// The product |A| |x|, length `dim`, entry by entry: the scale of rounding in A x; `x` has length `dim`.
    pub fn mul_abs(&self, x: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = x.iter().map(|value| value.abs()).collect();
        self.product(0..self.dim(), &magnitude, f64::abs)
    }

    /// The contribution of some columns, and of the rows with the same numbers, to A x, from the first column on as far
    /// as they reach; `entry` makes the entries of A.
    fn product(&self, columns: Range<usize>, x: &[f64], entry: impl Fn(f64) -> f64) -> Vec<f64> {
        let first = columns.start;
        let end = |column: usize| self.lower.column_rows(column).last().map_or(first, |&row| row as usize + 1);
        let mut y = vec![0.0; columns.clone().map(end).fold(columns.end, usize::max) - first];
        for column in columns {
            let (mut rows, mut values) = self.lower.column_slices(column);
            let at_column = x[column];
            let mut sum = 0.0;
            // Rows increase: the diagonal entry comes first if there is one.
            if let ([row, rows_below @ ..], [value, values_below @ ..]) = (rows, values)
                && *row as usize == column
            {
                sum += entry(*value) * at_column;
                (rows, values) = (rows_below, values_below);
            }
            if rows.len() + column + 1 == self.dim() {
                // Every row below the diagonal.
                sum += wide_product(values, &x[column + 1..], &entry);
                let below = &mut y[column + 1 - first..];
                below.iter_mut().zip(values).for_each(|(y, &value)| *y += entry(value) * at_column);
                (rows, values) = (&[], &[]);
            }
            for (&row, &value) in rows.iter().zip(values) {
                let (row, value) = (row as usize, entry(value));
                sum += value * x[row];
                y[row - first] += value * at_column;
            }
            y[column - first] += sum;
        }
        y
    }
}

fn check_shape(name: &'static str, found: (usize, usize), expected: (usize, usize)) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Shape { name, found, expected }) }
}
