//! Springs that make a singular stiffness definite.

use crate::error::Error;
use crate::linear::{SparseMatrix, SymmetricMatrix, ldexp};
use crate::problem::Parts;

/// A row presses if its force could do more than this share of the energy norm of its part.
const PRESSING: f64 = 1e-8;

/// The least force with which a row presses that has this stiffness, on a part with the energy norm `size`.
pub(super) fn least_force(stiffness: f64, size: f64) -> f64 {
    PRESSING * stiffness.sqrt() * size
}

/// Springs D on rows C that press, or that are equalities: with them a singular K becomes `K_D = K + B_C' D B_C`.
#[derive(Clone, Debug)]
pub(super) struct Springs {
    /// D of each row, zero on rows without a spring.
    pub stiffness: Vec<f64>,
    /// The rows that are equalities: at their gaps they stay there, whatever their force.
    pub are_equalities: Vec<bool>,
}

impl Springs {
    /// `K + B_C' D B_C`; `None` if no row presses.
    ///
    /// # Errors
    /// As [`SymmetricMatrix::plus_squares`](crate::linear::SymmetricMatrix::plus_squares).
    pub fn added_to(
        &self,
        stiffness: &SymmetricMatrix,
        contact: &SparseMatrix,
    ) -> Result<Option<SymmetricMatrix>, Error> {
        let closed: Vec<usize> = (0..contact.rows()).filter(|&row| self.stiffness[row] > 0.0).collect();
        if closed.is_empty() {
            return Ok(None);
        }
        let weights: Vec<f64> = closed.iter().map(|&row| self.stiffness[row]).collect();
        stiffness.plus_squares(&contact.select_rows(&closed), &weights).map(Some)
    }

    /// `f + B' lambda - K_D u + B_C' D g_C`: the `residual` with springs of an answer with this `violation`.
    pub fn residual(&self, contact: &SparseMatrix, residual: &[f64], violation: &[f64]) -> Vec<f64> {
        let pull: Vec<f64> = (self.stiffness.iter().zip(violation))
            .map(|(&stiffness, &violation)| if stiffness > 0.0 { -stiffness * violation } else { 0.0 })
            .collect();
        residual.iter().zip(contact.mul_transposed(&pull)).map(|(r, spring)| r + spring).collect()
    }

    /// Returns `true` if every row with a spring is `closed`, and its certain force exceeds twice the force that
    /// `left(row)`, the dual norm of the forces left over on its part, could take off.
    pub fn hold(&self, closed: &[bool], certain_force: impl Fn(usize) -> f64, left: impl Fn(usize) -> f64) -> bool {
        let springs = self.stiffness.iter().enumerate().filter(|spring| *spring.1 != 0.0);
        let presses = |row: usize, stiffness: f64| certain_force(row) > 2.0 * stiffness.sqrt() * left(row);
        springs
            .into_iter()
            .all(|(row, &stiffness)| closed[row] && (self.are_equalities[row] || presses(row, stiffness)))
    }

    /// The least force with which each row presses on parts with the energy norms `sizes`: infinite without energy,
    /// which leaves no scale, and zero on equalities and rows without a spring.
    pub fn least_forces(&self, parts: &Parts, sizes: &[f64]) -> Vec<f64> {
        let least = |row: usize| match (self.stiffness[row], sizes[parts.of_row(row)]) {
            (stiffness, _) if stiffness == 0.0 || self.are_equalities[row] => 0.0,
            (_, 0.0) => f64::INFINITY,
            (stiffness, size) => least_force(stiffness, size),
        };
        (0..self.stiffness.len()).map(least).collect()
    }

    /// The same springs in other units of stiffness, `2^unit`.
    pub fn in_unit(&self, unit: i32) -> Self {
        let stiffness = self.stiffness.iter().map(|&value| ldexp(value, -unit)).collect();
        Springs { stiffness, are_equalities: self.are_equalities.clone() }
    }
}
