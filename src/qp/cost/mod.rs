//! What a solve costs: the one model of seconds and bytes, and the limits that are held against it.

pub mod bytes;
pub(in crate::qp) mod seconds;

use super::linear::{SparseMatrix, SymmetricMatrix, Width, largest};
use super::problem::ContactProblem;
use super::settings::Settings;
use super::transform::Condensation;
use crate::error::Error;
use crate::watch::Watch;
pub(crate) use seconds::assembly_seconds;
use seconds::factor_seconds;

/// Rigid-body modes of a body in space: its factor grows faster than that of a plane body.
const MODES_IN_SPACE: usize = 6;

/// Values of the factor of a bar for an unknown, about.
const ALONG_A_LINE: f64 = 4.0;

/// Entries of the contact rows for a dof beyond which the contact boundary is most of the body.
const MANY: f64 = 0.25;

/// Sets of closed rows, each with a factor, until one is settled: where contact is everywhere, and where it is not condensed.
const SETS: [f64; 2] = [10.0, 5.0];

/// The sets of a condensed problem take so many times the seconds of making it, about.
const DENSE_STEPS: f64 = 3.0;

/// Rows that are bounds only after turning take more cycles by this factor.
const TURNED: f64 = 1.6;

/// Cycles of the start of the direct path.
pub(in crate::qp) const NEAR_CYCLES: f64 = 8.0;

/// A stiffness that is singular takes so many times the seconds: factors for the start and for what the rows hold.
const SINGULAR: f64 = 2.5;

/// Forces of a mode below this share of their terms are rounding.
const FREE: f64 = 1e-9;

/// Row sums of a stiffness may be negative by this share of the diagonal: rounding.
const ROW_SUM_ROUNDING: f64 = 1e-9;

/// Neighbours of a dof of a diffusion whose ties differ by more than this slow multigrid down, if most dofs have such.
const UNEVEN: f64 = 1e3;

/// Returns `true` if a row has several entries, so that it is a bound only after turning.
fn is_turned(contact: &SparseMatrix) -> bool {
    contact.entries() > contact.rows()
}

/// Returns `true` if the contact boundary is most of the body, so that a front of closed rows has far to move.
fn is_everywhere(problem: &ContactProblem) -> bool {
    problem.contact().entries() as f64 > MANY * problem.dofs() as f64
}

/// Seconds of a factor in the plane; each part has its own.
fn in_the_plane(problem: &ContactProblem) -> f64 {
    3.7e-9 * problem.parts().sums(|_| 1.0).into_iter().map(|dofs| dofs.powf(1.5)).sum::<f64>()
}

/// Returns `true` if one of the rigid-body modes costs no energy.
fn has_free_mode(problem: &ContactProblem) -> bool {
    let stiffness = problem.stiffness();
    let is_free = |mode: &Vec<f64>| largest(&stiffness.mul(mode)) <= FREE * largest(&stiffness.mul_abs(mode));
    problem.near_null().is_some_and(|modes| modes.vectors().iter().any(is_free))
}

/// What a hierarchy is told of the displacements that cost next to no energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::qp) enum Smooth {
    /// The rigid-body modes are given.
    Given,
    /// Those of a scalar diffusion, the constants.
    Constants,
    /// The same, of one whose ties to neighbours differ by orders of magnitude nearly everywhere.
    Uneven,
    /// Nothing: constants make a poor hierarchy of a body, and a smoother needs a stiffness of every dof.
    Unknown,
}

impl Smooth {
    fn of(problem: &ContactProblem) -> Self {
        match problem.near_null() {
            Some(_) if problem.stiffness().diagonal().contains(&0.0) => Smooth::Unknown,
            Some(_) => Smooth::Given,
            None => Self::of_stiffness(problem.stiffness()),
        }
    }

    /// A stiffness is that of a scalar diffusion if it has no positive entry off the diagonal and no negative row sum.
    fn of_stiffness(stiffness: &SymmetricMatrix) -> Self {
        let diagonal = stiffness.diagonal();
        let mut sums = diagonal.clone();
        let mut ties = vec![(f64::INFINITY, 0.0_f64); diagonal.len()];
        for (row, column, value) in stiffness.lower().triplets().filter(|entry| entry.0 != entry.1 && entry.2 != 0.0) {
            if value > 0.0 {
                return Smooth::Unknown;
            }
            for dof in [row, column] {
                sums[dof] += value;
                ties[dof] = (ties[dof].0.min(-value), ties[dof].1.max(-value));
            }
        }
        if sums.iter().zip(&diagonal).any(|(&sum, own)| sum < -ROW_SUM_ROUNDING * own) {
            return Smooth::Unknown;
        }
        let uneven = ties.iter().filter(|(weakest, strongest)| *strongest > UNEVEN * weakest).count();
        if 2 * uneven > ties.len() { Smooth::Uneven } else { Smooth::Constants }
    }

