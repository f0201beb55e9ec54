//! [`SparseMatrix`] from and to the compressed columns of faer and of nalgebra.

#[cfg(feature = "faer")]
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMat};
#[cfg(feature = "nalgebra")]
use nalgebra_sparse::{CooMatrix, CscMatrix};

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
#[cfg(feature = "faer")]
impl From<&SparseMatrix> for SparseColMat<usize, f64> {
    fn from(matrix: &SparseMatrix) -> Self {
        let (starts, rows) = (matrix.column_starts().to_vec(), matrix.row_indices().map(|row| row as usize).collect());
        let pattern = SymbolicSparseColMat::new_checked(matrix.rows(), matrix.columns(), starts, None, rows);
        SparseColMat::new(pattern, matrix.values().to_vec())
    }
}

#[cfg(feature = "faer")]
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

/// ```
/// use nalgebra_sparse::CscMatrix;
/// use signorini_linear::SparseMatrix;
///
/// // [1 0 0; 2 3 0]
/// let matrix = SparseMatrix::from_csc(2, vec![0, 2, 3, 3], vec![0, 1, 1], vec![1.0, 2.0, 3.0])?;
/// let mut of_nalgebra: CscMatrix<f64> = (&matrix).into();
/// assert_eq!((of_nalgebra.nrows(), of_nalgebra.ncols(), of_nalgebra.nnz()), (2, 3, 3));
/// assert_eq!(SparseMatrix::try_from(&of_nalgebra)?, matrix);
/// of_nalgebra.values_mut()[1] = f64::NAN;
/// assert!(SparseMatrix::try_from(&of_nalgebra).unwrap_err().to_string().contains("(1, 0)"));
/// # Ok::<(), signorini_linear::Error>(())
/// ```
#[cfg(feature = "nalgebra")]
impl From<&SparseMatrix> for CscMatrix<f64> {
    fn from(matrix: &SparseMatrix) -> Self {
        let mut entries = CooMatrix::new(matrix.rows(), matrix.columns());
        matrix.triplets().for_each(|(row, column, value)| entries.push(row, column, value));
        CscMatrix::from(&entries)
    }
}

#[cfg(feature = "nalgebra")]
impl TryFrom<&CscMatrix<f64>> for SparseMatrix {
    type Error = Error;

    /// The same matrix, places of zeros included.
    fn try_from(matrix: &CscMatrix<f64>) -> Result<Self, Error> {
        let (starts, rows, values) = matrix.csc_data();
        SparseMatrix::from_csc(matrix.nrows(), starts.to_vec(), rows.to_vec(), values.to_vec())
    }
}
