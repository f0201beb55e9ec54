//! Seconds of the direct path before the ordering, and the cycles of multigrid by its near-null space and smoother.

use super::seconds::{self, factor_seconds};
use crate::linear::{Fill, SymmetricMatrix};
use crate::method::mprgp::takes_travels;
use crate::problem::ContactProblem;
use crate::transform::Condensation;

/// Rigid-body modes of a body in space: its factor grows faster than that of a plane body.
const MODES_IN_SPACE: usize = 6;

/// Values of the factor of a bar for each unknown, approximately.
const ALONG_A_LINE: f64 = 4.0;

/// If the contact rows have more entries for each dof than this, the contact boundary is most of the body.
const MANY: f64 = 0.25;

/// Cycles of multigrid from which the direct path starts.
pub const NEAR_CYCLES: f64 = 8.0;

/// Sets, each with a factor, until one is settled: if contact is everywhere, and if the problem is not condensed.
const SETS: [f64; 2] = [10.0, 5.0];

/// Condensing and its sets take about this many times the seconds of a dense product: 2 to 7, by the closed rows.
const DENSE_STEPS: f64 = 6.0;

/// Returns `true` if the contact boundary is most of the body, so that a front of closed rows has a long way to go.
pub fn is_everywhere(problem: &ContactProblem) -> bool {
    problem.contact().entries() as f64 > MANY * problem.dofs() as f64
}

#[derive(Clone, Copy)]
pub struct BodyFactor {
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
        let (parts, mut dofs) = (problem.parts(), vec![0_usize; problem.parts().bodies()]);
        (0..problem.dofs()).for_each(|dof| dofs[parts.body_of_dof(dof)] += 1);
        let bodies = dofs.into_iter().map(|dofs| law(dofs as f64));
        let [multiplications, entries] = bodies.fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
        let seconds = factor_seconds(multiplications, entries);
        BodyFactor { entries, seconds, ordering_seconds: seconds::ordering(problem) }
    }

    /// The same, or less if an order by minimum degree shows that the factor of a body in space is smaller: slender and
    /// thin-walled bodies have far smaller ones than cubes. The order takes a few hundredths of the time of multigrid.
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

pub struct Direct {
    pub factor_entries: f64,
    pub seconds: f64,
    pub shared_seconds: f64,
    /// `true` if a few cycles, which find a set near the last one, cost less than the sets on the way there.
    pub starts_near: bool,
}

/// Returns `true` if the direct path starts from a few cycles, by the estimates that take no order of the stiffness.
pub fn starts_near(problem: &ContactProblem) -> bool {
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
            starts_near =
                matches!(smooth, Smooth::Given | Smooth::GivenHeavy | Smooth::Constants) && near < from_nothing;
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

/// Row sums of a stiffness may be negative by this share of the diagonal, because of rounding.
const ROW_SUM_ROUNDING: f64 = 1e-9;

/// If most dofs of a diffusion have couplings to their neighbours that differ by more than this, multigrid is slow.
const UNEVEN: f64 = 1e3;

/// A row is smoothed slowly if its entries off the diagonal add up to more than this many times the diagonal: the
/// largest eigenvalue of D^-1 K may be as large as one plus that sum over the diagonal. At nu = 0.3 linear elements
/// stay below 3.2; quadratic ones reach 5.5 in a tenth of their rows.
const HEAVY: f64 = 4.2;

/// A stiffness counts as heavy from this share of such rows on.
const HEAVY_SHARE: f64 = 0.1;

/// Most rows of a stiff volume outweigh their diagonal more than this many times: at nu = 0.499 half of the rows of
/// quadratic elements reach 6.4 to 11.7, at nu = 0.3 they reach 3.4 to 6.2, and linear elements stay below 5.8.
const STIFF: f64 = 6.3;

/// Displacements of almost no energy that a hierarchy is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smooth {
    /// The rigid-body modes are given.
    Given,
    /// The same; point smoothers need more cycles, because many rows outweigh their diagonal.
    GivenHeavy,
    /// The same; the volume is stiff beside the shear in quadratic elements, so that cycles are many and each is dear.
    GivenStiff,
    /// The constants of a scalar diffusion.
    Constants,
    /// The same, for a diffusion with couplings that differ by orders of magnitude at most dofs.
    Uneven,
    /// Nothing is given: constants make a poor hierarchy of a body, and a smoother needs a stiffness of every dof.
    Unknown,
}

