//! The diagonal of the stiffness, the scale of forces and couplings.

use crate::linear::SymmetricMatrix;

/// The diagonal of K.
#[derive(Clone, Debug)]
pub(crate) struct Diagonal {
    /// K_ii of each dof.
    pub values: Vec<f64>,
    /// `sqrt(K_ii)` of each dof.
    pub roots: Vec<f64>,
}

impl Diagonal {
    pub fn of(stiffness: &SymmetricMatrix) -> Self {
        let values = stiffness.diagonal();
        Diagonal { roots: values.iter().map(|value| value.sqrt()).collect(), values }
    }
}
