//! Balances of forces with some rows held, by a dense factor `K = L L'` and the products of `W = L^-1 B'`.
//!
//! With the held rows C, the displacement and forces that take up a force r and distances d are
//!
//! ```text
//! K du - B_C' dl = r,     B_C du = d:     W_C'W_C dl = d - W_C' L^-1 r,     L' du = L^-1 r + W_C dl
//! ```
//!
//! W depends on neither load nor gap nor set: a set costs a factor of its own rows alone.

use std::sync::OnceLock;

use super::dense::{subtract, wide_dot};
use super::dense_factor;
use super::{Cholesky, LowerTriangle, SparseMatrix};

/// A held row that keeps less than this share of its compliance once the rows before it are held leaves too few digits.
const DEPENDENT: f64 = 1e-8;

/// Sets of closed rows until one is settled, each with a factor of `K + w B_C'B_C` otherwise.
const SETS: f64 = 5.0;

/// Multiplications of a factorisation in blocks that take the time of one product of two entries of a row, which is put in its place.
const OF_PRODUCT: f64 = 10.0;

/// The rows B of a dense definite K.
#[derive(Clone, Debug)]
pub struct Compliance {
    cholesky: Cholesky,
    rows: SparseMatrix,
    halves: OnceLock<Halves>,
}

/// W, in the order of elimination (n x m, column by column), and the lower triangle of W'W (m x m, column by column).
#[derive(Clone, Debug)]
struct Halves {
    columns: Vec<f64>,
    products: Vec<f64>,
}

/// Some of the rows, held.
pub struct Held<'a> {
    compliance: &'a Compliance,
    rows: Vec<usize>,
    /// The factor of their products.
    triangle: LowerTriangle,
}

impl Compliance {
    /// The rows B of the matrix K with this factor; `None` if the factor is not dense or not safely definite, or if factors of
    /// `K + w B_C'B_C` cost less.
    pub fn of(cholesky: &Cholesky, rows: &SparseMatrix) -> Option<Self> {
        let (size, count) = (rows.columns() as f64, rows.rows() as f64);
        let own = size * size * count / 2.0 + size * count * count / 2.0;
        let mut lengths = vec![0.0; rows.rows()];
        rows.row_indices().iter().for_each(|&row| lengths[row as usize] += 1.0);
        let products: f64 = lengths.iter().map(|length| length * length / 2.0).sum();
        let pays = own <= OF_PRODUCT * products + SETS * cholesky.multiplications();
        let fits = cholesky.is_dense() && cholesky.is_safely_definite() && pays;
        fits.then(|| Compliance { cholesky: cholesky.clone(), rows: rows.clone(), halves: OnceLock::new() })
    }

    /// Memory of the values, in bytes.
    pub fn bytes(&self) -> f64 {
        let [size, count] = [self.rows.columns(), self.rows.rows()].map(|count| count as f64);
        (size * size + size * count + count * count) * size_of::<f64>() as f64
    }

    fn halves(&self) -> &Halves {
        self.halves.get_or_init(|| {
            let size = self.rows.columns();
            let mut columns = vec![0.0; size * self.rows.rows()];
            for (place, &column) in self.cholesky.order().iter().enumerate() {
                self.rows.column(column).for_each(|(row, value)| columns[row * size + place] += value);
            }
            let columns = self.cholesky.forward_ordered(columns);
            Halves { products: dense_factor::products(size, &columns), columns }
        })
    }

    /// These rows, held; `None` if some follow from others to a good part of the digits.
    pub fn held(&self, rows: Vec<usize>) -> Option<Held<'_>> {
        let (count, all) = (rows.len(), self.rows.rows());
        let mut products = vec![0.0; count * count];
        if count > 0 {
            let known = &self.halves().products;
            for (j, &column) in rows.iter().enumerate() {
                rows[j..]
                    .iter()
                    .enumerate()
                    .for_each(|(i, &row)| products[j * count + j + i] = known[column * all + row]);
            }
        }
        let own: Vec<f64> = (0..count).map(|row| products[row * count + row]).collect();
        let triangle = dense_factor::factorise(count, products, 1).ok()?;
        let is_kept = |(row, own): (usize, &f64)| triangle.diagonal(row).powi(2) > DEPENDENT * own;
        own.iter().enumerate().all(is_kept).then_some(Held { compliance: self, rows, triangle })
    }
}

impl Held<'_> {
    /// The displacement, length n, and the force on each held row, that take up the `force`, length n, and put the held rows at
    /// these `distances`.
    pub fn solve(&self, force: &[f64], distances: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let cholesky = &self.compliance.cholesky;
        let mut swept = cholesky.forward(force);
        if self.rows.is_empty() {
            return (cholesky.backward(swept), Vec::new());
        }
        let (columns, size) = (&self.compliance.halves().columns, swept.len());
        let half = |row: usize| &columns[row * size..(row + 1) * size];
        let missing =
            self.rows.iter().zip(distances).map(|(&row, distance)| distance - wide_dot(half(row), &swept)).collect();
        let on_rows = self.triangle.backward(self.triangle.forward(missing));
        self.rows.iter().zip(&on_rows).for_each(|(&row, &force)| subtract(&mut swept, -force, half(row)));
        (cholesky.backward(swept), on_rows)
    }
}
