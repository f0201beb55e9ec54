//! The linear algebra below the quadratic program: sparse matrices in compressed columns, their Cholesky factors,
//! multigrid with faces, eigenvectors, exact sums; and what every crate above takes from the machine: files, memory, a
//! watch.
//!
//! ```
//! use signorini_linear::{Analysis, SparseMatrix, SymmetricMatrix};
//! let k = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(2, 2, &[(0, 0, 4.0), (1, 0, 2.0), (1, 1, 5.0)])?)?;
//! assert_eq!(Analysis::of(&k)?.factor(&k)?.solve(&[8.0, 12.0]), [1.0, 2.0]);
//! # Ok::<(), signorini_linear::Error>(())
//! ```
//!
//! It knows no contact. Its exports are for the crates of this workspace; `signorini_qp` re-exports those for users.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(
    clippy::missing_errors_doc,
    reason = "what users see of it has them; the rest is for the crates of this workspace"
)]

mod augmented;
mod both_triangles;
mod cholesky;
mod columns;
mod compliance;
mod conjugate_gradients;
mod dense;
mod dependence;
pub mod eigen;
pub mod equations;
mod error;
mod factor;
pub mod file;
#[cfg(any(feature = "faer", feature = "nalgebra"))]
mod foreign;
pub mod matrix_market;
pub mod memory;
pub mod multigrid;
mod null_space;
mod ordering;
mod power_of_two;
mod quotient;
mod real;
pub mod selected_inverse;
mod spare;
mod symmetric;
mod threads;
pub mod twice;
pub mod watch;

pub use augmented::{Augmented, AugmentedMatrix};
pub use both_triangles::SymmetricLines;
pub use cholesky::{Analysis, Cholesky};
pub use compliance::{AT_ONCE, Compliance};
pub use conjugate_gradients::{Blocks, Iterate};
use dense::wide_product;
pub use dense::{
    LowerTriangle, UpperTriangle, across, check_finite, check_vector, dot, extend, largest, norm, subtract, take_out,
    turned,
};
pub use dependence::{Dependence, inverse_lengths, inverse_lengths_by_products};
pub use error::{Error, guarded};
pub use factor::{FactorError, call, if_definite, par};
pub use multigrid::Width;
pub use null_space::NullSpace;
pub use ordering::Fill;
pub use power_of_two::{Equilibration, exponent, ldexp};
pub use quotient::Forest;
pub use real::generic;
pub use spare::Spare;
pub use symmetric::SymmetricMatrix;
pub use threads::{in_order, threads_of_machine};
pub use twice::{Accumulator, ExactSum, Twice};

use std::sync::Arc;

use columns::{Columns, Taken, group_starts};
use real::for_processor;

/// A real matrix in compressed columns: rows sorted within each column, no duplicates, all values finite.
///
/// Clones share their memory, and so do matrices of one pattern: a stiffness and its scaled form keep one set of
/// indices.
///
/// ```
/// use signorini_linear::SparseMatrix;
///
/// // One contact row over three dofs: u_1 - u_2.
/// let contact = SparseMatrix::from_triplets(1, 3, &[(0, 1, 1.0), (0, 2, -1.0)])?;
/// assert_eq!((contact.rows(), contact.columns()), (1, 3));
/// # Ok::<(), signorini_linear::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SparseMatrix {
    rows: usize,
    pattern: Arc<Pattern>,
    values: Arc<Vec<f64>>,
}

/// The positions of the entries, column by column. A column with the last rows of those before it shares them: of a
/// stiffness, the columns of a node have one list of rows, which takes a third of the memory in space.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Pattern {
    /// The first entry of each column, and their number at the end.
    column_starts: Vec<usize>,
    /// Where the rows of each column start in `rows`.
    row_starts: Vec<usize>,
    rows: Vec<u32>,
}

