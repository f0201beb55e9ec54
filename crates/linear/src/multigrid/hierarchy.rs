//! The levels of a hierarchy; the coarsest is a Cholesky factor, shifted if nothing holds the body.

use std::sync::Arc;

use super::blocks::BlockMatrix;
use super::chebyshev::{Chebyshev, LOST_DIAGONAL};
use super::filling::fill_empty_diagonal;
use super::lines::{Lines, aggregate, strong_connections};
use super::nodes::{NearNullSpace, Nodes};
use super::operator::Operator;
use super::patches::Patches;
use super::prolongator::{Candidates, smoothed, smoothed_in_steps, tentative};
use crate::real::Real;
use crate::{Analysis, Cholesky, Equilibration, FactorError, Spare, SparseMatrix, SymmetricMatrix, ldexp};

/// Strength of connection on the finest level; it is halved from level to level, as in the source.
const THRESHOLD: f64 = 0.02;

/// If too few connections are strong to form aggregates, all connections count as strong below this threshold.
const LEAST_THRESHOLD: f64 = 1e-3;

/// The diagonal blocks smooth too slowly beyond this largest eigenvalue of D^-1 A. At nu = 0.3 it is 3 for linear
/// elements and for tetrahedra of ten nodes, and 5.4 for bricks of twenty; near nu = 0.5 it is 4.6 for linear elements,
/// 5 to 6 for tetrahedra of ten nodes, and 8.5 for bricks of twenty.
const SLOW: f64 = 4.8;

/// Steps of a smoother on patches that smooth the prolongator if one is too few. Measured at nu = 0.4999: three take a
/// fifth more cycles, eight a tenth fewer, with twice the memory.
const MOST_STEPS: usize = 4;

const MOST_IN_PATCH: usize = 120;

/// Largest number of patches as a share of the nodes: if there are more, most nodes are alone, and patches gain
/// nothing.
const PATCHES: f64 = 0.5;

/// Largest number of unknowns that are factorised directly.
const COARSEST: usize = 1500;

/// A level with more than this share of the nodes above it is not worth its work: the matrix is factorised there.
const LEAST_COARSENING: f64 = 0.4;

#[derive(Debug)]
pub struct Hierarchy<T> {
    pub(super) nodes: Nodes,
    /// The matrix in the units of the nodes, times `2^shift`, has a diagonal of order one.
    pub(super) shift: i32,
    /// The finest matrix, not rounded, if nearly all its rows repeat.
    exact: Option<BlockMatrix<f64>>,
    pub(super) levels: Vec<Arc<Level<T>>>,
    /// The matrix of the coarsest level, and its factor.
    pub(super) coarsest_matrix: Arc<BlockMatrix<T>>,
    pub(super) coarsest: Arc<Coarsest>,
    pub(super) threads: usize,
    pub(super) spare: Spare<T>,
}

#[derive(Debug)]
pub(super) struct Level<T> {
    pub matrix: BlockMatrix<T>,
    pub smoother: Chebyshev<T>,
    pub prolongator: BlockMatrix<T>,
    pub near_null: Candidates,
}

/// The aggregate of each node and the number of aggregates; `None` if they are too many. The threshold falls until they
/// are few.
fn gathered<T: Real>(blocks: &BlockMatrix<T>, count: usize, threshold: &mut f64) -> Option<(Vec<u32>, usize)> {
    let most = (LEAST_COARSENING * (blocks.rows() * blocks.height) as f64) as usize;
    loop {
        let (of_node, aggregates) = aggregate(&strong_connections(blocks, *threshold));
        match aggregates * count > most {
            false => return Some((of_node, aggregates)),
            true if *threshold == 0.0 => return None,
            true => *threshold = if *threshold > LEAST_THRESHOLD { *threshold / 4.0 } else { 0.0 },
        }
    }
}

/// The smoother of the finest matrix: by its diagonal blocks, or on patches if these smooth it too slowly.
fn smoother_of_finest<T: Real>(matrix: &BlockMatrix<T>, threads: usize) -> Chebyshev<T> {
    let by_blocks = Chebyshev::new(matrix, None, threads);
    if by_blocks.largest <= SLOW {
        return by_blocks;
    }
    let patches = Patches::of(matrix, MOST_IN_PATCH);
    match patches.count() as f64 <= PATCHES * matrix.rows() as f64 {
        true => Chebyshev::new(matrix, Some(patches), threads),
        false => by_blocks,
    }
}

impl<T: Real> Hierarchy<T> {
    pub fn new(matrix: &SymmetricMatrix, near_null: &NearNullSpace, threads: usize) -> Result<Self, FactorError> {
        let hierarchy = Self::with_steps(matrix, near_null, threads, 1)?;
        if !hierarchy.is_slow() {
            return Ok(hierarchy);
        }
        drop(hierarchy);
        let mut hierarchy = Self::with_steps(matrix, near_null, threads, MOST_STEPS)?;
        hierarchy.suit_degree();
        Ok(hierarchy)
    }

