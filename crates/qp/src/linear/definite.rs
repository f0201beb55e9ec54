//! Distinguishes a positive definite matrix from a singular one that passed its Cholesky factorisation by rounding.

use super::power_iteration::power_iteration;
use super::{Cholesky, Equilibration, FactorError, SymmetricMatrix, largest};

/// On a diagonal of order one, a smallest pivot above this leaves no doubt; below it the smallest eigenvalue is
/// computed.
const SAFE_PIVOT: f64 = 1e-9;

/// `norm(A x)` of a null vector x is rounding: up to this many units in the last place of the terms that cancel.
pub(super) const NULL_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Steps of inverse iteration: each gains several digits, since eigenvalues differ by many orders of magnitude.
const STEPS: usize = 5;

/// On a diagonal of order one, a negative eigenvalue above this, or above this for each column, is rounding of the
/// entries and of the factor.
const LEAST_NEGATIVE: f64 = 1e-12;
const NEGATIVE_BY_COLUMN: f64 = 8.0 * f64::EPSILON;

impl Cholesky {
    /// Returns `true` if the pivots of this factor alone show that the matrix, with a diagonal of order one, is
    /// definite.
    pub fn is_safely_definite(&self) -> bool {
        self.smallest_pivot() > SAFE_PIVOT
    }

    /// Returns `true` if `matrix`, with a diagonal of order one and with this factor, is definite beyond rounding.
    pub fn is_definite(&self, matrix: &SymmetricMatrix) -> bool {
        if self.is_safely_definite() {
            return true;
        }
        let softest = self.softest_vector();
        largest(&matrix.mul(&softest)) > NULL_ROUNDING * largest(&matrix.mul_abs(&softest))
    }

    /// The vector with the least energy, largest entry one, by inverse iteration.
    pub fn softest_vector(&self) -> Vec<f64> {
        power_iteration(self.dim(), 0.5, STEPS, |x| {
            *x = self.solve(x);
            true
        })
    }
}

impl SymmetricMatrix {
    /// Returns `true` if the matrix is positive semidefinite, to rounding: its equilibrated form plus a small multiple
    /// of the unit matrix has a factor.
    pub(crate) fn is_semidefinite(&self) -> Result<bool, FactorError> {
        let diagonal = self.diagonal();
        let has_none = |dof: usize| diagonal[dof] == 0.0;
        let is_free = |row: usize, column: usize| row != column && (has_none(row) || has_none(column));
        if diagonal.iter().any(|&value| value < 0.0)
            || self.lower().triplets().any(|(row, column, value)| value != 0.0 && is_free(row, column))
        {
            return Ok(false);
        }
        let shift = LEAST_NEGATIVE.max(NEGATIVE_BY_COLUMN * self.dim() as f64);
        Ok(Equilibration::of(self).apply(self).shifted_factor(shift)?.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::super::SparseMatrix;
    use super::*;

    fn is_semidefinite(diagonal: [f64; 2], coupling: f64) -> bool {
        let entries = [(0, 0, diagonal[0]), (1, 0, coupling), (1, 1, diagonal[1])];
        let lower = SparseMatrix::from_triplets(2, 2, &entries).unwrap();
        SymmetricMatrix::from_lower(lower).unwrap().is_semidefinite().unwrap()
    }

    #[test]
    fn a_negative_eigenvalue_is_told_from_none() {
        assert!(is_semidefinite([1e-20, 1e20], 1.0));
        assert!(is_semidefinite([0.0, 1.0], 0.0));
        assert!(!is_semidefinite([1e-20, 1e20], 1.0 + 1e-9));
        assert!(!is_semidefinite([0.0, 1.0], 1e-100));
        assert!(!is_semidefinite([-1e-100, 1.0], 0.0));
    }
}
