//! Smoothed-aggregation multigrid for symmetric matrices with a known near-null space, such as the stiffness of a body.
//!
//! Nodes are gathered into aggregates along strong connections. The near-null vectors, cut into aggregates and made
//! orthonormal, are the tentative prolongator; one step of damped Jacobi smooths it. The next matrix is the Galerkin
//! product. One cycle smooths by a Chebyshev polynomial, corrects on the next level, and smooths again; the coarsest
//! matrix is factorised. The cycle is a symmetric positive definite preconditioner.
//!
//! # Source
//! P. Vaněk, M. Brezina, J. Mandel, *Convergence of algebraic multigrid based on smoothed aggregation*, Numer. Math. 88
//! (2001) 559-579.

mod blocks;
mod chebyshev;
mod coarser;
mod conjugate_gradients;
mod cycle;
mod filling;
mod half;
mod hierarchy;
mod lines;
mod nodes;
mod operator;
mod patches;
mod products;
mod prolongator;
mod repeated;

pub use coarser::Interval;
pub use conjugate_gradients::Preconditioned;
pub use nodes::{NearNullSpace, Units};
pub use operator::{Direction, Hold};

use super::{FactorError, Spare, SymmetricMatrix};
use crate::error::Error;
use cycle::FaceLevels;
use hierarchy::Hierarchy;

/// The hierarchy of a symmetric positive (semi)definite matrix: one cycle approximates its inverse.
#[derive(Debug)]
pub struct Multigrid {
    matrix: SymmetricMatrix,
    levels: Levels,
    /// Work vectors of the iteration around the cycles.
    work: Spare<f64>,
}

/// What is stored in single or in double precision; the iteration around the levels is always in double precision.
#[derive(Debug)]
enum ByPrecision<S, D> {
    Single(S),
    Double(D),
}

type Levels = ByPrecision<Hierarchy<f32>, Hierarchy<f64>>;
type LevelsInFace<'a> = ByPrecision<(&'a Hierarchy<f32>, FaceLevels<f32>), (&'a Hierarchy<f64>, FaceLevels<f64>)>;

/// Calls a function of what is stored, in its precision.
macro_rules! by_precision {
    ($stored:expr, $pattern:pat => $call:expr) => {
        match &$stored {
            ByPrecision::Single($pattern) => $call,
            ByPrecision::Double($pattern) => $call,
        }
    };
}

/// The floating-point numbers in which a hierarchy is stored; iterations around it are always in double precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// 64 bits, about sixteen digits.
    Double,
    /// Single: half the memory, about seven digits of each value.
    Single,
}

/// A factor of the coarsest level takes as many cycles, if it has as many unknowns as the finest. Measured: 11.5 cycles
/// at half as many, none at a fiftieth.
const COARSEST_FACTOR: f64 = 20.0;

impl Multigrid {
    /// Builds the hierarchy of `matrix` (n x n) in single precision, or in double if rounding to single makes the
    /// matrix indefinite.
    ///
    /// # Errors
    /// [`Error::Length`] for a near-null space of other than n dofs, [`Error::NotConvex`] for a diagonal entry that is
    /// negative, or zero beside a coupling, and for a coarse matrix with a negative eigenvalue, [`Error::Numerical`]
    /// for lack of memory.
    pub fn new(matrix: &SymmetricMatrix, near_null: &NearNullSpace, threads: usize) -> Result<Self, Error> {
        match Self::with_precision(matrix, near_null, threads, Width::Single) {
            Err(Error::NotConvex { .. }) => Self::with_precision(matrix, near_null, threads, Width::Double),
            built => built,
        }
    }

    /// As [`Multigrid::new`], in the precision given.
    ///
    /// # Errors
    /// As [`Multigrid::new`].
    pub fn with_precision(
        matrix: &SymmetricMatrix,
        near_null: &NearNullSpace,
        threads: usize,
        precision: Width,
    ) -> Result<Self, Error> {
        Error::check_length("near-null vector", near_null.dofs(), matrix.dim(), "dofs")?;
        check_diagonal(matrix)?;
        let levels = match precision {
            Width::Single => Hierarchy::new(matrix, near_null, threads).map(Levels::Single),
            Width::Double => Hierarchy::new(matrix, near_null, threads).map(Levels::Double),
        };
        Ok(Multigrid { matrix: matrix.clone(), levels: levels.map_err(located)?, work: Spare::default() })
    }

    /// One cycle: approximately the solution x of A x = b, linear in b and symmetric.
    pub fn cycle(&self, b: &[f64]) -> Vec<f64> {
        by_precision!(self.levels, hierarchy => hierarchy.cycle(b, None, &self.work))
    }

    /// The node of each dof, and the unit of its unknown in the hierarchy.
    pub fn units(&self) -> Units {
        by_precision!(self.levels, hierarchy => hierarchy.nodes.units())
    }

