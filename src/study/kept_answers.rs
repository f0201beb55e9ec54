//! The memory of the answers that a sweep keeps.

use crate::error::Error;
use crate::qp::Settings;
use crate::qp::cost::bytes;

/// The answers that a sweep keeps until its report: they leave less of the allowed memory to each solve.
pub(super) struct KeptAnswers {
    count: usize,
    dofs: usize,
    /// The allowed memory, in bytes; `None` if there is no limit.
    allowed: Option<f64>,
}

impl KeptAnswers {
    /// `count` answers with `dofs` unknowns each.
    pub fn of(count: usize, dofs: usize, settings: &Settings) -> Self {
        KeptAnswers { count, dofs, allowed: settings.memory }
    }

    fn bytes(&self) -> f64 {
        bytes::of_answers(self.count as f64, self.dofs as f64)
    }

    /// The settings of each solve.
    pub fn settings(&self, settings: &Settings) -> Settings {
        match self.allowed {
            Some(allowed) => settings.clone().with_memory((allowed - self.bytes()).max(1.0)),
            None => settings.clone(),
        }
    }

    /// The error of a solve under these settings, with the limit that was set: the answers are the reason if the solve alone fits.
    pub fn explain(&self, error: Error) -> Error {
        let Some(allowed) = self.allowed else { return error };
        let of_answers = |solve: f64| {
            let (count, dofs, kept) = (self.count, self.dofs, self.bytes());
            Error::TooManyAnswers { count, dofs, kept, solve, allowed }
        };
        match error {
            Error::TooLarge { bytes, .. } if bytes <= allowed => of_answers(bytes),
            Error::NoRoom { factor, multigrid, .. } if factor.min(multigrid) <= allowed => {
                of_answers(factor.min(multigrid))
            }
            Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, .. } => {
                Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed }
            }
            Error::NoRoom { factor, multigrid, ended, .. } => Error::NoRoom { factor, multigrid, allowed, ended },
            error => error,
        }
    }
}