    /// The levels; if the finest smoother works on patches, `steps` of it smooth the first prolongator.
    fn with_steps(
        matrix: &SymmetricMatrix,
        near_null: &NearNullSpace,
        threads: usize,
        steps: usize,
    ) -> Result<Self, FactorError> {
        let (nodes, mut blocks, exact, shift) = Nodes::of::<T>(matrix, threads);
        let count = near_null.count();
        let mut candidates = Candidates { count, values: vec![0.0; nodes.size * nodes.count * count] };
        for (index, vector) in near_null.vectors().iter().enumerate() {
            for ((place, unit), &value) in nodes.places().zip(vector) {
                candidates.values[place * count + index] = ldexp(value, -unit);
            }
        }
        let mut levels = Vec::new();
        let mut threshold = THRESHOLD;
        while blocks.rows() * blocks.height > COARSEST {
            let smoother = match levels.is_empty() {
                true => smoother_of_finest(&blocks, threads),
                false => Chebyshev::new(&blocks, None, threads),
            };
            let lines = if smoother.has_patches() { None } else { Lines::of(&blocks) };
            let gathered = match &lines {
                Some(lines) => Some((lines.of_node.clone(), lines.aggregates)),
                None => gathered(&blocks, count, &mut threshold),
            };
            let Some((of_node, aggregates)) = gathered else { break };
            let (flat, coarse) = tentative(&blocks, &candidates, &of_node, aggregates);
            drop(of_node);
            let moved = match lines {
                Some(lines) => lines.product(&blocks, &flat, &candidates, &coarse),
                None => blocks.product(&flat, threads),
            };
            let prolongator = match smoother.has_patches() {
                true => smoothed_in_steps(flat, moved, (&blocks, &smoother), steps, threads),
                false => smoothed(&flat, moved, &smoother, threads),
            };
            candidates = coarse;
            if levels.is_empty() && !blocks.is_shared() {
                blocks.keep_half();
            }
            let mut next = prolongator.galerkin_product(&blocks, threads);
            fill_empty_diagonal(&mut next);
            let near_null = candidates.clone();
            levels.push(Arc::new(Level { matrix: blocks, smoother, prolongator, near_null }));
            blocks = next;
            threshold /= 2.0;
        }
        let coarsest = Arc::new(Coarsest::of(&blocks, true)?);
        let (coarsest_matrix, spare) = (Arc::new(blocks), Spare::default());
        Ok(Hierarchy { nodes, shift, exact, levels, coarsest_matrix, coarsest, threads, spare })
    }

    /// The product of the matrix of which the hierarchy was built with the displacements `u` of the dofs, in double
    /// precision; a vector of `work`. `None` if the matrix is better read entry by entry.
    pub fn product(&self, u: &[f64], work: &Spare<f64>) -> Option<Vec<f64>> {
        let exact = self.exact.as_ref()?;
        let places_of_all = exact.rows() * exact.height;
        let (mut x, mut y) = (work.zeros(places_of_all), work.take(places_of_all));
        self.nodes.places().zip(u).for_each(|((place, unit), &u)| x[place] = ldexp(u, -unit));
        Operator::whole(exact, self.threads, work).mul_into(&x, &mut y);
        let mut product = work.take(u.len());
        let of_dofs = self.nodes.places().zip(&mut product);
        of_dofs.for_each(|((place, unit), own)| *own = ldexp(y[place], -unit - self.shift));
        [x, y].into_iter().for_each(|vector| work.give(vector));
        Some(product)
    }

    /// The hierarchy of the second level, which shares the levels; `None` if there is only one.
    pub fn below(&self) -> Option<Self> {
        let (_, rest) = self.levels.split_first()?;
        let matrix = rest.first().map_or(&*self.coarsest_matrix, |level| &level.matrix);
        Some(Hierarchy {
            nodes: Nodes::in_order(matrix.height, matrix.rows()),
            shift: 0,
            exact: None,
            levels: rest.to_vec(),
            coarsest_matrix: Arc::clone(&self.coarsest_matrix),
            coarsest: Arc::clone(&self.coarsest),
            threads: self.threads,
            spare: Spare::default(),
        })
    }

    pub fn matrices(&self) -> impl Iterator<Item = &BlockMatrix<T>> {
        self.levels.iter().map(|level| &level.matrix).chain([&*self.coarsest_matrix])
    }

    pub fn unknowns(&self) -> Vec<usize> {
        self.matrices().map(|matrix| matrix.rows() * matrix.height).collect()
    }

    pub fn bytes(&self) -> usize {
        let of_level =
            |level: &Arc<Level<T>>| level.matrix.bytes() + level.prolongator.bytes() + level.smoother.inverse.bytes();
        let of_exact = self.exact.as_ref().map_or(0, BlockMatrix::bytes);
        self.levels.iter().map(of_level).sum::<usize>() + of_exact + size_of::<f64>() * self.coarsest.cholesky.entries()
    }
}

