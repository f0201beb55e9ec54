//! Is a matrix positive definite, or did rounding let a singular one pass its Cholesky factorisation?

use super::{Cholesky, SymmetricMatrix, largest};

/// On a diagonal of order one, a smallest pivot above this leaves no doubt; below it the smallest eigenvalue is looked at.
const SAFE_PIVOT: f64 = 1e-9;

/// `norm(A x)` of a null vector x is rounding: this many units in the last place of the terms that cancel.
pub(super) const NULL_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Steps of inverse iteration: each gains several digits, since eigenvalues differ by many orders of magnitude.
const STEPS: usize = 5;

impl Cholesky {
    /// Is a matrix with a diagonal of order one definite beyond doubt, by the pivots of this factor alone?
    pub fn is_safely_definite(&self) -> bool {
        self.smallest_pivot() > SAFE_PIVOT
    }

    /// Is `matrix`, whose diagonal is of order one and whose factor this is, definite beyond rounding?
    pub fn is_definite(&self, matrix: &SymmetricMatrix) -> bool {
        if self.is_safely_definite() {
            return true;
        }
        let softest = self.softest_vector();
        largest(&matrix.mul(&softest)) > NULL_ROUNDING * largest(&matrix.mul_abs(&softest))
    }

    /// The vector that the matrix resists least, largest entry one, by inverse iteration.
    pub fn softest_vector(&self) -> Vec<f64> {
        // A start without symmetry, the same in every run.
        let golden = 0.618_033_988_749_895;
        let mut x: Vec<f64> = (0..self.dim()).map(|i| 0.5 + (i as f64 * golden).fract()).collect();
        for _ in 0..STEPS {
            x = self.solve(&x);
            let size = largest(&x);
            x.iter_mut().for_each(|value| *value /= size);
        }
        x
    }
}
