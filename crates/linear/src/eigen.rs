//! The largest eigenvalues of a symmetric positive semidefinite operator, in a block Krylov space that is extended
//! until they converge; the number of negative eigenvalues of a matrix, by the signs of its pivots.

use faer::dyn_stack::MemStack;
use faer::linalg::matmul::matmul;
use faer::sparse::linalg::cholesky::supernodal::{
    SupernodalLdltRef, factorize_supernodal_numeric_ldlt, factorize_supernodal_numeric_ldlt_scratch,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, Mat, MatMut, MatRef, Par, Side};

use super::factor::{FactorError, call, memory, par, zeros};
use super::{Analysis, SymmetricMatrix, generic, largest, norm, take_out};
use crate::error::Error;

/// Number of columns that are added at once: eigenvalues of up to this multiplicity converge together.
const WIDTH: usize = 8;

/// A pair has converged if its residual is at most this share of its eigenvalue: the eigenvalue then has about twice as
/// many digits.
const CONVERGED: f64 = 1e-8;

/// Residuals below this share of the largest eigenvalue are rounding.
const ROUNDING: f64 = 1e-14;

/// A column of which less than this share of the largest eigenvalue is left lies in the space: another direction takes
/// its place.
const DEPENDENT: f64 = 1e-13;

/// The space is extended by at least this share of itself between two looks at its pairs.
const BETWEEN: usize = 8;

/// A column that loses less than this share of its length to the others is orthogonal to them after one pass.
const ORTHOGONAL: f64 = 0.5;

/// A column that keeps less than this share of its length beside the others of its block has lost digits towards the
/// basis.
const SMALL: f64 = 1e-2;

/// Passes after which a column is orthogonal to the working precision, even if the first leaves little of it.
const PASSES: usize = 3;

/// An orthonormal basis V of a space, and the operator in it.
pub struct Krylov<A> {
    /// The product of the operator with columns, one after the other.
    apply: A,
    dim: usize,
    /// Columns of V, each of length `dim`, one after the other.
    basis: Vec<f64>,
    /// V'A V, k x k, symmetric: of each column the entries down to its diagonal, at least.
    projected: Vec<Vec<f64>>,
    /// Number of columns before the last block.
    previous: usize,
    /// The columns that extend the space next, orthonormal, and orthogonal to V.
    next: Vec<f64>,
    /// `A V - V (V'A V)` is `next` times this, in the last columns of V; one list for each of these.
    rest: Vec<Vec<f64>>,
    /// Number of random columns that were taken so far.
    taken: usize,
    par: Par,
}

/// Eigenpairs of the operator in the space, eigenvalues decreasing.
pub struct Pairs {
    /// The eigenvalues, in decreasing order.
    pub values: Vec<f64>,
    /// The norm of `A y - value y` for the unit vector y of each pair.
    pub residuals: Vec<f64>,
    /// The vectors in the basis, k x k, column by column.
    coordinates: Mat<f64>,
}

impl Pairs {
    /// Number of pairs, from the first, that have converged.
    pub fn converged(&self) -> usize {
        let floor = ROUNDING * self.values.first().copied().unwrap_or(0.0);
        let pairs = self.values.iter().zip(&self.residuals);
        pairs.take_while(|(value, residual)| **residual <= CONVERGED * **value + floor).count()
    }
}

impl<A: Fn(&[f64]) -> Vec<f64>> Krylov<A> {
    /// An empty space of an operator of `dim` rows.
    pub fn new(apply: A, dim: usize, par: Par) -> Self {
        let (basis, projected, rest) = (Vec::new(), Vec::new(), Vec::new());
        let mut space = Krylov { apply, dim, basis, projected, previous: 0, next: Vec::new(), rest, taken: 0, par };
        space.widen();
        space
    }

    /// Number of vectors of the basis.
    pub fn columns(&self) -> usize {
        self.projected.len()
    }

    /// Returns `true` if the basis spans the whole space.
    pub fn is_whole(&self) -> bool {
        self.columns() == self.dim
    }

    /// Adds random directions to those that come next: they find what no direction before them contains.
    pub fn widen(&mut self) {
        let mut next = std::mem::take(&mut self.next);
        let room = self.dim - self.columns() - next.len().checked_div(self.dim).unwrap_or(0);
        for _ in 0..WIDTH.min(room) {
            let column = self.fresh(&next);
            next.extend(column);
        }
        self.next = next;
    }

    /// Extends the space by at least `columns`, if there is room.
    pub fn extend(&mut self, columns: usize) {
        let aim = (self.columns() + columns).min(self.dim);
        while self.columns() < aim {
            self.step();
        }
    }