impl Pattern {
    fn of(column_starts: Vec<usize>, mut rows: Vec<u32>) -> Self {
        let (mut row_starts, mut kept) = (Vec::with_capacity(column_starts.len() - 1), 0);
        for column in column_starts.windows(2) {
            let count = column[1] - column[0];
            match kept >= count && rows[kept - count..kept] == rows[column[0]..column[1]] {
                true => row_starts.push(kept - count),
                false => {
                    rows.copy_within(column[0]..column[1], kept);
                    row_starts.push(kept);
                    kept += count;
                }
            }
        }
        rows.truncate(kept);
        rows.shrink_to_fit();
        Pattern { column_starts, row_starts, rows }
    }
}

impl SparseMatrix {
    /// The matrix of `rows` x `columns` with the given entries `(row, column, value)`, indices from 0, in any order;
    /// entries with the same row and column are added.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`] for an entry outside, [`Error::NotFinite`] for a value that is not finite,
    /// [`Error::Pattern`] for 2^32 rows or more.
    pub fn from_triplets(rows: usize, columns: usize, triplets: &[(usize, usize, f64)]) -> Result<Self, Error> {
        check_rows(rows)?;
        for &(row, column, value) in triplets {
            if row >= rows || column >= columns {
                return Err(Error::IndexOutOfRange { row, column, rows, columns });
            }
            if !value.is_finite() {
                let at = format!("({row}, {column})");
                return Err(Error::NotFinite { name: "matrix", at, value, allowed: "finite" });
            }
        }
        let starts = group_starts(columns, triplets.iter().map(|entry| entry.1));
        let mut place = starts.clone();
        let mut entries = vec![(0_usize, 0.0_f64); triplets.len()];
        for &(row, column, value) in triplets {
            entries[place[column]] = (row, value);
            place[column] += 1;
        }
        let mut column_starts = Vec::with_capacity(columns + 1);
        let (mut row_indices, mut values) = (Vec::with_capacity(triplets.len()), Vec::with_capacity(triplets.len()));
        column_starts.push(0);
        for column in 0..columns {
            let of_column = &mut entries[starts[column]..starts[column + 1]];
            of_column.sort_by_key(|entry| entry.0);
            for alike in of_column.chunk_by(|a, b| a.0 == b.0) {
                row_indices.push(alike[0].0 as u32);
                values.push(alike.iter().map(|entry| entry.1).sum());
            }
            column_starts.push(row_indices.len());
        }
        Ok(Self::from_parts(rows, column_starts, row_indices, values))
    }

