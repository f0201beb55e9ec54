//! [`SparseMatrix`] from and to the compressed columns of nalgebra.

use nalgebra_sparse::{CooMatrix, CscMatrix};

use crate::SparseMatrix;
use crate::error::Error;

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
impl From<&SparseMatrix> for CscMatrix<f64> {
    fn from(matrix: &SparseMatrix) -> Self {
        let mut entries = CooMatrix::new(matrix.rows(), matrix.columns());
        matrix.triplets().for_each(|(row, column, value)| entries.push(row, column, value));
        CscMatrix::from(&entries)
    }
}

impl TryFrom<&CscMatrix<f64>> for SparseMatrix {
    type Error = Error;

    /// The same matrix, places of zeros included.
    fn try_from(matrix: &CscMatrix<f64>) -> Result<Self, Error> {
        let (starts, rows, values) = matrix.csc_data();
        SparseMatrix::from_csc(matrix.nrows(), starts.to_vec(), rows.to_vec(), values.to_vec())
    }
}
