//! Seconds of the direct path, estimated before the ordering.

use super::seconds::{self, factor_seconds};
use super::smooth::Smooth;
use crate::linear::Fill;
use crate::problem::ContactProblem;
use crate::transform::Condensation;

/// Rigid-body modes of a body in space: its factor grows faster than that of a plane body.
const MODES_IN_SPACE: usize = 6;

/// Values of the factor of a bar for each unknown, approximately.
const ALONG_A_LINE: f64 = 4.0;

/// If the contact rows have more entries for each dof than this, the contact boundary is most of the body.
const MANY: f64 = 0.25;

/// Cycles of multigrid from which the direct path starts.
pub(crate) const NEAR_CYCLES: f64 = 8.0;

/// Sets of closed rows, each with a factor, until one is settled: if contact is everywhere, and if the problem is not
/// condensed.
const SETS: [f64; 2] = [10.0, 5.0];

/// Condensing a problem and its sets take about this many times the seconds of a product of its dense matrices: 2 to 7,
/// by the rows that are closed on the way.
const DENSE_STEPS: f64 = 6.0;

/// Returns `true` if the contact boundary is most of the body, so that a front of closed rows has a long way to go.
pub(crate) fn is_everywhere(problem: &ContactProblem) -> bool {
    problem.contact().entries() as f64 > MANY * problem.dofs() as f64
}

/// The factor of the stiffness without its contact rows.
#[derive(Clone, Copy)]
pub(super) struct BodyFactor {
    entries: f64,
    seconds: f64,
    ordering_seconds: f64,
}

impl BodyFactor {
    /// By the number of unknowns of each body, with the law of a bar, a square or a cube.
    pub fn by_size(problem: &ContactProblem) -> Self {
        let law: fn(f64) -> [f64; 2] = match problem.near_null().map(|near_null| near_null.count()) {
            Some(1) if is_line(problem) => |dofs| [0.0, ALONG_A_LINE * dofs],
            Some(MODES_IN_SPACE..) => |dofs| [10.0 * dofs.powi(2), 23.0 * dofs.powf(4.0 / 3.0)],
            _ => |dofs| [34.0 * dofs.powf(1.5), 6.0 * dofs * dofs.max(2.0).log2()],
        };
        let bodies = problem.parts().dofs_of_bodies().into_iter().map(|dofs| law(dofs as f64));
        let [multiplications, entries] = bodies.fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
        let seconds = factor_seconds(multiplications, entries);
        BodyFactor { entries, seconds, ordering_seconds: seconds::ordering(problem) }
    }

    /// The same, or less if an order by minimum degree shows that the factor of a body in space is smaller: slender and
    /// thin-walled bodies have far smaller factors than cubes. The order takes a few hundredths of the time of a solve
    /// by multigrid.
    pub fn by_degree(problem: &ContactProblem) -> Self {
        let by_size = Self::by_size(problem);
        let in_space = problem.near_null().is_some_and(|near_null| near_null.count() >= MODES_IN_SPACE);
        let Some(fill) = in_space.then(|| Fill::by_minimum_degree(problem.stiffness()).ok()).flatten() else {
            return by_size;
        };
        let seconds = factor_seconds(fill.multiplications, fill.entries);
        if seconds >= by_size.seconds {
            return by_size;
        }
        let ordering_seconds =
            if fill.is_dissected { by_size.ordering_seconds } else { seconds::minimum_degree(problem) };
        BodyFactor { entries: by_size.entries.min(fill.entries), seconds, ordering_seconds }
    }
}

/// Returns `true` if an unknown is coupled to two others at most, as along a bar.
fn is_line(problem: &ContactProblem) -> bool {
    problem.stiffness().lower().entries() <= 2 * problem.dofs()
}

/// The estimated costs of the direct path.
pub(super) struct Direct {
    pub factor_entries: f64,
    pub seconds: f64,
    pub shared_seconds: f64,
    /// `true` if a few cycles of multigrid, which find a set near the last one, cost less than the sets on the way
    /// there.
    pub starts_near: bool,
}

/// Returns `true` if the direct path starts from a few cycles, by the estimates that take no order of the stiffness.
pub(crate) fn starts_near(problem: &ContactProblem) -> bool {
    Direct::of(problem, Smooth::of(problem), BodyFactor::by_size(problem)).starts_near
}

impl Direct {
    pub fn of(problem: &ContactProblem, smooth: Smooth, body: BodyFactor) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let boundary = problem.contact().columns_with_entries().len();
        let mut starts_near = false;
        let (factor, sets) = if is_everywhere(problem) {
            let near = seconds::hierarchy(dofs, entries) + NEAR_CYCLES * seconds::cycle(dofs, entries) + body.seconds;
            let from_nothing = SETS[0] * body.seconds;
            starts_near = smooth.starts_sets() && near < from_nothing;
            (body.seconds, if starts_near { near } else { from_nothing })
        } else {
            let factor = body.seconds + seconds::last_block(boundary);
            let is_condensed = Condensation::pays(boundary as f64, dofs, body.entries);
            (factor, if is_condensed { DENSE_STEPS * seconds::dense(boundary) } else { SETS[1] * factor })
        };
        let shared_seconds = body.ordering_seconds + factor;
        Direct { factor_entries: body.entries, seconds: shared_seconds + sets, shared_seconds, starts_near }
    }
}
