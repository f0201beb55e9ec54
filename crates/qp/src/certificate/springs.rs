//! Springs that make a singular stiffness definite.

use crate::error::Error;
use crate::linear::{SparseMatrix, SymmetricMatrix, ldexp};

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

    /// The same springs in other units of stiffness, `2^unit`.
    pub fn in_unit(&self, unit: i32) -> Self {
        let stiffness = self.stiffness.iter().map(|&value| ldexp(value, -unit)).collect();
        Springs { stiffness, are_equalities: self.are_equalities.clone() }
    }
}