    /// The matrix of `rows` rows with given compressed columns: `column_starts` of length `columns + 1`, and for each
    /// entry its row, from 0 and increasing within a column, and its value. Starts and values are not copied.
    ///
    /// ```
    /// use signorini_linear::SparseMatrix;
    ///
    /// // [1 0; 2 3]
    /// let matrix = SparseMatrix::from_csc(2, vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0])?;
    /// assert_eq!(matrix.mul(&[1.0, 1.0]), [1.0, 5.0]);
    /// # Ok::<(), signorini_linear::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Length`] for arrays that do not fit each other, [`Error::Pattern`] for starts that decrease or rows
    /// that do not increase, or for 2^32 rows or more, [`Error::IndexOutOfRange`] for a row beyond the last,
    /// [`Error::NotFinite`] for a value that is not finite.
    pub fn from_csc(
        rows: usize,
        column_starts: Vec<usize>,
        row_indices: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<Self, Error> {
        check_rows(rows)?;
        let shape = (rows, column_starts.len().saturating_sub(1));
        let columns = Columns { starts: &column_starts, rows: &row_indices, values: &values };
        columns.each(|column, rows, values| Taken::Lower.check(shape, column, rows, values))?;
        let row_indices = row_indices.iter().map(|&row| row as u32).collect();
        Ok(Self::from_parts(rows, column_starts, row_indices, values))
    }

    /// The matrix of this shape with these values, length `rows * columns`, row by row. Zeros are left out.
    ///
    /// ```
    /// use signorini_linear::SparseMatrix;
    ///
    /// let matrix = SparseMatrix::from_table(2, 2, &[1.0, 0.0, 2.0, 3.0])?;
    /// assert_eq!(matrix, SparseMatrix::from_csc(2, vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0])?);
    /// # Ok::<(), signorini_linear::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Length`] for another number of values, [`Error::Pattern`] for 2^32 rows or more, [`Error::NotFinite`].
    pub fn from_table(rows: usize, columns: usize, values: &[f64]) -> Result<Self, Error> {
        Error::check_length("matrix", values.len(), rows.saturating_mul(columns), "entries of its shape")?;
        let of_column = |column| (0..rows).map(move |row| (row, values[row * columns + column]));
        Self::of_columns(rows, columns, values.len(), of_column)
    }

    /// The matrix of these columns, each with its entries `(row, value)` by increasing row, at most `most` in all.
    /// Zeros are left out.
    fn of_columns<I>(rows: usize, columns: usize, most: usize, column: impl Fn(usize) -> I) -> Result<Self, Error>
    where
        I: Iterator<Item = (usize, f64)>,
    {
        check_rows(rows)?;
        let (mut starts, mut end) = (Vec::with_capacity(columns + 1), 0);
        let (mut row_indices, mut values) = (vec![0; most], vec![0.0; most]);
        starts.push(0);
        for number in 0..columns {
            for (row, value) in column(number) {
                // The next entry takes the place of a zero.
                (row_indices[end], values[end]) = (row as u32, value);
                end += usize::from(value != 0.0);
            }
            starts.push(end);
        }
        row_indices.truncate(end);
        values.truncate(end);
        Self::from_parts(rows, starts, row_indices, values).finite()
    }

    fn finite(self) -> Result<Self, Error> {
        if self.values.iter().all(|value| value.is_finite()) {
            return Ok(self);
        }
        let beyond = self.triplets().find(|entry| !entry.2.is_finite());
        beyond.map_or(Ok(self.clone()), |(row, column, value)| {
            Err(Error::NotFinite { name: "matrix", at: format!("({row}, {column})"), value, allowed: "finite" })
        })
    }

    /// The matrix with given compressed columns, which must be sorted and in range: `column_starts` has one entry per
    /// column and one more, the others one entry per value. For the crates of this workspace, which know that; others
    /// take [`from_csc`](Self::from_csc).
    pub fn from_parts(rows: usize, column_starts: Vec<usize>, row_indices: Vec<u32>, values: Vec<f64>) -> Self {
        SparseMatrix { rows, pattern: Arc::new(Pattern::of(column_starts, row_indices)), values: Arc::new(values) }
    }

    /// The matrix of the same pattern with these values, in the order of [`values`](Self::values).
    pub fn with_values(&self, values: Vec<f64>) -> Self {
        SparseMatrix { rows: self.rows, pattern: self.pattern.clone(), values: Arc::new(values) }
    }

    /// The matrix with `count` more rows and columns of zeros at its end; values are not copied, positions only if they
    /// are shared.
    pub fn with_empty(self, count: usize) -> Self {
        let SparseMatrix { rows, pattern, values } = self;
        let mut pattern = Arc::unwrap_or_clone(pattern);
        pattern.column_starts.extend(vec![values.len(); count]);
        pattern.row_starts.extend(vec![pattern.rows.len(); count]);
        SparseMatrix { rows: rows + count, pattern: Arc::new(pattern), values }
    }

    /// Number of rows, empty ones included.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns, empty ones included.
    pub fn columns(&self) -> usize {
        self.pattern.column_starts.len() - 1
    }

    /// Number of stored entries, explicit zeros included.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// First entry of each column, and [`entries`](Self::entries) at the end, length `columns + 1`.
    pub fn column_starts(&self) -> &[usize] {
        &self.pattern.column_starts
    }

    /// Row of each entry, column by column, from 0; [`entries`](Self::entries) of them.
    pub fn row_indices(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.columns()).flat_map(|column| self.column_rows(column).iter().copied())
    }