    /// The extension after which it is worth to look at the pairs again, for a search for `wanted` pairs.
    pub fn next_extension(&self, wanted: usize) -> usize {
        (2 * wanted).saturating_sub(self.columns()).max(self.columns() / BETWEEN).max(1)
    }

    /// Adds the next columns and finds those after them.
    fn step(&mut self) {
        let width = self.next.len() / self.dim;
        let known = self.columns();
        self.basis.append(&mut self.next);
        let mut product = (self.apply)(&self.basis[known * self.dim..]);
        let (basis, count) = (std::mem::take(&mut self.basis), known + width);
        // Except for rounding, only the columns of the last two blocks have a share.
        let near = self.without(&basis[self.previous * self.dim..], &mut product);
        let mut shares = self.without(&basis, &mut product);
        let mut of_near = shares.subrows_mut(self.previous, near.nrows());
        of_near += &near;
        self.previous = known;
        self.projected.extend((0..width).map(|column| (0..count).map(|i| shares[(i, column)]).collect::<Vec<f64>>()));
        self.basis = basis;
        let scale = (0..count).fold(0.0, |most: f64, i| most.max(self.projected[i][i].abs()));
        (self.next, self.rest) = self.orthonormal(product, width.min(self.dim - count), scale);
    }

    /// Takes the part along the basis out of some columns; returns the shares, `V' columns`.
    fn without(&self, basis: &[f64], columns: &mut [f64]) -> Mat<f64> {
        let (count, width) = (basis.len() / self.dim, columns.len() / self.dim);
        let basis = MatRef::from_column_major_slice(basis, self.dim, count);
        let mut shares = Mat::zeros(count, width);
        let mut columns = MatMut::from_column_major_slice_mut(columns, self.dim, width);
        matmul(shares.as_mut(), Accum::Replace, basis.transpose(), columns.as_ref(), 1.0, self.par);
        matmul(columns.as_mut(), Accum::Add, basis, shares.as_ref(), -1.0, self.par);
        shares
    }

    /// `count` orthonormal columns that span those given, and the coordinates of each given column in them. A column
    /// that lies in the span of those before it is replaced by a random one.
    fn orthonormal(&mut self, mut columns: Vec<f64>, count: usize, scale: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (mut found, mut coordinates): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        for column in columns.chunks_mut(self.dim) {
            let mut shares = vec![0.0; count];
            let before = norm(column);
            for pass in 0..2 {
                for (share, other) in shares.iter_mut().zip(found.chunks(self.dim)) {
                    *share += take_out(column, other);
                }
                if pass == 0 && norm(column) > ORTHOGONAL * before {
                    break;
                }
            }
            let length = norm(column);
            let place = found.len() / self.dim;
            match place < count && length > DEPENDENT * scale {
                true => {
                    shares[place] = length;
                    column.iter_mut().for_each(|value| *value /= length);
                    if length < SMALL * before {
                        // What was rounding of the others is large now.
                        self.clean(column, &found);
                    }
                    found.extend_from_slice(column);
                }
                false if place < count => found.extend(self.fresh(&found)),
                false => {}
            }
            coordinates.push(shares);
        }
        (found, coordinates)
    }

    /// A random unit vector that is orthogonal to the basis and to `others`.
    fn fresh(&mut self, others: &[f64]) -> Vec<f64> {
        let mut column = generic(self.dim, self.taken);
        self.taken += 1;
        self.clean(&mut column, others);
        column
    }

    /// Makes a column a unit vector that is orthogonal to the basis and to `others`.
    fn clean(&self, column: &mut [f64], others: &[f64]) {
        for _ in 0..PASSES {
            for other in self.basis.chunks(self.dim).chain(others.chunks(self.dim)) {
                take_out(column, other);
            }
            let length = norm(column);
            column.iter_mut().for_each(|value| *value /= length);
        }
    }

    /// The eigenpairs of the operator in the space.
    pub fn pairs(&self) -> Result<Pairs, Error> {
        let count = self.columns();
        let matrix = Mat::from_fn(count, count, |i, j| self.projected[j.max(i)][i.min(j)]);
        let found =
            call(|| matrix.self_adjoint_eigen(Side::Lower).map_err(|error| FactorError::Failed(format!("{error:?}"))))?;
        // faer sorts them in increasing order.
        let (values, vectors) = (found.S(), found.U());
        let values: Vec<f64> = (0..count).rev().map(|place| values[place]).collect();
        let coordinates = Mat::from_fn(count, count, |i, j| vectors[(i, count - 1 - j)]);
        let first = count - self.rest.len();
        let height = self.rest.first().map_or(0, Vec::len);
        let residual = |pair: usize| {
            let entry = |i: usize| {
                let of_columns = self.rest.iter().enumerate();
                of_columns.map(|(column, rest)| rest[i] * coordinates[(first + column, pair)]).sum::<f64>()
            };
            (0..height).map(|i| entry(i).powi(2)).sum::<f64>().sqrt()
        };
        let residuals = (0..count).map(residual).collect();
        Ok(Pairs { values, residuals, coordinates })
    }

