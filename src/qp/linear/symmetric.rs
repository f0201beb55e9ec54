//! Symmetric matrices, stored by their lower triangle.

use std::ops::Range;
use std::thread;

use super::SparseMatrix;
use crate::error::Error;

/// Entries that are worth a part of their own in a product on several threads.
const PART: usize = 250_000;

/// Parts of a product at the most: each may need a vector of its own.
const MOST_PARTS: usize = 8;

/// Two triangles count as alike when mirrored entries differ by no more than this times the largest entry of their
/// row's or column's diagonal: assembly in another order differs by rounding, 1e-10 is far above it.
const SYMMETRY_TOLERANCE: f64 = 1e-10;

/// A symmetric matrix; only its lower triangle is stored.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricMatrix {
    lower: SparseMatrix,
}

impl SymmetricMatrix {
    /// From a matrix with both triangles, which must be alike (mirrored entries may differ by rounding, 1e-10 of the
    /// larger diagonal entry; the lower one is taken).
    ///
    /// # Errors
    /// [`Error::Shape`] if not square, [`Error::NotSymmetric`] if the triangles differ.
    pub fn from_full(full: &SparseMatrix) -> Result<Self, Error> {
        square(full)?;
        let mirrored = full.transposed();
        let diagonal: Vec<f64> = (0..full.columns())
            .map(|column| full.column(column).find(|entry| entry.0 == column).map_or(0.0, |entry| entry.1.abs()))
            .collect();
        let compare = |row: usize, column: usize, value: f64, other: f64| {
            let size = diagonal[row].max(diagonal[column]);
            let scale = if size > 0.0 { size } else { value.abs().max(other.abs()) };
            if (value - other).abs() > SYMMETRY_TOLERANCE * scale {
                return Err(Error::NotSymmetric { row, column, value, mirrored: other });
            }
            Ok(())
        };
        for column in 0..full.columns() {
            // Both columns are sorted: walk them side by side.
            let (mut left, mut right) = (full.column(column).peekable(), mirrored.column(column).peekable());
            loop {
                match (left.peek().copied(), right.peek().copied()) {
                    (None, None) => break,
                    (Some((row, value)), Some((other_row, other))) if row == other_row => {
                        compare(row, column, value, other)?;
                        left.next();
                        right.next();
                    }
                    (Some((row, value)), other) if other.is_none_or(|(other_row, _)| row < other_row) => {
                        compare(row, column, value, 0.0)?;
                        left.next();
                    }
                    (_, Some((row, other))) => {
                        compare(row, column, 0.0, other)?;
                        right.next();
                    }
                    (Some(_), None) => break,
                }
            }
        }
        Ok(SymmetricMatrix { lower: lower_part(full) })
    }

    /// From the lower triangle alone (entries with row >= column).
    ///
    /// # Errors
    /// [`Error::Shape`] if not square, [`Error::NotSymmetric`] if an entry lies above the diagonal.
    pub fn from_lower(lower: SparseMatrix) -> Result<Self, Error> {
        square(&lower)?;
        let above = lower.triplets().find(|&(row, column, _)| row < column);
        match above {
            Some((row, column, value)) => Err(Error::NotSymmetric { row, column, value, mirrored: 0.0 }),
            None => Ok(SymmetricMatrix { lower }),
        }
    }

    /// From a lower triangle that is known to be one.
    pub(super) fn from_sorted_lower(lower: SparseMatrix) -> Self {
        SymmetricMatrix { lower }
    }

    /// From the upper triangle alone (entries with row <= column).
    ///
    /// # Errors
    /// As [`SymmetricMatrix::from_lower`], for the other triangle.
    pub fn from_upper(upper: &SparseMatrix) -> Result<Self, Error> {
        Self::from_lower(upper.transposed())
    }

    /// The matrix `A + B' diag(w) B` for rows B (m x n) and weights w (m).
    ///
    /// # Errors
    /// As [`SparseMatrix::from_triplets`].
    pub fn plus_squares(&self, rows: &SparseMatrix, weights: &[f64]) -> Result<Self, Error> {
        let by_row = rows.transposed();
        let mut entries: Vec<(usize, usize, f64)> = self.lower.triplets().collect();
        for (row, &weight) in weights.iter().enumerate() {
            for (first, a) in by_row.column(row) {
                let below = by_row.column(row).filter(|entry| entry.0 >= first);
                entries.extend(below.map(|(second, b)| (second, first, weight * a * b)));
            }
        }
        Self::from_lower(SparseMatrix::from_triplets(self.dim(), self.dim(), &entries)?)
    }

