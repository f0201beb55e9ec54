//! [`SparseMatrix`] from and to the compressed columns of faer.

use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMat};

use crate::SparseMatrix;
use crate::error::Error;

/// ```
/// use faer::sparse::SparseColMat;
/// use signorini_linear::SparseMatrix;
///
/// // [1 0; 2 3]
/// let matrix = SparseMatrix::from_csc(2, vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0])?;
/// let of_faer: SparseColMat<usize, f64> = (&matrix).into();
/// assert_eq!(of_faer.compute_nnz(), 3);
/// assert_eq!(SparseMatrix::try_from(of_faer.as_ref())?, matrix);
/// # Ok::<(), signorini_linear::Error>(())
/// ```
impl From<&SparseMatrix> for SparseColMat<usize, f64> {
    fn from(matrix: &SparseMatrix) -> Self {
        let (starts, rows) = (matrix.column_starts().to_vec(), matrix.row_indices().map(|row| row as usize).collect());
        let pattern = SymbolicSparseColMat::new_checked(matrix.rows(), matrix.columns(), starts, None, rows);
        SparseColMat::new(pattern, matrix.values().to_vec())
    }
}

impl TryFrom<SparseColMatRef<'_, usize, f64>> for SparseMatrix {
    type Error = Error;

    /// The same matrix; rows in any order, entries at the same place are added.
    fn try_from(matrix: SparseColMatRef<'_, usize, f64>) -> Result<Self, Error> {
        let of_column = |column| {
            let entries = matrix.symbolic().row_idx_of_col(column).zip(matrix.val_of_col(column));
            entries.map(move |(row, &value)| (row, column, value))
        };
        let triplets: Vec<(usize, usize, f64)> = (0..matrix.ncols()).flat_map(of_column).collect();
        SparseMatrix::from_triplets(matrix.nrows(), matrix.ncols(), &triplets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_comes_back_from_faer_and_one_that_is_not_finite_is_refused() {
        let entries = [(2, 0, 1.5), (0, 1, -2.0), (1, 3, 4.0)];
        let matrix = SparseMatrix::from_triplets(3, 4, &entries).unwrap();
        let of_faer = SparseColMat::from(&matrix);
        assert_eq!((of_faer.nrows(), of_faer.ncols(), of_faer.get(2, 0)), (3, 4, Some(&1.5)));
        assert_eq!(SparseMatrix::try_from(of_faer.as_ref()).unwrap(), matrix);
        let mut broken = of_faer;
        broken.val_mut()[1] = f64::NAN;
        let Err(Error::NotFinite { at, .. }) = SparseMatrix::try_from(broken.as_ref()) else { panic!() };
        assert_eq!(at, "(0, 1)");
    }
}