    /// The hierarchy in the face of `holds`, in the unknowns v of `Units`; `last` is a face of the same hierarchy that
    /// may be close.
    ///
    /// # Errors
    /// As [`Multigrid::new`].
    pub fn face(&self, holds: &[Hold], last: Option<&Face>) -> Result<Face<'_>, Error> {
        use ByPrecision::{Double, Single};
        let levels = match &self.levels {
            Single(own) => {
                let last = last.and_then(|last| if let Single(last) = &last.levels { Some(&last.1) } else { None });
                FaceLevels::new(own, holds, last).map(|face| Single((own, face)))
            }
            Double(own) => {
                let last = last.and_then(|last| if let Double(last) = &last.levels { Some(&last.1) } else { None });
                FaceLevels::new(own, holds, last).map(|face| Double((own, face)))
            }
        };
        Ok(Face { levels: levels.map_err(located)?, work: &self.work })
    }

    /// The product of `matrix` with `u`, length n; one of the work vectors. It is fast if this is the matrix of the
    /// hierarchy, and nearly all its rows of blocks repeat.
    pub fn product(&self, matrix: &SymmetricMatrix, u: &[f64]) -> Vec<f64> {
        let of_blocks = || by_precision!(self.levels, hierarchy => hierarchy.product(u, &self.work));
        let is_own = matrix.lower().is_shared_with(self.matrix.lower());
        is_own.then(of_blocks).flatten().unwrap_or_else(|| matrix.mul_with(self.threads(), u, &self.work))
    }

    /// Work vectors for the iteration around the cycles; what a cycle returns is one of them.
    pub fn work(&self) -> &Spare<f64> {
        &self.work
    }

    /// Number of threads that a cycle takes; they change no bit of it.
    pub fn threads(&self) -> usize {
        by_precision!(self.levels, hierarchy => hierarchy.threads)
    }

    /// Number of unknowns of each level of the hierarchy, the finest first.
    pub fn unknowns(&self) -> Vec<usize> {
        by_precision!(self.levels, hierarchy => hierarchy.unknowns())
    }

    /// Cycles that take about the seconds of the coarsest factor of a face: many if the finest level is hardly larger.
    pub fn cycles_of_face(&self) -> usize {
        let unknowns = self.unknowns();
        let share = unknowns[unknowns.len() - 1] as f64 / unknowns[0] as f64;
        (COARSEST_FACTOR * share) as usize
    }

    /// Bytes of memory that the hierarchy holds, without the matrix.
    pub fn bytes(&self) -> usize {
        by_precision!(self.levels, hierarchy => hierarchy.bytes())
    }

    /// Returns `true` if the matrix was singular to the precision of its levels, so that the coarsest one was shifted.
    pub fn is_shifted(&self) -> bool {
        by_precision!(self.levels, hierarchy => hierarchy.coarsest.is_shifted)
    }
}

/// A hierarchy in a face: one cycle approximates the inverse of the matrix there.
#[derive(Debug)]
pub struct Face<'a> {
    levels: LevelsInFace<'a>,
    work: &'a Spare<f64>,
}

impl Face<'_> {
    /// One cycle: approximately the x in the face with A x - b orthogonal to it.
    pub fn cycle(&self, b: &[f64]) -> Vec<f64> {
        by_precision!(self.levels, (hierarchy, face) => hierarchy.cycle(b, Some(face), self.work))
    }

    /// Returns `true` if the matrix in the face is singular to the precision of its levels, so that the coarsest one
    /// was shifted.
    pub fn is_shifted(&self) -> bool {
        by_precision!(self.levels, (_, face) => face.coarsest.is_shifted)
    }
}

/// Checks that a dof without stiffness has no coupling either: a cycle then leaves it to itself.
fn check_diagonal(matrix: &SymmetricMatrix) -> Result<(), Error> {
    let diagonal = matrix.diagonal();
    if diagonal.iter().all(|&value| value > 0.0) {
        return Ok(());
    }
    let couples = |&(row, column, value): &(usize, usize, f64)| value != 0.0 && row != column;
    let coupled = matrix.lower().triplets().filter(couples).flat_map(|(row, column, _)| [row, column]);
    let negative = (0..diagonal.len()).find(|&dof| diagonal[dof] < 0.0);
    let Some(dof) = negative.or_else(|| coupled.into_iter().find(|&dof| diagonal[dof] <= 0.0)) else { return Ok(()) };
    Err(Error::NotConvex { evidence: format!("diagonal entry {dof} is {:e}, indices from 0", diagonal[dof]) })
}