    /// Number of rows and of columns.
    pub fn dim(&self) -> usize {
        self.lower.columns()
    }

    /// The lower triangle, diagonal included.
    pub fn lower(&self) -> &SparseMatrix {
        &self.lower
    }

    /// The upper triangle, diagonal included.
    pub fn upper(&self) -> SparseMatrix {
        self.lower.transposed()
    }

    /// The diagonal, length `dim`.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.dim())
            .map(|column| self.lower.column(column).next().filter(|entry| entry.0 == column).map_or(0.0, |e| e.1))
            .collect()
    }

    /// The product A x.
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        self.product(x, |value| value)
    }

    /// The product A x on this number of threads. The sums run over parts of the columns that depend on the matrix alone, so that
    /// the result does not depend on the threads.
    pub fn mul_on(&self, threads: usize, x: &[f64]) -> Vec<f64> {
        let starts = self.lower.column_starts();
        let entries = self.lower.entries();
        let parts = (entries / PART).clamp(1, MOST_PARTS);
        if parts == 1 {
            return self.mul(x);
        }
        let mut bounds: Vec<usize> =
            (0..parts).map(|part| starts.partition_point(|&start| start < entries / parts * part)).collect();
        bounds.push(self.dim());
        let columns: Vec<Range<usize>> = bounds.windows(2).map(|pair| pair[0]..pair[1]).collect();
        let of_run = |run: &[Range<usize>]| -> Vec<Vec<f64>> {
            run.iter().map(|columns| self.product_of_columns(columns.clone(), x)).collect()
        };
        let sums: Vec<Vec<f64>> = match threads.min(parts) {
            1 => of_run(&columns),
            threads => thread::scope(|scope| {
                let runs: Vec<_> =
                    (columns.chunks(parts.div_ceil(threads))).map(|run| scope.spawn(|| of_run(run))).collect();
                runs.into_iter().filter_map(|run| run.join().ok()).flatten().collect()
            }),
        };
        let mut y = vec![0.0; self.dim()];
        for (columns, sum) in columns.iter().zip(&sums) {
            y[columns.start..].iter_mut().zip(sum).for_each(|(y, sum)| *y += sum);
        }
        y
    }

    /// What some columns and the rows of the same numbers add to A x, from the first of them on.
    fn product_of_columns(&self, columns: Range<usize>, x: &[f64]) -> Vec<f64> {
        let first = columns.start;
        let (starts, rows) = (self.lower.column_starts(), self.lower.row_indices());
        let last = |column: usize| rows[starts[column]..starts[column + 1]].last().map_or(first, |row| row + 1);
        let length = columns.clone().map(last).fold(columns.end, usize::max) - first;
        let mut y = vec![0.0; length];
        for column in columns {
            let mut sum = 0.0;
            for (row, value) in self.lower.column(column) {
                sum += value * x[row];
                if row != column {
                    y[row - first] += value * x[column];
                }
            }
            y[column - first] += sum;
        }
        y
    }

    /// The product |A| |x|, entry by entry: the scale of rounding in A x.
    pub fn mul_abs(&self, x: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = x.iter().map(|value| value.abs()).collect();
        self.product(&magnitude, f64::abs)
    }

    fn product(&self, x: &[f64], entry: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut y = vec![0.0; self.dim()];
        for (column, &at_column) in x.iter().enumerate().take(self.dim()) {
            let (mut rows, mut values) = self.lower.column_slices(column);
            let mut sum = 0.0;
            // Rows increase: the diagonal comes first where there is one.
            if let ([row, rows_below @ ..], [value, values_below @ ..]) = (rows, values)
                && *row == column
            {
                sum += entry(*value) * at_column;
                (rows, values) = (rows_below, values_below);
            }
            for (&row, &value) in rows.iter().zip(values) {
                let value = entry(value);
                sum += value * x[row];
                y[row] += value * at_column;
            }
            y[column] += sum;
        }
        y
    }
}

fn square(matrix: &SparseMatrix) -> Result<(), Error> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    if rows != columns {
        return Err(Error::Shape { name: "stiffness", found: (rows, columns), expected: (rows, rows) });
    }
    Ok(())
}

fn lower_part(full: &SparseMatrix) -> SparseMatrix {
    let mut starts = vec![0];
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for column in 0..full.columns() {
        for (row, value) in full.column(column).filter(|entry| entry.0 >= column) {
            rows.push(row);
            values.push(value);
        }
        starts.push(rows.len());
    }
    SparseMatrix::from_parts(full.rows(), starts, rows, values)
}
