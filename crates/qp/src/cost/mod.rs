//! Cost of a solve: the one model of seconds and bytes, and the limits that they must keep.

pub(crate) mod bytes;
mod direct;
pub(crate) mod seconds;

use super::method::mprgp::takes_travels;
use super::problem::ContactProblem;
use crate::error::{Error, Result};
use crate::linear::watch::Watch;
use direct::{BodyFactor, Direct};
pub(crate) use direct::{NEAR_CYCLES, Smooth, is_everywhere, starts_near};

/// Rows that are bounds only after reflections take more cycles by this factor.
const TURNED: f64 = 1.6;

/// A singular stiffness takes this many times the seconds: factors for the start and for rows that hold the body.
const SINGULAR: f64 = 4.0;

/// If contact holds more motions of bodies than this one by the other, cycles do not settle the bound: the springs that
/// hold them are in no level of the hierarchy. Measured on towers: 21 motions are bounded, 25 on unlike meshes are not.
const MOST_MOTIONS: usize = 24;

/// Below this many times the seconds of multigrid for a cube, a slender body may take less: minimum degree then tells.
const LOOK: f64 = 12.0;

/// The hierarchy of a stiff volume takes this many times the bytes: patches, and a prolongator of several steps.
const STIFF_BYTES: f64 = 2.5;

/// Seconds of meshing and assembly for an entry of the stiffness, both triangles.
const ASSEMBLY: f64 = 3e-8;

/// Returns `true` if a row has several entries on dofs with stiffness, so that it is a bound only after reflections.
fn is_turned(problem: &ContactProblem) -> bool {
    let contact = problem.contact();
    let of_travels: usize = problem.without_stiffness().into_iter().map(|dof| contact.column(dof).count()).sum();
    contact.entries() - of_travels > contact.rows()
}

/// Estimated time and memory of the two paths.
///
/// Calibrated on blocks of Q4 and Hex8 (`cargo run --release --example studies -- multigrid`) and on parts of
/// tetrahedra (`cargo run --release --example studies -- kinds --scenes FOLDER`, on the output of
/// `reference/parts.py`); accurate to a factor of about two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Bytes of the direct path at its peak, the problem itself included.
    pub direct_bytes: f64,
    /// Values that the Cholesky factor of the stiffness has, with its fill-in.
    pub factor_entries: f64,
    /// Seconds of the factorisations on one processor of 2024.
    pub direct_seconds: f64,
    /// Bytes of the iterative path at its peak, the problem itself included; infinite if multigrid cannot take the
    /// problem.
    pub multigrid_bytes: f64,
    /// Seconds of hierarchy and iteration.
    pub multigrid_seconds: f64,
    /// Seconds to set the levels of multigrid up, without any cycle.
    pub hierarchy_seconds: f64,
    /// Seconds of the part of the direct path that serves all gaps: the first factorisation, with its order.
    pub(super) shared_seconds: f64,
    pub(super) smooth: Smooth,
    pub(super) has_bound: bool,
    /// Number of cycles in the seconds of multigrid.
    pub(super) cycles: f64,
    /// `true` if the direct path starts from a few cycles, which cost less than the sets on the way there.
    pub(super) starts_near: bool,
}

impl Estimate {
    /// Bytes that the program takes before it reads a problem.
    pub const START: f64 = bytes::START;

    /// Bytes of the direct path for a problem that is not assembled yet, without those of the program: `dofs` unknowns,
    /// `entries` of the stiffness, both triangles, `factor_entries` values of its factor, and at most `contact_dofs` on
    /// which it may be condensed.
    pub fn bytes_of_factor(dofs: f64, entries: f64, factor_entries: f64, contact_dofs: f64) -> f64 {
        let factor = bytes::of_factor(factor_entries);
        // Instead of large dense matrices the factor of a set is kept.
        bytes::of_problem(dofs, entries) + factor + bytes::of_dense(contact_dofs).min(factor)
    }

    /// The same for the iterative path.
    pub fn bytes_of_hierarchy(dofs: f64, entries: f64) -> f64 {
        bytes::of_hierarchy(dofs, entries)
    }

    /// Seconds to assemble a stiffness with this number of entries, both triangles, on one processor of 2024.
    pub fn assembly_seconds(entries: f64) -> f64 {
        ASSEMBLY * entries
    }

