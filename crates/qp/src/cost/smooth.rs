//! Number of cycles of an answer by multigrid, from the near-null space of the hierarchy and the quality of its
//! smoother.

use crate::linear::SymmetricMatrix;
use crate::method::mprgp::takes_travels;
use crate::problem::ContactProblem;

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
/// quadratic elements reach 6.4 to 11.7, at nu = 0.3 they reach 3.4 to 6.2, and those of linear elements stay below 5.8
/// at any ratio.
const STIFF: f64 = 6.3;

/// Displacements of almost no energy that a hierarchy is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Smooth {
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
    pub(super) fn of(problem: &ContactProblem) -> Self {
        let (stiffness, given) = (problem.stiffness(), problem.near_null().map(|modes| modes.count()));
        if given.is_some() && !takes_travels(problem) {
            return Smooth::Unknown;
        }
        // One vector: of a diffusion it can only be the constants.
        let of_diffusion =
            if given.is_some_and(|count| count > 1) { None } else { Some(Self::of_stiffness(stiffness)) };
        match of_diffusion.filter(|&found| given.is_none() || found != Smooth::Unknown) {
            Some(found) => found,
            None => {
                let share = outweighed(stiffness);
                match share(STIFF) > 0.5 {
                    true => Smooth::GivenStiff,
                    false if share(HEAVY) > HEAVY_SHARE => Smooth::GivenHeavy,
                    false => Smooth::Given,
                }
            }
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

    /// Returns `true` if a few cycles give the direct path a good start.
    pub fn starts_sets(self) -> bool {
        matches!(self, Smooth::Given | Smooth::GivenHeavy | Smooth::Constants)
    }

    /// Cycles of an answer by multigrid, in the work of cycles that smooth by diagonal blocks.
    pub(super) fn cycles(self) -> f64 {
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

    /// Of quadratic elements in space: 5.5 times.
    #[test]
    fn quadratic_elements_are_heavy_and_linear_ones_are_not() {
        let is_heavy = |heavy: usize| outweighed(&ring(100, heavy, 5.5))(HEAVY) > HEAVY_SHARE;
        assert!(is_heavy(100));
        assert!(!is_heavy(0));
        assert!(is_heavy(15), "a part with quadratic elements");
        assert!(!is_heavy(6), "few rows");
    }

    /// Quadratic elements at nu = 0.499: 7 times in half of the rows.
    #[test]
    fn quadratic_elements_near_the_ratio_one_half_are_stiff() {
        let is_stiff = |heavy: usize, sum: f64| outweighed(&ring(100, heavy, sum))(STIFF) > 0.5;
        assert!(is_stiff(60, 7.0));
        assert!(!is_stiff(100, 5.5), "quadratic elements at nu = 0.3");
        assert!(!is_stiff(40, 7.0), "few rows");
    }
}
