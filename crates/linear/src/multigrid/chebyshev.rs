//! The smoother: Chebyshev polynomials of the fourth kind in D^-1 A, D the diagonal blocks, or D^-1 the sum of the
//! inverses on patches.

use std::sync::Arc;

use super::blocks::BlockMatrix;
use super::operator::Operator;
use super::patches::{Patches, invert};
use super::repeated::RowByRow;
use crate::Spare;
use crate::real::{Real, power_iteration};

/// Degree of the polynomial, before and after the coarse correction.
const DEGREE: usize = 3;

/// Products that estimate the largest eigenvalue of D^-1 A.
const POWER_STEPS: usize = 12;

/// Safety factor of the estimate, which is a lower bound.
const SAFETY: f64 = 1.1;

/// Factor by which a change of a matrix on few rows may increase the largest eigenvalue.
const CHANGED: f64 = 1.15;

/// A diagonal entry reduced below this many units in the last place has lost its digits, because the face reduces it on
/// this level and on those above.
pub(super) const LOST_DIAGONAL: f64 = 3000.0;

/// A symmetric smoother of a fixed degree.
///
/// # Source
/// J. Lottes, *Optimal polynomial smoothers for multigrid V-cycles*, Numer. Linear Algebra Appl. 30 (2023) e2518,
/// algorithm 3.
#[derive(Clone, Debug)]
pub struct Chebyshev<T> {
    pub degree: usize,
    /// D^-1.
    pub inverse: BlockMatrix<T>,
    /// The patches of which D^-1 is the sum of the inverses; `None` if D are the diagonal blocks.
    patches: Option<Arc<Patches>>,
    /// Upper bound on the eigenvalues of D^-1 A.
    pub largest: f64,
}

impl<T: Real> Chebyshev<T> {
    /// The smoother of `matrix` by its diagonal blocks, or by the sum of the inverses on `patches`.
    pub fn new(matrix: &BlockMatrix<T>, patches: Option<Patches>, threads: usize) -> Self {
        let of_patches = patches.as_ref().map(|patches| patches.inverse(matrix, None, threads));
        let inverse = of_patches.unwrap_or_else(|| inverse_diagonal(matrix));
        let mut smoother = Chebyshev { degree: DEGREE, inverse, patches: patches.map(Arc::new), largest: 1.0 };
        smoother.largest = SAFETY * smoother.largest_eigenvalue(matrix, threads);
        smoother
    }

    pub fn has_patches(&self) -> bool {
        self.patches.is_some()
    }

    /// Improves `x` with the residual `rest` = b - A x. Returns the last step, which the residual does not contain yet:
    /// that saves a product if it is not used any more.
    pub fn smooth(&self, operator: &Operator<T>, x: &mut [T], rest: &mut [T]) -> Vec<T> {
        let mut step = operator.spare.zeros(x.len());
        for k in 1..=self.degree {
            self.inverse.step(rest, self.weights(k), [&mut step, x], operator.threads);
            // The sum x is brought into the face at the end.
            operator.project(&mut step);
            if k < self.degree {
                operator.add_product(-1.0, &step, rest);
            }
        }
        operator.project(x);
        step
    }

    /// The weights of step k, from 1 on: that of the last step, and that of `D^-1 r`.
    pub fn weights(&self, k: usize) -> (f64, f64) {
        let k = k as f64;
        ((2.0 * k - 3.0) / (2.0 * k + 1.0), (8.0 * k - 4.0) / (2.0 * k + 1.0) / self.largest)
    }

    /// The same smoother for the matrix minus `change`; blocks and patches in which `change` has no diagonal block are
    /// kept.
    pub fn changed(&self, matrix: &BlockMatrix<T>, change: &BlockMatrix<T>) -> Self {
        let largest = CHANGED * self.largest;
        if let Some(patches) = &self.patches {
            let touched = patches.touched_by(change);
            let [old, new] = [None, Some(change)].map(|change| touched.inverse(matrix, change, 1));
            let inverse = self.inverse.plus(1.0, &new.plus(-1.0, &old));
            return Chebyshev { inverse, patches: self.patches.clone(), largest, degree: self.degree };
        }
        let size = matrix.height;
        let mut smoother = Chebyshev { largest, ..self.clone() };
        let (mut work, mut result) = (vec![0.0; size * size], vec![0.0; size * size]);
        for node in 0..matrix.rows() {
            let (Some(own), Some(changed)) = (matrix.diagonal_place(node), change.diagonal_place(node)) else {
                continue;
            };
            let (own, changed) = (matrix.block(own), change.block(changed));
            let both = own.iter().zip(changed).map(|(own, changed)| own.double() - changed.double());
            work.iter_mut().zip(both).for_each(|(work, left)| *work = left);
            for i in 0..size {
                if work[i * size + i] <= LOST_DIAGONAL * T::EPSILON * own[i * size + i].double() {
                    (0..size).for_each(|j| (work[i * size + j], work[j * size + i]) = (0.0, 0.0));
                }
            }
            invert(&mut work, size, &mut result);
            let values: Vec<T> = result.iter().map(|&value| T::of(value)).collect();
            smoother.inverse.replace_diagonal(node, &values);
        }
        smoother
    }

    /// The same smoother with the largest eigenvalue measured where `change` has changed the matrix, if that is larger.
    pub fn measured(mut self, matrix: &BlockMatrix<T>, change: &BlockMatrix<T>, threads: usize) -> Self {
        let is_filled = |row: usize| change.starts[row] < change.starts[row + 1];
        let near = matrix.with_rows(change.filled_rows());
        let near = near.filtered(|row, column, _| is_filled(row) && is_filled(column)).plus(-1.0, change);
        self.largest = self.largest.max(SAFETY * self.largest_eigenvalue(&near, threads));
        self
    }

    fn largest_eigenvalue(&self, matrix: &BlockMatrix<T>, threads: usize) -> f64 {
        let spare = Spare::default();
        let operator = Operator::whole(matrix, threads, &spare);
        let mut estimate = 1.0;
        power_iteration(operator.dim(), -0.5, POWER_STEPS, |x| {
            let (found, moved) = operator.quotient(x, |force| {
                let mut moved = spare.zeros(force.len());
                self.inverse.add_product(1.0, force, &mut moved, threads);
                moved
            })?;
            estimate = found;
            Some(moved)
        });
        estimate
    }
}

fn inverse_diagonal<T: Real>(matrix: &BlockMatrix<T>) -> BlockMatrix<T> {
    let size = matrix.height;
    let mut inverse = RowByRow::new(size, matrix.rows());
    let (mut work, mut result, mut values) = (vec![0.0; size * size], vec![0.0; size * size], Vec::new());
    for node in 0..matrix.rows() {
        if node > 0 && matrix.is_shared() && matrix.shared_rows[node - 1] == matrix.shared_rows[node] {
            inverse.repeat(node - 1);
            continue;
        }
        match matrix.diagonal_place(node) {
            Some(place) => work.iter_mut().zip(matrix.block(place)).for_each(|(work, value)| *work = value.double()),
            None => work.fill(0.0),
        }
        invert(&mut work, size, &mut result);
        values.clear();
        values.extend(result.iter().map(|&value| T::of(value)));
        inverse.push(&[node as u32], &values);
    }
    inverse.finished()
}
