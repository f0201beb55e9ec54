//! The matrix of a level, in all dofs or in a face of them.

use super::blocks::BlockMatrix;
use super::real::Real;

/// A matrix A less what a face changes: on the finest level the face is the range of I - Q, on coarser ones A becomes
/// A - C.
#[derive(Clone, Copy, Debug)]
pub struct Operator<'a, T> {
    /// A.
    pub matrix: &'a BlockMatrix<T>,
    /// Q, the projection onto what is held.
    pub held: Option<&'a BlockMatrix<T>>,
    /// C.
    pub change: Option<&'a BlockMatrix<T>>,
    /// Threads of a product.
    pub threads: usize,
}

impl<'a, T: Real> Operator<'a, T> {
    /// The matrix in all dofs.
    pub fn whole(matrix: &'a BlockMatrix<T>, threads: usize) -> Self {
        Operator { matrix, held: None, change: None, threads }
    }

    /// Number of unknowns.
    pub fn dim(&self) -> usize {
        self.matrix.rows() * self.matrix.height
    }

    /// The product with an `x` in the face.
    pub fn mul_into(&self, x: &[T], y: &mut [T]) {
        self.matrix.mul_into(x, y, self.threads);
        if let Some(change) = self.change {
            change.subtract_product(x, y);
        }
        self.project(y);
    }

    /// Takes off what is held.
    pub fn project(&self, y: &mut [T]) {
        if let Some(held) = self.held {
            let before = y.to_vec();
            held.subtract_product(&before, y);
        }
    }
}
