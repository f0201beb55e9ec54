//! The coarsest level: a Cholesky factor, shifted if nothing holds the body.

use super::blocks::BlockMatrix;
use crate::real::Real;
use crate::{Analysis, Cholesky, Equilibration, FactorError, SparseMatrix, SymmetricMatrix, ldexp};

/// Pivots of the coarsest matrix below this many units in the last place are rounding: the body is not supported. The
/// diagonal of the matrix is of order one.
const LEAST_PIVOT: f64 = 1000.0;

/// A diagonal entry reduced below this many units in the last place has lost its digits, because the face reduces it on
/// this level and on those above.
pub(super) const LOST_DIAGONAL: f64 = 3000.0;

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
                let other = rest.indices[place] as usize;
                for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))) {
                    if is_gone[node * size + i] || is_gone[other * size + j] {
                        let one = f64::from(u8::from(node == other && i == j));
                        rest.values[(place * size + i) * size + j] = T::of(one);
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

    pub fn entries(&self) -> usize {
        self.cholesky.entries()
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
    for node in 0..blocks.rows() {
        for j in 0..size {
            let column = node * size + j;
            for (other, block) in blocks.row(node) {
                for i in 0..size {
                    let row = other * size + i;
                    let value = block[j * size + i].double();
                    if row >= column && (row == column || with_zeros || value != 0.0) {
                        rows.push(row as u32);
                        values.push(value);
                    }
                }
            }
            starts.push(rows.len());
        }
    }
    SymmetricMatrix::from_sorted_lower(SparseMatrix::from_parts(dim, starts, rows, values))
}