    /// The estimate for `problem`; its near-null space shows whether it is a bar or a body in space.
    pub fn of(problem: &ContactProblem) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let smooth = Smooth::of(problem);
        let hierarchy_seconds = seconds::hierarchy(dofs, entries);
        let turned = if is_turned(problem) { TURNED } else { 1.0 };
        let cycles = turned * smooth.cycles();
        let multigrid_seconds = hierarchy_seconds + cycles * seconds::cycle(dofs, entries);
        let mut direct = Direct::of(problem, smooth, BodyFactor::by_size(problem));
        let starts_near = direct.starts_near;
        // The slow estimate is made only if it may change the choice.
        if (1.0..LOOK).contains(&(direct.seconds / multigrid_seconds)) {
            direct = Direct::of(problem, smooth, BodyFactor::by_degree(problem));
        }
        let times_multigrid = direct.seconds / multigrid_seconds;
        let matters = times_multigrid < SINGULAR && times_multigrid * SINGULAR > 1.0;
        let motions = if matters || problem.parts().bodies() > 1 { problem.free_motions() } else { 0 };
        let times = if motions > 0 { SINGULAR } else { 1.0 };
        Estimate {
            direct_bytes: bytes::START
                + bytes::of_problem(dofs, problem.stiffness().entries() as f64)
                + bytes::of_factor(direct.factor_entries),
            factor_entries: direct.factor_entries,
            direct_seconds: times * direct.seconds,
            multigrid_bytes: if takes_travels(problem) { multigrid_bytes(problem, smooth) } else { f64::INFINITY },
            multigrid_seconds,
            hierarchy_seconds,
            shared_seconds: times * direct.shared_seconds,
            smooth,
            has_bound: motions <= MOST_MOTIONS,
            cycles,
            starts_near,
        }
    }
}

/// Bytes of the iterative path at its peak, the problem itself included.
fn multigrid_bytes(problem: &ContactProblem, smooth: Smooth) -> f64 {
    let times = if smooth == Smooth::GivenStiff { STIFF_BYTES } else { 1.0 };
    bytes::START + times * bytes::of_hierarchy(problem.dofs() as f64, problem.stiffness().entries() as f64)
}

/// The data that a solve keeps beside the problem.
#[derive(Clone, Copy, Debug)]
pub enum Kept {
    /// Nothing yet: the problem is being ordered.
    Nothing,
    /// The factor of the body, with `values` values, and dense matrices on `contact_dofs` contact dofs.
    Condensed { values: usize, contact_dofs: usize, by_interior_point: bool },
    /// The factor of the body and those of two contact sets, with `values` values each; `last` contact dofs come last.
    Factors { values: usize, last: usize, by_interior_point: bool },
    /// The factor of one contact set, with `values` values.
    OneFactor { values: usize },
    /// A hierarchy instead of a factor.
    Multigrid,
}

/// Number of factors that exist at one time if every contact set has its own.
pub const FACTORS: f64 = 2.0;

/// Refuses a problem that would take more than these bytes, if there is a limit.
pub fn check_memory(problem: &ContactProblem, kept: Kept, most: Option<f64>) -> Result<()> {
    let Some(allowed) = most else { return Ok(()) };
    let (dofs, stiffness_entries) = (problem.dofs() as f64, problem.stiffness().entries() as f64);
    let of_interior_point = |values: f64, is_used| if is_used { bytes::OF_INTERIOR_POINT * values } else { 0.0 };
    let (factor_entries, beside) = match kept {
        Kept::Nothing | Kept::Multigrid => (0, 0.0),
        Kept::Condensed { values, contact_dofs, by_interior_point } => {
            let dense = contact_dofs as f64;
            let on_boundary = bytes::of_dense(dense) + of_interior_point(dense * dense / 2.0, by_interior_point);
            (values, bytes::of_factor(values as f64) + on_boundary)
        }
        Kept::Factors { values, last, by_interior_point } => {
            let factors = FACTORS * bytes::of_factor(values as f64);
            let beside = bytes::OF_SETS * stiffness_entries + bytes::of_boundary(last as f64);
            (values, factors + beside + of_interior_point(values as f64, by_interior_point))
        }
        Kept::OneFactor { values } => {
            (values, bytes::of_next_factor(values as f64) + bytes::OF_SET * stiffness_entries)
        }
    };
    let is_factor = !matches!(kept, Kept::Nothing | Kept::Multigrid);
    let bytes = match kept {
        Kept::Multigrid => multigrid_bytes(problem, Smooth::of(problem)),
        _ => bytes::START + bytes::of_problem(dofs, stiffness_entries) + beside,
    };
    // The bound of a singular stiffness needs further factors, with springs; whether it is singular takes a while.
    let springs = if is_factor { bytes::of_springs(factor_entries as f64, stiffness_entries) } else { 0.0 };
    let bytes = if bytes + springs > allowed && problem.is_singular() { bytes + springs } else { bytes };
    if bytes > allowed {
        let factor_entries = factor_entries as f64;
        return Err(Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed });
    }
    Ok(())
}

/// Refuses work with this estimate in seconds if there is no time for it.
pub fn check_time(watch: &Watch, estimate: f64) -> Result<()> {
    match watch.time_left() {
        Some(time) if !watch.allows(estimate) => Err(Error::OutOfTime { needed: watch.needed(estimate), time }),
        _ => Ok(()),
    }
}
