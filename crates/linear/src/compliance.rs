//! Balances of forces with some rows held, by a dense factor `K = L L'` and the products of `W = L^-1 B'`.
//!
//! With the held rows C, the displacement and forces that take up a force r and distances d are
//!
//! ```text
//! K du - B_C' dl = r,     B_C du = d:     W_C'W_C dl = d - W_C' L^-1 r,     L' du = L^-1 r + W_C dl
//! ```
//!
//! W depends on neither load nor gap nor set: a set costs a factor of its own rows alone. The energy norm of a
//! certificate owns W, made from the given K and B; the methods and the path borrow it, and what they find with it is
//! checked by products with K and B.

use std::sync::OnceLock;

use super::dense::{subtract, wide_dot};
use super::{Cholesky, LowerTriangle, SparseMatrix, dot, factor};

/// A held row that keeps less than this share of its compliance once the rows before it are held leaves too few digits.
const DEPENDENT: f64 = 1e-8;

/// Sets of closed rows until one is settled, each with a factor of `K + w B_C'B_C` otherwise.
const SETS: f64 = 5.0;

/// Multiplications of a factorisation in blocks that take the time of one product of two entries of a row, which is put
/// in its place.
const OF_PRODUCT: f64 = 10.0;

/// Number of rows whose columns of W are made at once.
pub const AT_ONCE: usize = 128;

/// The rows B of a definite K with this factor. W is made as it is needed: of all rows together if it is kept for many
/// answers, and otherwise of the rows in question.
#[derive(Clone, Debug)]
pub struct Compliance {
    cholesky: Cholesky,
    /// The last block of the factor, if B is zero in all other columns, and so is W.
    block: Option<LowerTriangle>,
    /// The rows B on the columns of the block, each a column.
    by_row: SparseMatrix,
    /// W (n x m, column by column), and the lower triangle of W'W (m x m, column by column).
    all: OnceLock<[Vec<f64>; 2]>,
    /// The columns of W that were asked for, if not all rows are kept together.
    halves: Option<Vec<OnceLock<Vec<f64>>>>,
}

/// Some of the rows, held.
pub struct HeldRows<'a> {
    compliance: &'a Compliance,
    rows: Vec<usize>,
    /// The factor of their products.
    triangle: LowerTriangle,
}

impl Compliance {
    /// Returns `true` if balances of forces with held rows B cost less by W than by factors of `K + w B_C'B_C`: if the
    /// factor is dense and safely definite.
    pub fn pays(cholesky: &Cholesky, rows: &SparseMatrix) -> bool {
        let (size, count) = (rows.columns() as f64, rows.rows() as f64);
        let own = size * size * count / 2.0 + size * count * count / 2.0;
        let mut lengths = vec![0.0; rows.rows()];
        rows.row_indices().for_each(|row| lengths[row as usize] += 1.0);
        let products: f64 = lengths.iter().map(|length| length * length / 2.0).sum();
        let pays = own <= OF_PRODUCT * products + SETS * cholesky.multiplications();
        cholesky.is_dense() && cholesky.is_safely_definite() && pays
    }

    /// The rows, each a column, on the last columns of this factor, those of its `block`, or on all columns.
    pub fn new(cholesky: &Cholesky, block: Option<&LowerTriangle>, by_row: SparseMatrix) -> Self {
        let halves = Some(vec![OnceLock::new(); by_row.columns()]);
        Compliance { cholesky: cholesky.clone(), block: block.cloned(), by_row, all: OnceLock::new(), halves }
    }

    /// The same, for many answers.
    pub fn kept(&self) -> Self {
        Compliance { halves: None, ..self.clone() }
    }

    /// Returns `true` if there is nothing but the values.
    pub fn is_kept(&self) -> bool {
        self.halves.is_none()
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> f64 {
        let [size, count] = [self.by_row.rows(), self.by_row.columns()].map(|count| count as f64);
        (self.cholesky.entries() as f64 + size * count + count * count) * size_of::<f64>() as f64
    }

    /// The rows, each a column.
    pub fn by_row(&self) -> &SparseMatrix {
        &self.by_row
    }

    /// `L^-1 r` of a force r, length n.
    pub fn swept(&self, force: &[f64]) -> Vec<f64> {
        self.cholesky.forward(force)
    }

    /// The columns of W of some rows, in their order, which are not kept.
    pub fn columns(&self, rows: &[usize]) -> Vec<f64> {
        let size = self.by_row.rows();
        let mut columns = vec![0.0; size * rows.len()];
        for (column, &row) in columns.chunks_mut(size.max(1)).zip(rows) {
            self.by_row.with_rows(row, column, |entry, value| *entry = value);
        }
        match &self.block {
            Some(block) => factor::forward_all(block, columns),
            None => columns.chunks(size.max(1)).flat_map(|column| self.cholesky.forward(column)).collect(),
        }
    }

    fn all(&self) -> &[Vec<f64>; 2] {
        self.all.get_or_init(|| {
            let columns = self.columns(&(0..self.by_row.columns()).collect::<Vec<_>>());
            let products = factor::products(self.by_row.rows(), &columns);
            [columns, products]
        })
    }

    /// The columns of W of these rows, [`AT_ONCE`] at most, which are kept.
    pub fn find(&self, rows: &[usize]) {
        let Some(halves) = &self.halves else { return };
        let missing: Vec<usize> = rows.iter().copied().filter(|&row| halves[row].get().is_none()).collect();
        let columns = self.columns(&missing);
        let columns = columns.chunks(self.by_row.rows().max(1)).zip(missing);
        columns.for_each(|(column, row)| _ = halves[row].set(column.to_vec()));
    }

    /// The column of W of a row, with an entry for each contact dof in its order.
    pub fn half(&self, row: usize) -> &[f64] {
        let size = self.by_row.rows();
        let Some(halves) = &self.halves else { return &self.all()[0][row * size..(row + 1) * size] };
        halves[row].get_or_init(|| self.columns(&[row]))
    }

    /// An entry of W'W.
    pub fn product(&self, a: usize, b: usize) -> f64 {
        match self.halves {
            Some(_) => dot(self.half(a), self.half(b)),
            None => self.all()[1][a.min(b) * self.by_row.columns() + a.max(b)],
        }
    }

    /// The lower triangle of W'W of these rows in their order; `None` if it `is_over` before.
    pub fn products(&self, rows: &[usize], is_over: impl Fn() -> bool) -> Option<Vec<f64>> {
        if self.is_kept() {
            let mut products = vec![0.0; rows.len() * rows.len()];
            for (j, (column, &b)) in products.chunks_mut(rows.len().max(1)).zip(rows).enumerate() {
                column[j..].iter_mut().zip(&rows[j..]).for_each(|(product, &a)| *product = self.product(a, b));
            }
            return Some(products);
        }
        let in_time = |some| if is_over() { None } else { Some(self.columns(some)) };
        let columns: Vec<Vec<f64>> = rows.chunks(AT_ONCE).map(in_time).collect::<Option<_>>()?;
        Some(factor::products(self.by_row.rows(), &columns.concat()))
    }

    /// W'W (m x m), column by column, in the order of the rows.
    pub fn matrix(&self) -> Vec<f64> {
        let all = 0..self.by_row.columns();
        all.clone().flat_map(|j| all.clone().map(move |i| self.product(i, j))).collect()
    }

    /// These rows, increasing, held; `None` if some follow from others to a good part of the digits.
    pub fn held(&self, rows: Vec<usize>) -> Option<HeldRows<'_>> {
        let products = self.products(&rows, || false)?;
        let triangle = factor::factorised_densely(rows.len(), products, 1).ok()?;
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
