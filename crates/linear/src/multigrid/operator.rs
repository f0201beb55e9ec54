//! The matrix of a level, in all dofs or in a face.

use super::blocks::BlockMatrix;
use super::half;
use super::held::Held;
use super::repeated;
use crate::Spare;
use crate::real::Real;

/// A matrix A minus the change by a face: on the finest level the face is the range of E = I - N, on coarser ones A
/// becomes A - C.
#[derive(Clone, Copy, Debug)]
pub struct Operator<'a, T> {
    /// A.
    pub matrix: &'a BlockMatrix<T>,
    /// The projection N of the face on the finest level; `None` on coarser ones and without a face.
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

    /// Number of unknowns of the level: its nodes times the dofs of a node.
    pub fn dim(&self) -> usize {
        self.matrix.rows() * self.matrix.height
    }

    /// The force of an `x` in the face.
    pub fn mul_into(&self, x: &[T], y: &mut [T]) {
        y.fill(T::default());
        self.add_product(1.0, x, y);
    }

    /// `y += sign A x` for forces `y` and an `x` in the face.
    pub fn add_product(&self, sign: f64, x: &[T], y: &mut [T]) {
        if self.matrix.is_half {
            half::add_product(self.matrix, sign, x, y, self.threads, self.spare);
        } else if !self.matrix.is_shared() {
            self.matrix.add_product(sign, x, y, self.threads);
        } else {
            repeated::add_product(self.matrix, sign, x, y, self.threads, self.spare);
        }
        if let Some(change) = self.change {
            change.add_few_products(x, y, -sign);
        }
        if let Some(held) = self.held {
            held.project_force(y);
        }
    }

    /// The Rayleigh quotient of M A at x in the energy product, in which it is symmetric, and M A x; `moved` makes that
    /// of A x. `None` without positive energy.
    pub fn quotient(&self, x: &[T], moved: impl FnOnce(&[T]) -> Vec<T>) -> Option<(f64, Vec<T>)> {
        let mut force = self.spare.take(x.len());
        self.mul_into(x, &mut force);
        let moved = moved(&force);
        let product = |x: &[T]| x.iter().zip(&force).map(|(x, force)| x.double() * force.double()).sum::<f64>();
        let (energy, dual) = (product(x), product(&moved));
        self.spare.give(force);
        (energy > 0.0 && dual.is_finite()).then(|| (dual / energy, moved))
    }

    /// Brings a displacement into the face.
    pub fn project(&self, x: &mut [T]) {
        if let Some(held) = self.held {
            held.project(x);
        }
    }

    /// `y += x`.
    pub fn add(&self, x: &[T], y: &mut [T]) {
        let height = self.matrix.height;
        self.matrix.shared(self.threads).with_vectors(height, [y], |rows, [y]| {
            y.iter_mut().zip(&x[rows.start * height..]).for_each(|(y, &x)| *y += x);
        });
    }
}