    /// Value of each entry, column by column, in the order of [`row_indices`](Self::row_indices).
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The entries `(row, value)` of one column.
    #[inline]
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (rows, values) = self.column_slices(column);
        rows.iter().map(|&row| row as usize).zip(values.iter().copied())
    }

    /// The columns with an entry other than zero, increasing.
    pub fn columns_with_entries(&self) -> Vec<usize> {
        let has_entry = |&column: &usize| self.column_slices(column).1.iter().any(|&value| value != 0.0);
        (0..self.columns()).filter(has_entry).collect()
    }

    /// Calls `take(of_row, value)` for each entry of a column, with the item of its row: a column of all rows is walked
    /// as one run.
    #[inline(always)]
    pub fn with_rows<T>(&self, column: usize, of_rows: &mut [T], mut take: impl FnMut(&mut T, f64)) {
        let (rows, values) = self.column_slices(column);
        match rows.len() == of_rows.len() {
            true => of_rows.iter_mut().zip(values).for_each(|(of_row, &value)| take(of_row, value)),
            false => rows.iter().zip(values).for_each(|(&row, &value)| take(&mut of_rows[row as usize], value)),
        }
    }

    fn column_rows(&self, column: usize) -> &[u32] {
        self.column_slices(column).0
    }

    #[inline(always)]
    fn column_slices(&self, column: usize) -> (&[u32], &[f64]) {
        let Pattern { column_starts, row_starts, rows } = &*self.pattern;
        let values = &self.values[column_starts[column]..column_starts[column + 1]];
        (&rows[row_starts[column]..][..values.len()], values)
    }

    /// Returns `true` for the same matrix in the same memory.
    pub fn is_shared_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pattern, &other.pattern) && Arc::ptr_eq(&self.values, &other.values)
    }

    /// All entries `(row, column, value)`, column by column.
    pub fn triplets(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.columns()).flat_map(move |column| self.column(column).map(move |(row, value)| (row, column, value)))
    }

    /// The product A x, length `rows`; `x` has length `columns`.
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        self.product(x, |value| value)
    }

    /// The sum A x + b, length `rows`, with twice the working precision; `x` has length `columns`.
    pub fn mul_added(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut sums = Accumulator::new(b);
        sums.add_columns(|column| self.column(column), x);
        sums.into_sums()
    }

    /// The product A' y, length `columns`; `y` has length `rows`.
    pub fn mul_transposed(&self, y: &[f64]) -> Vec<f64> {
        self.transposed_product(y, |value| value)
    }

    /// The signs of the entries of A' y, without any rounding; `None` if a product leaves the range in which that is
    /// possible.
    pub fn signs_transposed(&self, y: &[f64]) -> Option<Vec<i32>> {
        let sign = |column: usize| {
            let mut sum = ExactSum::default();
            let entries = self.column(column).filter(|entry| y[entry.0] != 0.0);
            entries.for_each(|(row, value)| sum.add_product(value, y[row]));
            sum.sign()
        };
        (0..self.columns()).map(sign).collect()
    }

    /// The product A' y, of which `entry` makes the entries of A.
    fn transposed_product(&self, y: &[f64], entry: impl Fn(f64) -> f64) -> Vec<f64> {
        let of_column = |column: usize| {
            let (rows, values) = self.column_slices(column);
            match rows.len() == y.len() {
                true => wide_product(values, y, &entry),
                false => rows.iter().zip(values).map(|(&row, &value)| entry(value) * y[row as usize]).sum(),
            }
        };
        (0..self.columns()).map(of_column).collect()
    }

    /// The product |A| |x|, length `rows`, entry by entry: the scale of rounding in A x; `x` has length `columns`.
    pub fn mul_abs(&self, x: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = x.iter().map(|value| value.abs()).collect();
        self.product(&magnitude, f64::abs)
    }

    /// The product A x, of which `entry` makes the entries of A.
    fn product(&self, x: &[f64], entry: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut y = vec![0.0; self.rows];
        add_product(self, x, &mut y, entry);
        y
    }

    /// The product |A|' |y|, length `columns`; `y` has length `rows`.
    pub fn mul_abs_transposed(&self, y: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = y.iter().map(|value| value.abs()).collect();
        self.transposed_product(&magnitude, f64::abs)
    }

    /// The transposed matrix: its columns are the rows of this one.
    pub fn transposed(&self) -> Self {
        if self.entries() > 0 && self.entries() == self.rows * self.columns() {
            let (columns, rows) = (self.columns(), 0..self.columns() as u32);
            let column_starts = (0..=self.rows).map(|row| row * columns).collect();
            let pattern = Pattern { column_starts, row_starts: vec![0; self.rows], rows: rows.collect() };
            let mut values = Vec::with_capacity(self.entries());
            (0..self.rows).for_each(|row| values.extend(self.values.chunks_exact(self.rows).map(|column| column[row])));
            return SparseMatrix { rows: columns, pattern: Arc::new(pattern), values: Arc::new(values) };
        }
        let starts = group_starts(self.rows, self.row_indices().map(|row| row as usize));
        let mut place = starts.clone();
        let mut row_indices = vec![0; self.entries()];
        let mut values = vec![0.0; self.entries()];
        for (row, column, value) in self.triplets() {
            row_indices[place[row]] = column as u32;
            values[place[row]] = value;
            place[row] += 1;
        }
        Self::from_parts(self.columns(), starts, row_indices, values)
    }

    /// The matrix diag(left) A diag(right); `left` has length `rows`, `right` has length `columns`.
    pub fn scaled(&self, left: &[f64], right: &[f64]) -> Self {
        self.with_values(self.triplets().map(|(row, column, value)| left[row] * value * right[column]).collect())
    }

    /// The rows listed in `kept` (increasing), as a matrix of `kept.len()` rows.
    pub fn select_rows(&self, kept: &[usize]) -> Self {
        let mut new_row = vec![None; self.rows];
        kept.iter().enumerate().for_each(|(new, &old)| new_row[old] = Some(new));
        self.select(kept.len(), |row| new_row[row], 0..self.columns())
    }

    /// The given columns, as a matrix of `rows` rows; `place` gives the new place of a row, increasing, or `None` to
    /// leave it out.
    pub fn select(
        &self,
        rows: usize,
        place: impl Fn(usize) -> Option<usize>,
        columns: impl Iterator<Item = usize>,
    ) -> Self {
        let (mut starts, mut row_indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in columns {
            for (row, value) in self.column(column) {
                if let Some(row) = place(row) {
                    row_indices.push(row as u32);
                    values.push(value);
                }
            }
            starts.push(row_indices.len());
        }
        Self::from_parts(rows, starts, row_indices, values)
    }

    /// The entries `(second, first, product)` of b b' on and below the diagonal, for one column b.
    pub fn square(&self, column: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.column(column).flat_map(move |(first, a)| {
            let below = self.column(column).filter(move |entry| entry.0 >= first);
            below.map(move |(second, b)| (second, first, a * b))
        })
    }
}

