//! The number of negative eigenvalues of a symmetric matrix, by the signs of its pivots.

use faer::dyn_stack::MemStack;
use faer::sparse::linalg::cholesky::supernodal::{
    SupernodalLdltRef, factorize_supernodal_numeric_ldlt, factorize_supernodal_numeric_ldlt_scratch,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut};

use super::super::factor::{memory, zeros};
use super::super::{Analysis, SymmetricMatrix, call, generic, largest, par};
use crate::error::Error;

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
