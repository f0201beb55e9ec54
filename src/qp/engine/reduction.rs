//! A problem reduced to what the methods work on.

use crate::qp::certificate::EnergyNorm;
use crate::qp::transform::{Condensation, RowSelection, Scaling};

/// Rows selected, data scaled, the stiffness factorised and condensed where that pays; load and gaps play no part in it.
#[derive(Clone, Debug)]
pub(super) struct Reduction {
    pub selection: RowSelection,
    pub scaling: Scaling,
    /// The largest diagonal entry of the stiffness.
    pub stiffest: f64,
    /// Is the stiffness definite by itself?
    pub is_definite: bool,
    /// The energy norm of a definite stiffness; none if memory is too short to keep it.
    pub norm: Option<EnergyNorm>,
    pub condensation: Option<Condensation>,
}
