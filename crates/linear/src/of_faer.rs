//! [`SparseMatrix`] from and to the compressed columns of faer.

use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMat};

use crate::SparseMatrix;
use crate::error::Error;

/// ```
/// use faer::sparse::SparseColMat;
/// use signorini_linear::SparseMatrix;
///
/// // [1 0 0; 2 3 0]
/// let matrix = SparseMatrix::from_csc(2, vec![0, 2, 3, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0])?;
/// let mut of_faer: SparseColMat<usize, f64> = (&matrix).into();
/// assert_eq!((of_faer.nrows(), of_faer.ncols(), of_faer.compute_nnz()), (2, 3, 3));
/// assert_eq!(SparseMatrix::try_from(of_faer.as_ref())?, matrix);
/// of_faer.val_mut()[1] = f64::NAN;
/// assert!(SparseMatrix::try_from(of_faer.as_ref()).unwrap_err().to_string().contains("(1, 0)"));
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
