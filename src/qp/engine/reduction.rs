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
    /// The energy norm, where the stiffness is definite by itself.
    pub norm: Option<EnergyNorm>,
    pub condensation: Option<Condensation>,
}
