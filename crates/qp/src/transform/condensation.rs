//! Condensation onto the dofs that appear in the contact rows, by one Cholesky factorisation.
//!
//! With the contact dofs t ordered last in K = L L':
//!
//! ```text
//! S = K_tt - K_ti K_ii^-1 K_it = L_tt L_tt'      the stiffness that the contact boundary feels
//! y = L^-1 f,  f_c = L_tt y_t                     the load that reaches it
//! L' u = (y_i, L_tt' u_t)                         the way back to the whole body
//! ```
//!
//! A body that only its contact rows hold has a singular K. In that case `K + B'B` is factorised; its Schur complement
//! is `S + B_t'B_t`: the interior blocks, and so both sweeps, are the same.

use crate::error::{Error, LinearError};
use crate::linear::{Analysis, Cholesky, FactorError, LowerTriangle, SparseMatrix, SymmetricMatrix, dot};

/// If contact dofs exceed this share of all, condensing removes too little.
const LARGEST_SHARE: f64 = 0.25;

/// A dense factorisation on the contact dofs may cost this many times the estimate for the sparse one, which is low.
const DENSE_WORK: f64 = 3.0;

/// A difference below this share of its terms is rounding: the factorisation of a large body loses a few digits.
const LEFT_OVER: f64 = 1e-12;

/// The condensed stiffness, with the transform back to the whole body.
#[derive(Clone, Debug)]
pub struct Condensation {
    /// The contact dofs, in increasing order.
    pub contact_dofs: Vec<usize>,
    cholesky: Cholesky,
    trailing: LowerTriangle,
    pub stiffness: SymmetricMatrix,
    pub contact: SparseMatrix,
}

impl Condensation {
    /// The analysis of `stiffness` with the contact dofs last, or `None` if condensing onto this number of dofs does
    /// not pay.
    pub fn analyse(stiffness: &SymmetricMatrix, contact_dofs: &[usize]) -> Result<Option<Analysis>, FactorError> {
        let (dim, count) = (stiffness.dim() as f64, contact_dofs.len() as f64);
        if !Self::pays(count, dim, f64::INFINITY) {
            return Ok(None);
        }
        let analysis = Analysis::sparse_with_last(stiffness, contact_dofs)?;
        let interior_entries = (analysis.factor_entries() as f64 - count * count / 2.0).max(0.0);
        Ok(Self::pays(count, dim, interior_entries).then_some(analysis))
    }

    /// Returns `true` if the dense factorisation on `count` contact dofs of `dim` costs little beside that of the
    /// interior, whose factor has `interior_entries` values. Whether the dense matrices fit is a question of memory.
    pub fn pays(count: f64, dim: f64, interior_entries: f64) -> bool {
        // The work of the interior is at least the square of its entries over its columns.
        let interior_work = interior_entries * interior_entries / (dim - count);
        count > 0.0 && count <= LARGEST_SHARE * dim && count.powi(3) / 3.0 <= DENSE_WORK * interior_work
    }

    /// Condenses with a factorisation of K, or if it `holds_rows` of K + B'B, that put `contact_dofs` last; the rows
    /// are subtracted from the Schur complement.
    pub fn new(
        cholesky: Cholesky,
        holds_rows: bool,
        contact_dofs: Vec<usize>,
        contact: &SparseMatrix,
    ) -> Result<Self, Error> {
        let contact = contact.select(contact.rows(), Some, contact_dofs.iter().copied());
        let trailing = cholesky.trailing_block();
        let mut schur = trailing.times_transpose();
        if holds_rows {
            subtract_rows(&mut schur, &contact);
        }
        let stiffness = SymmetricMatrix::from_lower(dense_triangle(&schur, contact_dofs.len())?)?;
        Ok(Condensation { contact_dofs, cholesky, trailing, stiffness, contact })
    }

    /// Number of values of the factor of K, the contact dofs last.
    pub fn factor_entries(&self) -> usize {
        self.cholesky.entries()
    }

    /// The forward sweep y of a load, to be kept for [`load`](Self::load) and [`expand`](Self::expand).
    pub fn sweep(&self, load: &[f64]) -> Vec<f64> {
        // Many bodies are loaded by their obstacle alone.
        if load.iter().all(|&force| force == 0.0) { load.to_vec() } else { self.cholesky.forward(load) }
    }

    /// The condensed load L_tt y_t.
    pub fn load(&self, sweep: &[f64]) -> Vec<f64> {
        let size = self.contact_dofs.len();
        self.trailing.mul(&sweep[sweep.len() - size..])
    }

    /// The square of the energy norm that the load alone adds inside the body, for any displacement of the contact
    /// dofs.
    pub fn interior_energy(&self, sweep: &[f64]) -> f64 {
        let interior = &sweep[..sweep.len() - self.contact_dofs.len()];
        dot(interior, interior)
    }

    /// The displacement of the contact dofs that the load alone causes, if K is definite.
    pub fn free_displacement(&self, sweep: &[f64]) -> Vec<f64> {
        let size = self.contact_dofs.len();
        self.trailing.backward(sweep[sweep.len() - size..].to_vec())
    }

    /// The displacement of the whole body from that of the contact dofs.
    pub fn expand(&self, sweep: &[f64], displacement: &[f64]) -> Vec<f64> {
        let size = self.contact_dofs.len();
        let first = sweep.len() - size;
        let mut y = sweep.to_vec();
        y[first..].copy_from_slice(&self.trailing.mul_transposed(displacement));
        let mut expanded = self.cholesky.backward(y);
        // The sweep gives these values back except for rounding.
        self.contact_dofs.iter().zip(displacement).for_each(|(&dof, &u)| expanded[dof] = u);
        expanded
    }
}

/// Subtracts B'B from a dense lower triangle, column by column.
fn subtract_rows(schur: &mut [f64], contact: &SparseMatrix) {
    let (before, by_row) = (schur.to_vec(), contact.transposed());
    for (i, j, product) in (0..contact.rows()).flat_map(|row| by_row.square(row)) {
        schur[j * contact.columns() + i] -= product;
    }
    // The difference of equal terms is rounding, and would hold a body that nothing holds.
    for (entry, before) in schur.iter_mut().zip(&before) {
        if entry.abs() <= LEFT_OVER * before.abs() {
            *entry = 0.0;
        }
    }
}

/// The lower triangle of a dense matrix (n x n, column by column), zeros included.
fn dense_triangle(matrix: &[f64], size: usize) -> Result<SparseMatrix, Error> {
    let places = || (0..size).flat_map(|column| (column..size).map(move |row| (row, column)));
    let values: Vec<f64> = places().map(|(row, column)| matrix[column * size + row]).collect();
    if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
        let at = "the condensed stiffness".to_string();
        return Err(LinearError::NotFinite { name: "matrix", at, value, allowed: "finite" }.into());
    }
    let starts = (0..=size).map(|column| column * (2 * size - column + 1) / 2).collect();
    Ok(SparseMatrix::from_parts(size, starts, places().map(|(row, _)| row as u32).collect(), values))
}
