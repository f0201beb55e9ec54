//! The matrix of a level, in all dofs or in a face.

use std::ops::Range;

use super::blocks::BlockMatrix;
use super::half;
use super::held::Held;
use super::repeated;
use crate::linear::Spare;
use crate::linear::factor::Real;

/// A matrix A minus the change by a face: on the finest level the face is the range of E = I - N, on coarser ones A becomes A - C.
#[derive(Clone, Copy, Debug)]
pub struct Operator<'a, T> {
    /// A.
    pub matrix: &'a BlockMatrix<T>,
    /// N.
    pub held: Option<&'a Held<T>>,
    /// C.
    pub change: Option<&'a BlockMatrix<T>>,
    /// Threads of a product.
    pub threads: usize,
    /// Its work vectors.
    pub spare: &'a Spare<T>,
}

impl<'a, T: Real> Operator<'a, T> {
    /// The matrix in all dofs.
    pub fn whole(matrix: &'a BlockMatrix<T>, threads: usize, spare: &'a Spare<T>) -> Self {
        Operator { matrix, held: None, change: None, threads, spare }
    }

    /// Number of unknowns.
    pub fn dim(&self) -> usize {
        self.matrix.rows() * self.matrix.height
    }

    /// The force of an `x` in the face.
    pub fn mul_into(&self, x: &[T], y: &mut [T]) {
        if self.matrix.is_half {
            half::multiply(self.matrix, x, y, self.threads, self.spare);
        } else if self.matrix.shared_rows.is_empty() {
            self.matrix.mul_into(x, y, self.threads);
        } else {
            repeated::multiply(self.matrix, x, y, self.threads, self.spare);
        }
        if let Some(change) = self.change {
            change.subtract_product(x, y);
        }
        if let Some(held) = self.held {
            held.project_force(y);
        }
    }

    /// `y -= A x` with an `x` in the face.
    pub fn subtract_product(&self, x: &[T], y: &mut [T]) {
        let mut product = self.spare.take(y.len());
        self.mul_into(x, &mut product);
        self.subtract(&product, y);
        self.spare.give(product);
    }

    /// Brings a displacement into the face.
    pub fn project(&self, x: &mut [T]) {
        if let Some(held) = self.held {
            held.project(x);
        }
    }

    /// `y += x`.
    pub fn add(&self, x: &[T], y: &mut [T]) {
        self.in_chunks([y], |range, [y]| y.iter_mut().zip(&x[range]).for_each(|(y, &x)| *y += x));
    }

    /// `y -= x`.
    pub fn subtract(&self, x: &[T], y: &mut [T]) {
        self.in_chunks([y], |range, [y]| y.iter_mut().zip(&x[range]).for_each(|(y, &x)| *y -= x));
    }

    /// Runs `work` on runs of unknowns, whole nodes each, with the matching parts of the vectors `ys`.
    pub fn in_chunks<const N: usize>(&self, ys: [&mut [T]; N], work: impl Fn(Range<usize>, [&mut [T]; N]) + Sync) {
        let height = self.matrix.height;
        self.matrix.shared(self.threads).with_vectors(height, ys, |rows, parts| {
            work(rows.start * height..rows.end * height, parts);
        });
    }
}
