//! What a solve costs: the one model of seconds and bytes, and the limits that are held against it.

pub mod bytes;
pub(in crate::qp) mod seconds;

use super::linear::SymmetricMatrix;
use super::problem::ContactProblem;
use super::settings::Settings;
use crate::error::Error;
use crate::watch::Watch;
use seconds::factor_seconds;

/// Rigid-body modes of a body in space: its factor grows faster than that of a plane body.
const MOTIONS_IN_SPACE: usize = 6;

/// Values of the factor of a bar for an unknown, about.
const ALONG_A_LINE: f64 = 4.0;

/// Entries of the contact rows for a dof beyond which the contact boundary is most of the body.
const MANY: f64 = 0.25;

/// Sets of closed rows, each with a factor, until one is settled where contact is everywhere.
const SETS: f64 = 10.0;

/// Row sums of a stiffness may be negative by this share of the diagonal: rounding.
const ROW_SUM_ROUNDING: f64 = 1e-9;

/// Returns `true` for a stiffness like that of a scalar diffusion: no positive entry off the diagonal, no negative row sum. Its
/// smooth displacements are the constants.
fn is_diffusion(stiffness: &SymmetricMatrix) -> bool {
    let mut sums = stiffness.diagonal();
    for (row, column, value) in stiffness.lower().triplets().filter(|entry| entry.0 != entry.1) {
        if value > 0.0 {
            return false;
        }
        sums[row] += value;
        sums[column] += value;
    }
    sums.iter().zip(stiffness.diagonal()).all(|(&sum, own)| sum >= -ROW_SUM_ROUNDING * own)
}

/// Estimated time and memory of the two paths.
///
/// Calibrated on blocks of Q4 and Hex8 (`cargo run --release --example multigrid`); good to a factor of two or so, since
/// the shape of a body and the degree of its mesh count as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Bytes of the direct path at its peak, the problem itself included.
    pub direct_bytes: f64,
    /// Values of the factor.
    pub factor_entries: f64,
    /// Seconds of the factorisations on one processor of 2024.
    pub direct_seconds: f64,
    /// Bytes of the iterative path at its peak, the problem itself included.
    pub multigrid_bytes: f64,
    /// Seconds of hierarchy and iteration.
    pub multigrid_seconds: f64,
    /// Seconds of the hierarchy alone.
    pub hierarchy_seconds: f64,
    /// Factorisations of one solve: the first serves all gaps, the others are those of its contact sets.
    pub(super) factors: f64,
    /// Does a hierarchy know what costs next to no energy: are the rigid-body modes given, or do constants suffice?
    pub(super) suits_multigrid: bool,
}

impl Estimate {
    /// The estimate for `problem`; its near-null space tells whether it is a bar or a body in space.
    pub fn of(problem: &ContactProblem) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let motions = problem.near_null().map(|near_null| near_null.count());
        let (factor, seconds) = match motions {
            Some(1) => (ALONG_A_LINE * dofs, factor_seconds(0.0, (ALONG_A_LINE * dofs) as usize)[0]),
            Some(MOTIONS_IN_SPACE..) => (23.0 * dofs.powf(4.0 / 3.0), 6.5e-10 * dofs.powi(2)),
            _ => (6.0 * dofs * dofs.max(2.0).log2(), 3.7e-9 * dofs.powf(1.5)),
        };
        let both = 2.0 * entries - dofs;
        // Where contact is everywhere, every set of closed rows has a factor of its own.
        let share = problem.contact().entries() as f64 / dofs;
        let factors = if share > MANY { SETS } else { 1.0 };
        Estimate {
            direct_bytes: bytes::START + bytes::of_problem(dofs, both) + bytes::of_factor(factor, size_of::<f64>()),
            factor_entries: factor,
            direct_seconds: factors * seconds,
            multigrid_bytes: bytes::START + bytes::of_hierarchy(dofs, both),
            multigrid_seconds: 1.3e-7 * entries,
            hierarchy_seconds: 4e-8 * entries,
            factors,
            suits_multigrid: problem.near_null().is_some() || is_diffusion(problem.stiffness()),
        }
    }
}

