//! The levels, and one cycle through them.

use super::aggregation::aggregate;
use super::blocks::BlockMatrix;
use super::chebyshev::Chebyshev;
use super::face::FaceLevels;
use super::near_null::NearNullSpace;
use super::nodes::{Nodes, fill_empty_diagonal};
use super::operator::Operator;
use super::prolongator::{Candidates, smoothed, tentative};
use super::real::Real;
use crate::qp::linear::{Cholesky, Equilibration, FactorError, SparseMatrix, SymmetricMatrix, ldexp};

/// Strength of connection on the finest level; it is halved from level to level, as the source has it.
const THRESHOLD: f64 = 0.02;

/// Where too few connections are strong for aggregates to form, all count below this.
const LEAST_THRESHOLD: f64 = 1e-3;

/// Degree of the smoothing polynomial, before and after the coarse correction.
const DEGREE: usize = 3;

/// Unknowns that are factorised at once.
const COARSEST: usize = 1500;

/// A level with more than this share of the nodes above it is not worth its work: the matrix is factorised there.
const LEAST_COARSENING: f64 = 0.4;

/// What the smoothing of the prolongator takes of the inverse of the largest eigenvalue.
const PROLONGATOR_STEP: f64 = 4.0 / 3.0;

/// Pivots of the coarsest matrix, whose diagonal is of order one, below so many units in the last place are rounding: a
/// body that nothing holds.
const LEAST_PIVOT: f64 = 1000.0;

/// What then holds it, on a diagonal of order one: its contact will, about as stiffly as a coarse cell.
const SHIFT: f64 = 1e-3;

/// A hierarchy of levels in one precision.
#[derive(Debug)]
pub struct Hierarchy<T> {
    pub(super) nodes: Nodes,
    /// The matrix times `2^shift` has a diagonal of order one.
    shift: i32,
    pub(super) levels: Vec<Level<T>>,
    /// The matrix of the coarsest level, and its factor.
    pub(super) coarsest_matrix: BlockMatrix<T>,
    coarsest: Coarsest,
    pub(super) threads: usize,
}

#[derive(Debug)]
pub(super) struct Level<T> {
    pub matrix: BlockMatrix<T>,
    pub smoother: Chebyshev<T>,
    pub prolongator: BlockMatrix<T>,
    pub restriction: BlockMatrix<T>,
}

/// The factor of a coarsest matrix.
#[derive(Debug)]
pub(super) struct Coarsest {
    cholesky: Cholesky,
    equilibration: Equilibration,
    is_shifted: bool,
}

impl<T: Real> Hierarchy<T> {
    /// Builds the levels of `matrix`.
    ///
    /// # Errors
    /// [`FactorError`] where the coarsest matrix has a negative eigenvalue, or memory does not suffice for its factor.
    pub fn new(matrix: &SymmetricMatrix, near_null: &NearNullSpace, threads: usize) -> Result<Self, FactorError> {
        let (nodes, mut blocks, shift) = Nodes::of::<T>(matrix);
        let count = near_null.count();
        let mut candidates = Candidates { count, values: vec![0.0; nodes.size * nodes.count * count] };
        for (index, vector) in near_null.vectors().iter().enumerate() {
            for (&place, &value) in nodes.place.iter().zip(vector) {
                candidates.values[place as usize * count + index] = value;
            }
        }
        let mut levels = Vec::new();
        let mut threshold = THRESHOLD;
        while blocks.rows() * blocks.height > COARSEST {
            let most = (LEAST_COARSENING * (blocks.rows() * blocks.height) as f64) as usize;
            let (mut of_node, mut aggregates) = aggregate(&blocks, threshold);
            while aggregates * count > most && threshold > 0.0 {
                threshold = if threshold > LEAST_THRESHOLD { threshold / 4.0 } else { 0.0 };
                (of_node, aggregates) = aggregate(&blocks, threshold);
            }
            if aggregates * count > most {
                break;
            }
            let smoother = Chebyshev::new(&blocks, DEGREE, threads);
            let (flat, coarse) = tentative::<T>(&candidates, blocks.height, &of_node, aggregates);
            drop(of_node);
            let moved = blocks.product(&flat, threads);
            let prolongator = smoothed(&flat, moved, &smoother.inverse, PROLONGATOR_STEP / smoother.largest, threads);
            drop(flat);
            let restriction = prolongator.transposed();
            let mut next = restriction.product(&blocks.product(&prolongator, threads), threads);
            fill_empty_diagonal(&mut next);
            levels.push(Level { matrix: blocks, smoother, prolongator, restriction });
            (blocks, candidates) = (next, coarse);
            threshold /= 2.0;
        }
        let coarsest = Coarsest::of(&blocks)?;
        Ok(Hierarchy { nodes, shift, levels, coarsest_matrix: blocks, coarsest, threads })
    }

    /// Approximately `A^-1 r`, by one V-cycle, in the face that is given; r is `force` times `2^exponent`.
    pub fn cycle(&self, force: &[f64], exponent: i32, face: Option<&FaceLevels<T>>) -> Vec<f64> {
        let mut rest = self.nodes.gather::<T>(force, exponent);
        if let Some(face) = face {
            face.held.subtract_from(&mut rest);
        }
        let moved = self.descend(0, rest, face);
        self.nodes.scatter(&moved, self.shift - exponent)
    }