/// Pivots of the coarsest matrix below this many units in the last place are rounding: the body is not supported. The
/// diagonal of the matrix is of order one.
const LEAST_PIVOT: f64 = 1000.0;

/// Shift that then holds the body, on a diagonal of order one: about as stiff as a coarse cell, as its contact will be.
const SHIFT: f64 = 1e-3;

#[derive(Debug)]
pub(super) struct Coarsest {
    analysis: Analysis,
    cholesky: Cholesky,
    equilibration: Equilibration,
    /// The matrix was singular to the precision of its entries.
    pub is_shifted: bool,
}

impl Coarsest {
    /// Factorises a coarsest matrix, with its zeros if a face will change them. One that is singular to the precision
    /// of its entries is held by a shift.
    pub fn of<T: Real>(blocks: &BlockMatrix<T>, with_zeros: bool) -> Result<Self, FactorError> {
        let matrix = lower_part(blocks, with_zeros);
        let analysis = Analysis::of(&matrix)?;
        Self::factorised::<T>(&matrix, analysis)
    }

    fn factorised<T: Real>(matrix: &SymmetricMatrix, analysis: Analysis) -> Result<Self, FactorError> {
        let equilibration = Equilibration::of(matrix);
        let (cholesky, is_shifted) = match analysis.factor_equilibrated(matrix, &equilibration) {
            Ok(cholesky) if cholesky.smallest_pivot() > LEAST_PIVOT * T::EPSILON => (cholesky, false),
            Ok(_) | Err(FactorError::NotPositiveDefinite) => {
                let shifted = equilibration.apply(matrix).shifted_factor(SHIFT)?;
                (shifted.ok_or(FactorError::NotPositiveDefinite)?, true)
            }
            Err(error) => return Err(error),
        };
        Ok(Coarsest { analysis, cholesky, equilibration, is_shifted })
    }

    /// Factorises the coarsest `matrix`, of which this is the factor, minus `change`, the reduction by a face. Unknowns
    /// with a diagonal entry that is only rounding do not move.
    pub fn in_face<T: Real>(&self, matrix: &BlockMatrix<T>, change: &BlockMatrix<T>) -> Result<Self, FactorError> {
        let mut rest = matrix.plus(-1.0, change);
        let size = rest.height;
        let diagonal = |blocks: &BlockMatrix<T>, unknown: usize| {
            let place = blocks.diagonal_place(unknown / size);
            place.map_or(0.0, |place| blocks.block(place)[unknown % size * (size + 1)].double())
        };
        let lost = |unknown: usize| diagonal(&rest, unknown) <= LOST_DIAGONAL * T::EPSILON * diagonal(matrix, unknown);
        let is_gone: Vec<bool> = (0..rest.rows() * size).map(lost).collect();
        for node in 0..rest.rows() {
            for place in rest.starts[node]..rest.starts[node + 1] {
                for entry in 0..size * size {
                    let (row, column) =
                        (node * size + entry / size, rest.indices[place] as usize * size + entry % size);
                    if is_gone[row] || is_gone[column] {
                        rest.values[place * size * size + entry] = T::of(f64::from(u8::from(row == column)));
                    }
                }
            }
        }
        // Without the unknowns that are gone, another order has less fill.
        match rest.indices.len() == matrix.indices.len() && !is_gone.contains(&true) {
            true => Self::factorised::<T>(&lower_part(&rest, true), self.analysis.clone()),
            false => Self::of(&rest, false),
        }
    }

    pub fn solve(&self, force: &[f64]) -> Vec<f64> {
        let scale = &self.equilibration.diagonal;
        let scaled: Vec<f64> =
            force.iter().zip(scale).map(|(&f, &d)| ldexp(f, d + self.equilibration.factor)).collect();
        self.cholesky.solve(&scaled).iter().zip(scale).map(|(&u, &d)| ldexp(u, d)).collect()
    }
}

/// The matrix of the blocks, one unknown after another; zeros beside the diagonal may be left out.
pub(super) fn lower_part<T: Real>(blocks: &BlockMatrix<T>, with_zeros: bool) -> SymmetricMatrix {
    let size = blocks.height;
    let dim = blocks.rows() * size;
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    // The matrix is symmetric: row `node` of blocks is column `node`.
    for column in 0..dim {
        for (other, block) in blocks.row(column / size) {
            for (row, value) in (other * size..).zip(&block[column % size * size..][..size]) {
                if row >= column && (row == column || with_zeros || *value != T::default()) {
                    rows.push(row as u32);
                    values.push(value.double());
                }
            }
        }
        starts.push(rows.len());
    }
    SymmetricMatrix::from_sorted_lower(SparseMatrix::from_parts(dim, starts, rows, values))
}