    /// The first `count` vectors of pairs of this space, each of length n, one after the other.
    pub fn vectors(&self, pairs: &Pairs, count: usize) -> Vec<f64> {
        let basis = MatRef::from_column_major_slice(&self.basis, self.dim, self.columns());
        let mut vectors = vec![0.0; self.dim * count];
        let target = MatMut::from_column_major_slice_mut(&mut vectors, self.dim, count);
        matmul(target, Accum::Replace, basis, pairs.coordinates.subcols(0, count), 1.0, self.par);
        vectors
    }
}

/// A solution with the factor leaves at most this share of its load, if the pivots are those of the matrix and not of
/// rounding.
const ACCURATE: f64 = 1e-6;

/// Number of negative eigenvalues of `matrix`, by the pattern in `analysis`; `None` if rounding hides it, or if the
/// analysis has no block columns.
///
/// By Sylvester's law of inertia a factorisation L D L' has as many negative eigenvalues in D. Nothing is exchanged, so
/// that a small pivot may spoil it. The pivots are exactly those of a matrix A + E. A random load b excites the
/// eigenvector of A + E that is nearest to singular by the inverse of its eigenvalue; if the solution leaves little of
/// b, E is small beside that eigenvalue, and no sign is that of rounding.
pub fn negative_eigenvalues(
    analysis: &Analysis,
    matrix: &SymmetricMatrix,
    threads: usize,
) -> Result<Option<usize>, Error> {
    let Some(nodes) = analysis.supernodes() else { return Ok(None) };
    let (dim, par) = (matrix.dim(), par(threads));
    let permuted = analysis.permuted(matrix.lower(), |_, _, value| value);
    let mut values = zeros(nodes.len_val())?;
    let load: Vec<f64> = generic(dim, 0);
    let mut solution: Vec<f64> = analysis.order().iter().map(|&column| load[column]).collect();
    let work = || {
        let of_factor = factorize_supernodal_numeric_ldlt_scratch::<usize, f64>(nodes, par, Default::default());
        let mut buffer = memory(of_factor.or(nodes.solve_in_place_scratch::<f64>(1, par)))?;
        let structure = SymbolicSparseColMatRef::new_unsorted_checked(dim, dim, &permuted.starts, None, &permuted.rows);
        let done = factorize_supernodal_numeric_ldlt(
            &mut values,
            SparseColMatRef::new(structure, &permuted.values),
            Default::default(),
            nodes,
            par,
            MemStack::new(&mut buffer),
            Default::default(),
        );
        if done.is_err() {
            return Ok(None);
        }
        let factor = SupernodalLdltRef::new(nodes, &values);
        let of_node = |node: usize| {
            let block = factor.supernode(node).val();
            (0..block.ncols()).filter(|&column| block[(column, column)] < 0.0).count()
        };
        let negative: usize = (0..nodes.n_supernodes()).map(of_node).sum();
        let columns = MatMut::from_column_major_slice_mut(&mut solution, dim, 1);
        factor.solve_in_place_with_conj(Conj::No, columns, par, MemStack::new(&mut buffer));
        Ok(Some(negative))
    };
    let Some(negative) = call(work)? else { return Ok(None) };
    let mut x = vec![0.0; dim];
    analysis.order().iter().zip(&solution).for_each(|(&column, &value)| x[column] = value);
    let left: Vec<f64> = matrix.mul(&x).iter().zip(&load).map(|(product, load)| product - load).collect();
    Ok((largest(&left) <= ACCURATE * largest(&load)).then_some(negative))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SparseMatrix;

    #[test]
    fn a_factor_without_block_columns_counts_nothing() {
        let entry = |row: usize, column: usize| if row == column { 2.0 } else { 1.0 };
        let entries: Vec<_> = (0..8).flat_map(|row| (0..=row).map(move |at| (row, at, entry(row, at)))).collect();
        let matrix = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(8, 8, &entries).unwrap()).unwrap();
        let analysis = Analysis::of(&matrix).unwrap();
        assert_eq!(negative_eigenvalues(&analysis, &matrix, 1).unwrap(), None);
    }
}
