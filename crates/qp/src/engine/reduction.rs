//! A problem reduced to the unknowns of the methods.

use crate::certificate::EnergyNorm;
use crate::linear::{Analysis, Compliance};
use crate::transform::{Condensation, RowSelection, Scaling};

/// Rows selected, data scaled, the stiffness factorised, and condensed if that pays; independent of load and gaps.
#[derive(Clone, Debug)]
pub(super) struct Reduction {
    pub selection: RowSelection,
    pub scaling: Scaling,
    /// The largest diagonal entry of the stiffness.
    pub stiffest: f64,
    pub norm: Norm,
    pub condensation: Option<Condensation>,
}

#[derive(Clone, Debug)]
pub(super) enum Norm {
    /// The stiffness is not definite by itself.
    Missing,
    Kept(EnergyNorm),
    /// Memory is too short to keep the factor: it is made from this analysis at every use.
    Again(Analysis),
}

impl Reduction {
    pub fn is_definite(&self) -> bool {
        !matches!(self.norm, Norm::Missing)
    }

    /// The compliance of the rows, if the energy norm has one: balances by it then cost less than by factors of the
    /// augmented matrix.
    pub fn compliance(&self) -> Option<&Compliance> {
        if let Norm::Kept(norm) = &self.norm { norm.compliance() } else { None }
    }

    /// Returns `true` if the energy norm costs no factorisation.
    pub fn is_norm_at_hand(&self) -> bool {
        !matches!(self.norm, Norm::Again(_))
    }

    /// The energy norm, if the stiffness is definite by itself; `None` also if there is no memory to make it again.
    pub fn norm(&self) -> Option<EnergyNorm> {
        match &self.norm {
            Norm::Missing => None,
            Norm::Kept(norm) => Some(norm.clone()),
            Norm::Again(analysis) => {
                let factor = analysis.factor(self.scaling.stiffness()).ok()?;
                Some(EnergyNorm::new(factor, self.scaling.equilibration.clone(), Vec::new()))
            }
        }
    }
}