for_processor! {
    /// Adds the product A x to y; `entry` makes the entries of A.
    fn add_product['a, E: Fn(f64) -> f64](matrix: &'a SparseMatrix, x: &'a [f64], y: &'a mut [f64], entry: E) -> () {
        for (column, &at_column) in x.iter().enumerate().filter(|entry| *entry.1 != 0.0) {
            matrix.with_rows(column, y, |y, value| *y += entry(value) * at_column);
        }
    }
}

/// The rows of a matrix are numbered by 32 bits.
fn check_rows(rows: usize) -> Result<(), Error> {
    match u32::try_from(rows) {
        Ok(_) => Ok(()),
        Err(_) => Err(Error::Pattern { message: format!("a matrix has less than 2^32 rows; {rows} are too many") }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_with_the_last_rows_of_those_before_share_them() {
        // Two nodes of two dofs each that are coupled, an empty column, and a column with rows of its own.
        let rows = vec![0, 1, 2, 3, 1, 2, 3, 2, 3, 3, 1, 3];
        let values: Vec<f64> = (1..=12).map(f64::from).collect();
        let starts = vec![0, 4, 7, 9, 10, 10, 12];
        let matrix = SparseMatrix::from_parts(4, starts.clone(), rows.clone(), values);
        assert_eq!(matrix.pattern.rows, [0, 1, 2, 3, 1, 3]);
        assert!(matrix.row_indices().eq(rows) && matrix.column_starts() == starts);
        assert!(matrix.column(2).eq([(2, 8.0), (3, 9.0)]) && matrix.column(5).eq([(1, 11.0), (3, 12.0)]));
        let wider = matrix.with_empty(1);
        assert!(wider.column(3).eq([(3, 10.0)]) && wider.column(6).count() == 0);
    }
}