    /// Returns `true` if a few cycles tell the direct path where to start.
    pub fn starts_sets(self) -> bool {
        matches!(self, Smooth::Given | Smooth::Constants)
    }

    /// Cycles of an answer by multigrid.
    fn cycles(self) -> f64 {
        match self {
            Smooth::Given => 25.0,
            Smooth::Constants => 10.0,
            Smooth::Uneven | Smooth::Unknown => 40.0,
        }
    }
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
    /// Seconds of what serves all gaps on the direct path: the first factorisation, with its order.
    pub(super) shared_seconds: f64,
    /// What a hierarchy knows.
    pub(super) smooth: Smooth,
    /// Cycles that the seconds of multigrid stand for.
    pub(super) cycles: f64,
}

impl Estimate {
    /// The estimate for `problem`; its near-null space tells whether it is a bar or a body in space.
    pub fn of(problem: &ContactProblem) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let both = 2.0 * entries - dofs;
        let smooth = Smooth::of(problem);
        let hierarchy_seconds = seconds::hierarchy(dofs, entries);
        let turned = if is_turned(problem.contact()) { TURNED } else { 1.0 };
        let cycles = turned * smooth.cycles();
        let multigrid_seconds = hierarchy_seconds + cycles * seconds::cycle(dofs, entries);
        let direct = Direct::of(problem, smooth);
        // Whether K is singular is looked at where it matters.
        let times_multigrid = direct.seconds / multigrid_seconds;
        let matters = times_multigrid < SINGULAR && times_multigrid * SINGULAR > 1.0;
        let times = if matters && has_free_mode(problem) { SINGULAR } else { 1.0 };
        Estimate {
            direct_bytes: bytes::START
                + bytes::of_problem(dofs, both)
                + bytes::of_factor(direct.factor_entries, size_of::<f64>()),
            factor_entries: direct.factor_entries,
            direct_seconds: times * direct.seconds,
            multigrid_bytes: bytes::START + bytes::of_hierarchy(dofs, both),
            multigrid_seconds,
            hierarchy_seconds,
            shared_seconds: times * direct.shared_seconds,
            smooth,
            cycles,
        }
    }
}

/// The direct path.
struct Direct {
    factor_entries: f64,
    seconds: f64,
    shared_seconds: f64,
    /// Whether a few cycles of multigrid, which find a set near the last one, cost less than the sets on the way there.
    starts_near: bool,
}

/// Returns `true` if the direct path starts from a few cycles of multigrid, which cost less than the sets on the way there.
pub(in crate::qp) fn starts_near(problem: &ContactProblem) -> bool {
    is_everywhere(problem) && Direct::of(problem, Smooth::of(problem)).starts_near
}

impl Direct {
    fn of(problem: &ContactProblem, smooth: Smooth) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let (factor_entries, of_body) = match problem.near_null().map(|near_null| near_null.count()) {
            Some(1) => (ALONG_A_LINE * dofs, factor_seconds(0.0, (ALONG_A_LINE * dofs) as usize, Width::Double)),
            Some(MODES_IN_SPACE..) => (23.0 * dofs.powf(4.0 / 3.0), 7.7e-10 * dofs.powi(2)),
            _ => (6.0 * dofs * dofs.max(2.0).log2(), in_the_plane(problem)),
        };
        let boundary = Condensation::contact_dofs(problem.contact()).len();
        let mut starts_near = false;
        let (factor, sets) = if is_everywhere(problem) {
            let near = seconds::hierarchy(dofs, entries) + NEAR_CYCLES * seconds::cycle(dofs, entries) + of_body;
            let from_nothing = SETS[0] * of_body;
            starts_near = smooth.starts_sets() && near < from_nothing;
            (of_body, if starts_near { near } else { from_nothing })
        } else {
            let factor = of_body + seconds::last_block(boundary);
            let is_condensed = Condensation::is_small(boundary, factor_entries);
            (factor, if is_condensed { DENSE_STEPS * seconds::dense(boundary) } else { SETS[1] * factor })
        };
        let shared_seconds = seconds::ordering(problem) + factor;
        Direct { factor_entries, seconds: shared_seconds + sets, shared_seconds, starts_near }
    }
}

/// What a solve keeps beside the problem.
#[derive(Clone, Copy, Debug)]
pub(in crate::qp) enum Kept {
    /// Nothing yet: the problem is being ordered.
    Nothing,
    /// The factor of the body, with so many values, and dense matrices on so many contact dofs.
    Condensed { values: usize, width: Width, contact_dofs: usize, by_interior_point: bool },
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
        Kept::Condensed { values: 0, width: Width::Single, contact_dofs, by_interior_point: false }
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
        Kept::Condensed { values, width, contact_dofs, by_interior_point } => {
            let dense = contact_dofs as f64;
            let on_boundary = bytes::of_dense(dense) + of_interior_point(dense * dense / 2.0, by_interior_point);
            (values, bytes::of_factor(values as f64, width.bytes()) + on_boundary)
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
