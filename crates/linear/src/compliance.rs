//! Balances of forces with some rows held, by a dense factor `K = L L'` and the products of `W = L^-1 B'`.
//!
//! With the held rows C, the displacement and forces that take up a force r and distances d are
//!
//! ```text
//! K du - B_C' dl = r,     B_C du = d:     W_C'W_C dl = d - W_C' L^-1 r,     L' du = L^-1 r + W_C dl
//! ```
//!
//! W depends on neither load nor gap nor set: a set costs a factor of its own rows alone, and the bound of an answer
//! and its proof take the same W.

use std::sync::OnceLock;

use super::dense::{subtract, wide_dot};
use super::dense_factor;
use super::{Cholesky, LowerTriangle, SparseMatrix};

/// A held row that keeps less than this share of its compliance once the rows before it are held leaves too few digits.
const DEPENDENT: f64 = 1e-8;

/// Sets of closed rows until one is settled, each with a factor of `K + w B_C'B_C` otherwise.
const SETS: f64 = 5.0;

/// Multiplications of a factorisation in blocks that take the time of one product of two entries of a row, which is put
/// in its place.
const OF_PRODUCT: f64 = 10.0;

/// The rows B of a dense definite K, on the columns that its factor eliminates last.
#[derive(Clone, Debug)]
pub struct Compliance {
    cholesky: Cholesky,
    /// The last block of the factor: B is zero in all other columns, and so is W.
    block: LowerTriangle,
    /// The rows B on the last columns, each a column.
    by_row: SparseMatrix,
    halves: OnceLock<Halves>,
}

/// W (n x m, column by column), and the lower triangle of W'W (m x m, column by column).
#[derive(Clone, Debug)]
struct Halves {
    columns: Vec<f64>,
    products: Vec<f64>,
}

/// Some of the rows, held.
pub struct HeldRows<'a> {
    compliance: &'a Compliance,
    rows: Vec<usize>,
    /// The factor of their products.
    triangle: LowerTriangle,
}

impl Compliance {
    /// The rows B of the matrix K with this factor, which eliminates the columns of B last; `None` if the factor is not
    /// dense or not safely definite, or if factors of `K + w B_C'B_C` cost less.
    pub fn of(cholesky: &Cholesky, last: &[usize], rows: &SparseMatrix) -> Option<Self> {
        let (size, count) = (rows.columns() as f64, rows.rows() as f64);
        let own = size * size * count / 2.0 + size * count * count / 2.0;
        let mut lengths = vec![0.0; rows.rows()];
        (0..rows.columns()).for_each(|dof| rows.with_rows(dof, &mut lengths, |length, _| *length += 1.0));
        let products: f64 = lengths.iter().map(|length| length * length / 2.0).sum();
        let pays = own <= OF_PRODUCT * products + SETS * cholesky.multiplications();
        let is_last = !last.is_empty() || rows.entries() == 0;
        if !(cholesky.is_dense() && cholesky.is_safely_definite() && pays && is_last) {
            return None;
        }
        let by_row = match last.len() == rows.columns() {
            true => rows.transposed(),
            false => rows.select(rows.rows(), Some, last.iter().copied()).transposed(),
        };
        Some(Self::on(cholesky, by_row))
    }

    /// The same for any factor of K, given the rows, each a column, on the columns that it eliminates last.
    pub fn on(cholesky: &Cholesky, by_row: SparseMatrix) -> Self {
        let (cholesky, block) = (cholesky.clone(), cholesky.trailing_block());
        Compliance { cholesky, block, by_row, halves: OnceLock::new() }
    }

    pub fn bytes(&self) -> f64 {
        let [size, count] = [self.by_row.rows(), self.by_row.columns()].map(|count| count as f64);
        (self.cholesky.entries() as f64 + size * count + count * count) * size_of::<f64>() as f64
    }

    /// The rows, each a column, on the columns that are eliminated last.
    pub fn by_row(&self) -> &SparseMatrix {
        &self.by_row
    }

    fn halves(&self) -> &Halves {
        self.halves.get_or_init(|| {
            let (size, count) = (self.by_row.rows(), self.by_row.columns());
            let mut columns = vec![0.0; size * count];
            for (row, column) in columns.chunks_mut(size.max(1)).enumerate() {
                self.by_row.with_rows(row, column, |entry, value| *entry = value);
            }
            let columns = dense_factor::forward_all(&self.block, columns);
            Halves { products: dense_factor::products(size, &columns), columns }
        })
    }

    /// `L^-1 r` of a force r, length n.
    pub fn swept(&self, force: &[f64]) -> Vec<f64> {
        self.cholesky.forward(force)
    }

    /// The column of W of a row.
    pub fn half(&self, row: usize) -> &[f64] {
        let size = self.by_row.rows();
        &self.halves().columns[row * size..(row + 1) * size]
    }

    /// An entry of W'W.
    pub fn product(&self, a: usize, b: usize) -> f64 {
        self.halves().products[a.min(b) * self.by_row.columns() + a.max(b)]
    }

    /// These rows, increasing, held; `None` if some follow from others to a good part of the digits.
    pub fn held(&self, rows: Vec<usize>) -> Option<HeldRows<'_>> {
        let count = rows.len();
        let mut products = vec![0.0; count * count];
        let all = self.by_row.columns();
        for (j, &column) in rows.iter().enumerate() {
            let of_column = &self.halves().products[column * all..(column + 1) * all];
            let own = &mut products[j * count + j..(j + 1) * count];
            own.iter_mut().zip(&rows[j..]).for_each(|(product, &row)| *product = of_column[row]);
        }
        let triangle = dense_factor::factorise(count, products, 1).ok()?;
        let is_kept =
            |(place, &row): (usize, &usize)| triangle.diagonal(place).powi(2) > DEPENDENT * self.product(row, row);
        rows.iter().enumerate().all(is_kept).then_some(HeldRows { compliance: self, rows, triangle })
    }
}

impl HeldRows<'_> {
    /// The displacement, length n, and the force on each row, zero on rows that are not held, that take up the force
    /// with this [sweep](Compliance::swept), and put the held rows at their `distances`.
    pub fn solve(&self, mut swept: Vec<f64>, distances: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (cholesky, mut forces) = (&self.compliance.cholesky, vec![0.0; distances.len()]);
        if self.rows.is_empty() {
            return (cholesky.backward(swept), forces);
        }
        let half = |row: usize| self.compliance.half(row);
        let first = swept.len() - self.compliance.by_row.rows();
        let last = &mut swept[first..];
        let missing = self.rows.iter().map(|&row| distances[row] - wide_dot(half(row), last)).collect();
        let on_rows = self.triangle.backward(self.triangle.forward(missing));
        for (&row, force) in self.rows.iter().zip(on_rows) {
            subtract(last, -force, half(row));
            forces[row] = force;
        }
        (cholesky.backward(swept), forces)
    }
}