impl Smooth {
    pub fn of(problem: &ContactProblem) -> Self {
        let (stiffness, given) = (problem.stiffness(), problem.near_null().map(|modes| modes.count()));
        if given.is_some() && !takes_travels(problem) {
            return Smooth::Unknown;
        }
        // One vector: of a diffusion it can only be the constants.
        let of_diffusion =
            if given.is_some_and(|count| count > 1) { None } else { Some(Self::of_stiffness(stiffness)) };
        if let Some(found) = of_diffusion.filter(|&found| given.is_none() || found != Smooth::Unknown) {
            return found;
        }
        let share = outweighed(stiffness);
        match share(STIFF) > 0.5 {
            true => Smooth::GivenStiff,
            false if share(HEAVY) > HEAVY_SHARE => Smooth::GivenHeavy,
            false => Smooth::Given,
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

    /// Cycles of an answer by multigrid, in the work of cycles that smooth by diagonal blocks.
    pub fn cycles(self) -> f64 {
        match self {
            Smooth::Given => 16.0,
            Smooth::GivenHeavy => 45.0,
            Smooth::GivenStiff => 250.0,
            Smooth::Constants => 10.0,
            Smooth::Uneven | Smooth::Unknown => 40.0,
        }
    }
}

/// The share of the rows whose entries off the diagonal, in absolute value, outweigh it more than this many times.
fn outweighed(stiffness: &SymmetricMatrix) -> impl Fn(f64) -> f64 {
    let sums = stiffness.mul_abs(&vec![1.0; stiffness.dim()]);
    let of_row = |(sum, own): (&f64, f64)| if *sum > own { (sum - own) / own } else { 0.0 };
    let sums: Vec<f64> = sums.iter().zip(stiffness.diagonal()).map(of_row).collect();
    move |times| sums.iter().filter(|&&sum| sum > times).count() as f64 / sums.len() as f64
}

#[cfg(test)]
mod tests {
    use super::{HEAVY, HEAVY_SHARE, STIFF, outweighed};
    use crate::linear::{SparseMatrix, SymmetricMatrix};

    /// A ring in which the off-diagonal entries of each of the first `heavy` rows add up to about `sum` times the
    /// diagonal, and those of the others to 3.2 times, as those of linear elements in space do.
    fn ring(rows: usize, heavy: usize, sum: f64) -> SymmetricMatrix {
        let entry = |row: usize, next: usize| {
            let of = |row: usize| if row < heavy { 0.5 * sum } else { 1.6 };
            (row.max(next), row.min(next), -of(row).min(of(next)))
        };
        let mut entries: Vec<_> = (0..rows).map(|row| (row, row, 1.0)).collect();
        entries.extend((0..rows).map(|row| entry(row, (row + 1) % rows)));
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(rows, rows, &entries).unwrap()).unwrap()
    }

    #[test]
    fn quadratic_elements_are_heavy_and_near_the_ratio_one_half_they_are_stiff() {
        let share = |heavy: usize, sum: f64, times: f64| outweighed(&ring(100, heavy, sum))(times);
        // Of quadratic elements in space: 5.5 times; of a part, and of few rows.
        for (heavy, is_heavy) in [(100, true), (0, false), (15, true), (6, false)] {
            assert_eq!(share(heavy, 5.5, HEAVY) > HEAVY_SHARE, is_heavy, "{heavy}");
        }
        // Quadratic elements at nu = 0.499: 7 times in half of the rows; at nu = 0.3; and in few rows.
        for (heavy, sum, is_stiff) in [(60, 7.0, true), (100, 5.5, false), (40, 7.0, false)] {
            assert_eq!(share(heavy, sum, STIFF) > 0.5, is_stiff, "{heavy} {sum}");
        }
    }
}