fn located(error: FactorError) -> Error {
    match error {
        FactorError::NotPositiveDefinite => {
            Error::NotConvex { evidence: "the coarsest matrix of its hierarchy has a negative eigenvalue".into() }
        }
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::blocks::BlockMatrix;
    use super::chebyshev::Chebyshev;
    use super::nodes::Nodes;
    use super::prolongator::{Candidates, smoothed, tentative};
    use super::*;
    use crate::{SparseMatrix, generic};

    /// Bars along the lines of a square lattice of nodes with two dofs, which resist shear a little; the upper half is
    /// softer by `2^-40`, and each node is held by springs. `factor(node)` multiplies the springs of a node.
    fn lattice(nodes: usize, factor: impl Fn(usize) -> f64) -> SymmetricMatrix {
        let dofs = 2 * nodes * nodes;
        let mut entries = Vec::new();
        for node in 0..nodes * nodes {
            let stiffness = if node / nodes < nodes / 2 { 1.1 } else { 1.1 * 2_f64.powi(-40) };
            let (right, above) = (node % nodes + 1 < nodes, node / nodes + 1 < nodes);
            for (other, along, exists) in [(node + 1, 0, right), (node + nodes, 1, above)] {
                for component in (0..2).filter(|_| exists) {
                    let k = if component == along { stiffness } else { 0.4 * stiffness };
                    let (a, b) = (2 * node + component, 2 * other + component);
                    entries.extend([(a, a, k), (b, b, k), (b, a, -k)]);
                }
            }
            let shear = 0.1 * stiffness;
            entries.extend((0..2).map(|c| (2 * node + c, 2 * node + c, 0.3 * stiffness * factor(node))));
            entries.push((2 * node + 1, 2 * node, shear));
        }
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &entries).unwrap()).unwrap()
    }

    /// Asserts that the product of the hierarchy is that of the matrix, to the rounding of a sum of ten terms.
    fn check(multigrid: &Multigrid, matrix: &SymmetricMatrix) {
        let u = generic(matrix.dim(), 0);
        let (found, expected, size) = (multigrid.product(matrix, &u), matrix.mul(&u), matrix.mul_abs(&u));
        for dof in 0..u.len() {
            let difference = (found[dof] - expected[dof]).abs();
            assert!(difference <= 10.0 * f64::EPSILON * size[dof], "dof {dof}: {difference:e} of {:e}", size[dof]);
        }
    }

    fn is_by_blocks(multigrid: &Multigrid) -> bool {
        by_precision!(multigrid.levels, levels => levels.product(&vec![0.0; multigrid.matrix.dim()], &Spare::default()))
            .is_some()
    }

    /// GOAL: the products of the few rows of a lattice are those of all rows, bit by bit.
    #[test]
    fn levels_of_a_lattice_are_made_of_its_few_rows() {
        let nodes = 90;
        let (_, few, _, _) = Nodes::of::<f32>(&lattice(nodes, |_| 1.0), 1);
        let smoother = Chebyshev::new(&few, None, 1);
        // Constants, in squares of nine nodes; each dof is a node of the hierarchy.
        let values = [1.0, 0.0, 0.0, 1.0].repeat(nodes * nodes);
        let square_of = |node: usize| (node / nodes / 3 * (nodes / 3) + node % nodes / 3) as u32;
        let of_dof: Vec<u32> = (0..few.rows()).map(|dof| square_of(dof / 2)).collect();
        let (flat, coarse) = tentative(&few, &Candidates { count: 2, values }, &of_dof, nodes * nodes / 9);
        // The vectors of a square have the length 3.
        let lengths = [3.0, 0.0, 0.0, 3.0];
        assert!(coarse.values.iter().zip(lengths.iter().cycle()).all(|(r, length)| (r - length).abs() < 1e-14));
        let levels = |matrix: &BlockMatrix<f32>, flat: &BlockMatrix<f32>| {
            let prolongator = smoothed(flat, matrix.product(flat, 1), &smoother, 1);
            let coarse = prolongator.galerkin_product(matrix, 1);
            [prolongator.transposed(), prolongator, coarse]
        };
        let (found, expected) = (levels(&few, &flat), levels(&few.unshared(), &flat.unshared()));
        for (found, expected) in found.iter().zip(&expected) {
            assert!((0..expected.rows()).all(|row| found.row(row).eq(expected.row(row))));
        }
        assert!(found[..2].iter().all(|matrix| 5 * matrix.indices.len() < matrix.starts[matrix.rows()]));
        assert!(expected.iter().all(|matrix| !matrix.is_shared()));
    }

    #[test]
    fn the_matrix_of_a_lattice_is_multiplied_by_its_few_rows_and_every_other_by_its_entries() {
        let build = |matrix: &SymmetricMatrix, precision| {
            let near_null = NearNullSpace::constants(matrix).unwrap();
            Multigrid::with_precision(matrix, &near_null, 2, precision).unwrap()
        };
        let [even, uneven] = [lattice(90, |_| 1.0), lattice(90, |node| 1.0 + node as f64)];
        for precision in [Width::Single, Width::Double] {
            let of_even = build(&even, precision);
            assert!(is_by_blocks(&of_even) && !is_by_blocks(&build(&uneven, precision)));
            check(&of_even, &even);
            // A matrix with the same unknowns that is not that of the hierarchy.
            check(&of_even, &uneven);
            // A dof without stiffness, as the travel of an obstacle, has no force.
            let travel = even.clone().with_empty(1);
            let of_travel = build(&travel, precision);
            assert!(is_by_blocks(&of_travel));
            check(&of_travel, &travel);
        }
    }
}