/// What a solve keeps beside the problem.
#[derive(Clone, Copy, Debug)]
pub(in crate::qp) enum Kept {
    /// Nothing yet: the problem is being ordered.
    Nothing,
    /// The factor of the body, with so many values, and dense matrices on so many contact dofs.
    Condensed { values: usize, is_single: bool, contact_dofs: usize, by_interior_point: bool },
    /// The factor of the body and those of two contact sets, with so many values each; so many contact dofs come last.
    Factors { values: usize, last: usize, by_interior_point: bool },
    /// The factor of one contact set, with so many values.
    OneFactor { values: usize },
    /// A hierarchy instead of a factor.
    Multigrid,
}

impl Kept {
    /// The least that a condensation onto so many contact dofs keeps.
    pub fn dense(contact_dofs: usize) -> Self {
        Kept::Condensed { values: 0, is_single: true, contact_dofs, by_interior_point: false }
    }

    /// The least that factors with so many contact dofs last keep.
    pub fn boundary(last: usize) -> Self {
        Kept::Factors { values: 0, last, by_interior_point: false }
    }
}

/// Factors that exist at one time where every contact set has its own.
pub(in crate::qp) const FACTORS: f64 = 2.0;

/// Refuses a problem that would take more memory than `settings` allow.
///
/// # Errors
/// [`Error::TooLarge`].
pub(in crate::qp) fn check_memory(problem: &ContactProblem, kept: Kept, settings: &Settings) -> Result<(), Error> {
    let Some(allowed) = settings.memory else { return Ok(()) };
    let (dofs, lower) = (problem.dofs() as f64, problem.stiffness().lower().entries() as f64);
    let stiffness_entries = 2.0 * lower - dofs;
    let of_interior_point = |values: f64, is_used| if is_used { bytes::of_interior_point(values) } else { 0.0 };
    let (factor_entries, beside) = match kept {
        Kept::Nothing => (0, 0.0),
        Kept::Condensed { values, is_single, contact_dofs, by_interior_point } => {
            let size = if is_single { size_of::<f32>() } else { size_of::<f64>() };
            let dense = contact_dofs as f64;
            let on_boundary = bytes::of_dense(dense) + of_interior_point(dense * dense / 2.0, by_interior_point);
            (values, bytes::of_factor(values as f64, size) + on_boundary)
        }
        Kept::Factors { values, last, by_interior_point } => {
            let factors = FACTORS * bytes::of_factor(values as f64, size_of::<f64>());
            let beside = bytes::of_sets(stiffness_entries) + bytes::of_boundary(last as f64);
            (values, factors + beside + of_interior_point(values as f64, by_interior_point))
        }
        Kept::OneFactor { values } => {
            (values, bytes::of_factor(values as f64, size_of::<f64>()) + bytes::of_set(stiffness_entries))
        }
        Kept::Multigrid => (0, 0.0),
    };
    let bytes = match kept {
        Kept::Multigrid => Estimate::of(problem).multigrid_bytes,
        _ => bytes::START + bytes::of_problem(dofs, stiffness_entries) + beside,
    };
    if bytes > allowed {
        let factor_entries = factor_entries as f64;
        return Err(Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed });
    }
    Ok(())
}

/// Refuses work that is estimated to take so many seconds if there is no time for it.
///
/// # Errors
/// [`Error::OutOfTime`].
pub(in crate::qp) fn check_time(watch: &Watch, estimate: f64) -> Result<(), Error> {
    match watch.time_left() {
        Some(time) if !watch.allows(estimate) => Err(Error::OutOfTime { needed: watch.needed(estimate), time }),
        _ => Ok(()),
    }
}