    fn descend(&self, depth: usize, mut rest: Vec<T>, face: Option<&FaceLevels<T>>) -> Vec<T> {
        let Some(level) = self.levels.get(depth) else {
            let force: Vec<f64> = rest.iter().map(|value| value.double()).collect();
            let coarsest = face.map_or(&self.coarsest, |face| &face.coarsest);
            let mut x: Vec<T> = coarsest.solve(&force).into_iter().map(T::of).collect();
            if let Some(held) = face.filter(|_| depth == 0).map(|face| &face.held) {
                held.subtract_from(&mut x);
            }
            return x;
        };
        let operator = Operator {
            matrix: &level.matrix,
            held: face.filter(|_| depth == 0).map(|face| &face.held),
            change: face.and_then(|face| face.changes.get(depth.wrapping_sub(1))),
            threads: self.threads,
        };
        let smoother = face.and_then(|face| face.smoothers.get(depth.wrapping_sub(1))).unwrap_or(&level.smoother);
        let mut x = vec![T::default(); rest.len()];
        let force = rest.clone();
        smoother.smooth(&operator, &mut x, &mut rest, true);
        let mut restricted = vec![T::default(); level.restriction.rows() * level.restriction.height];
        level.restriction.mul_into(&rest, &mut restricted, self.threads);
        let correction = self.descend(depth + 1, restricted, face);
        let mut moved = rest;
        level.prolongator.mul_into(&correction, &mut moved, self.threads);
        operator.project(&mut moved);
        operator.add(&moved, &mut x);
        operator.mul_into(&x, &mut moved);
        let mut rest = force;
        operator.subtract(&moved, &mut rest);
        smoother.smooth(&operator, &mut x, &mut rest, false);
        x
    }

    /// Unknowns of each level, the finest first.
    pub fn unknowns(&self) -> Vec<usize> {
        let of_level = |level: &Level<T>| level.matrix.rows() * level.matrix.height;
        let coarsest = self.coarsest_matrix.rows() * self.coarsest_matrix.height;
        self.levels.iter().map(of_level).chain([coarsest]).collect()
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let of_level = |level: &Level<T>| {
            level.matrix.bytes() + level.prolongator.bytes() + level.restriction.bytes() + level.smoother.bytes()
        };
        self.levels.iter().map(of_level).sum::<usize>() + size_of::<f64>() * self.coarsest.cholesky.entries()
    }

    /// Did the coarsest matrix have to be held, as that of a body without supports?
    pub fn is_shifted(&self) -> bool {
        self.coarsest.is_shifted()
    }
}

impl Coarsest {
    pub fn of<T: Real>(blocks: &BlockMatrix<T>) -> Result<Self, FactorError> {
        let matrix = lower_part(blocks);
        let equilibration = Equilibration::of(&matrix);
        let matrix = equilibration.apply(&matrix);
        match Cholesky::of(&matrix) {
            Ok(cholesky) if cholesky.smallest_pivot() > LEAST_PIVOT * T::EPSILON => {
                Ok(Coarsest { cholesky, equilibration, is_shifted: false })
            }
            Ok(_) | Err(FactorError::NotPositiveDefinite) => {
                let mut lower = matrix.lower().clone();
                let held = lower.triplets().map(|(i, j, v)| if i == j { v + SHIFT } else { v }).collect();
                lower = lower.with_values(held);
                let cholesky = Cholesky::of(&SymmetricMatrix::from_sorted_lower(lower))?;
                Ok(Coarsest { cholesky, equilibration, is_shifted: true })
            }
            Err(error) => Err(error),
        }
    }

    /// Was it singular to the precision of its entries, so that it had to be held?
    pub fn is_shifted(&self) -> bool {
        self.is_shifted
    }

    fn solve(&self, force: &[f64]) -> Vec<f64> {
        let scale = &self.equilibration.diagonal;
        let scaled: Vec<f64> =
            force.iter().zip(scale).map(|(&f, &d)| ldexp(f, d + self.equilibration.factor)).collect();
        self.cholesky.solve(&scaled).iter().zip(scale).map(|(&u, &d)| ldexp(u, d)).collect()
    }
}

fn lower_part<T: Real>(blocks: &BlockMatrix<T>) -> SymmetricMatrix {
    let size = blocks.height;
    let dim = blocks.rows() * size;
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    // The matrix is symmetric: row `node` of blocks is column `node`.
    for node in 0..blocks.rows() {
        for j in 0..size {
            let column = node * size + j;
            for (other, block) in blocks.row(node) {
                for i in 0..size {
                    let row = other * size + i;
                    let value = block[j * size + i].double();
                    if row >= column && (value != 0.0 || row == column) {
                        rows.push(row);
                        values.push(value);
                    }
                }
            }
            starts.push(rows.len());
        }
    }
    SymmetricMatrix::from_sorted_lower(SparseMatrix::from_parts(dim, starts, rows, values))
}
