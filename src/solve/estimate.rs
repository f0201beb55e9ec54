//! What the direct and the iterative path will cost, from the size of a problem alone.

use super::Settings;
use crate::error::{Error, memory};
use crate::problem::ContactProblem;

/// Rigid motions of a body in space: its factor grows faster than that of a plane body.
const MOTIONS_IN_SPACE: usize = 6;

/// The direct path is exact and its bound proven: it is left only where it takes so many times as long. In space that is
/// beyond some 160,000 dofs.
const CLEARLY: f64 = 20.0;

/// An estimate may be so many times too large.
const UNSURE: f64 = 2.0;

/// Estimated time and memory of the two paths.
///
/// Calibrated on blocks of Q4 and Hex8 (`cargo run --release --example multigrid`); good to a factor of two or so, since
/// the shape of a body and the degree of its mesh count as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Bytes of the direct path at its peak, the problem itself included.
    pub direct_bytes: f64,
    /// Seconds of the factorisation on one processor of 2024.
    pub direct_seconds: f64,
    /// Bytes of the iterative path at its peak, the problem itself included.
    pub multigrid_bytes: f64,
    /// Seconds of hierarchy and iteration.
    pub multigrid_seconds: f64,
    knows_motions: bool,
}

/// The path that is taken, and why it is not the direct one.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Choice {
    /// The direct path.
    Factor,
    /// Multigrid: it is much the faster.
    Speed { reason: String },
    /// Multigrid: nothing else fits into the memory.
    Room { reason: String },
}

impl Estimate {
    /// The estimate for `problem`; its near-null space tells whether it is a body in space.
    pub fn of(problem: &ContactProblem) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let in_space = problem.near_null().is_some_and(|near_null| near_null.count() >= MOTIONS_IN_SPACE);
        let (factor, seconds) = match in_space {
            true => (23.0 * dofs.powf(4.0 / 3.0), 6.5e-10 * dofs.powi(2)),
            false => (6.0 * dofs * dofs.max(2.0).log2(), 3.7e-9 * dofs.powf(1.5)),
        };
        Estimate {
            direct_bytes: START + 9.2 * factor + 80.0 * entries,
            direct_seconds: seconds,
            multigrid_bytes: START + 100.0 * dofs + 40.0 * entries,
            multigrid_seconds: 1.3e-7 * entries,
            knows_motions: problem.near_null().is_some(),
        }
    }

    /// Is the iterative path the better one: much the faster, or the only one within `most_bytes`?
    pub fn prefers_multigrid(&self, most_bytes: f64) -> bool {
        !matches!(self.choose(most_bytes), Ok(Choice::Factor) | Err(_))
    }

    /// The path to take within `most_bytes`; whether a factor fits that is not clearly too large, its analysis tells.
    ///
    /// # Errors
    /// [`Error::NoRoom`] where neither fits.
    pub(super) fn choose(&self, most_bytes: f64) -> Result<Choice, Error> {
        let ratio = self.direct_seconds / self.multigrid_seconds;
        // Constants alone make a poor hierarchy of a body.
        if ratio > CLEARLY && self.knows_motions && self.multigrid_bytes <= most_bytes {
            let reason = format!("by multigrid: a factorisation would take about {ratio:.0} times as long");
            return Ok(Choice::Speed { reason });
        }
        if self.direct_bytes > UNSURE * most_bytes {
            return self.without_factor(self.direct_bytes, most_bytes).map(|reason| Choice::Room { reason });
        }
        Ok(Choice::Factor)
    }

    /// Why multigrid is taken where a solve with a factor takes `factor` bytes, and that is too much.
    ///
    /// # Errors
    /// [`Error::NoRoom`] where multigrid takes too much as well.
    pub(super) fn without_factor(&self, factor: f64, most_bytes: f64) -> Result<String, Error> {
        let multigrid = self.multigrid_bytes;
        if multigrid > most_bytes {
            return Err(Error::NoRoom { factor, multigrid, allowed: most_bytes });
        }
        let [of_multigrid, of_factor, allowed] = [multigrid, factor, most_bytes].map(memory);
        Ok(format!(
            "by multigrid, of about {of_multigrid}: with a factor it would take about {of_factor}, {allowed} are allowed"
        ))
    }
}

/// Bytes of a program that does nothing yet.
const START: f64 = 9e6;

/// Bytes of an unknown: loads, displacements, residuals.
const OF_DOF: f64 = 120.0;

/// Bytes of an entry of the stiffness, both triangles: its file, itself, scaled, ordered, and in the graph of the ordering.
const OF_ENTRY: f64 = 32.0;

/// Bytes of a value of a dense matrix on the contact dofs, of which a method keeps several.
const OF_DENSE: f64 = 80.0;

/// Workspace of a factorisation, beside its factor.
const WORKSPACE: f64 = 1.15;

/// What a solve keeps beside the problem.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kept {
    /// The factor of the body, with so many values, and dense matrices on so many contact dofs.
    Condensed { values: usize, is_single: bool, contact_dofs: usize },
    /// The factor of the body, with so many values, and those of two contact sets.
    Factors { values: usize },
    /// A hierarchy instead of a factor.
    Multigrid,
}

/// Refuses a problem that would take more memory than `settings` allow.
///
/// # Errors
/// [`Error::TooLarge`].
pub(super) fn check_memory(problem: &ContactProblem, kept: Kept, settings: &Settings) -> Result<(), Error> {
    let Some(allowed) = settings.memory else { return Ok(()) };
    let (dofs, lower) = (problem.dofs() as f64, problem.stiffness().lower().entries() as f64);
    let stiffness_entries = 2.0 * lower - dofs;
    let of_problem = START + OF_DOF * dofs + OF_ENTRY * stiffness_entries;
    let (factor_entries, bytes) = match kept {
        Kept::Condensed { values, is_single, contact_dofs } => {
            let bytes = if is_single { size_of::<f32>() } else { size_of::<f64>() };
            let factor = WORKSPACE * bytes as f64 * values as f64;
            (values as f64, of_problem + factor + OF_DENSE * (contact_dofs as f64).powi(2))
        }
        Kept::Factors { values } => {
            (values as f64, of_problem + 3.0 * WORKSPACE * size_of::<f64>() as f64 * values as f64)
        }
        Kept::Multigrid => (0.0, Estimate::of(problem).multigrid_bytes),
    };
    if bytes > allowed {
        return Err(Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed });
    }
    Ok(())
}
