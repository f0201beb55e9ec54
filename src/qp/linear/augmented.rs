//! K + t I + B' diag(w) B for many weights w and shifts t: one pattern, one analysis.

use super::{Analysis, Cholesky, FactorError, SparseMatrix, SymmetricMatrix};

/// A symmetric matrix K and rows B whose weighted squares are added to it.
///
/// The pattern holds K, the diagonal and every row of B, so that a change of the weights costs a numeric
/// factorisation and nothing else.
#[derive(Clone, Debug)]
pub struct AugmentedMatrix {
    pattern: SparseMatrix,
    stiffness_slots: Vec<usize>,
    diagonal_slots: Vec<usize>,
    /// Row i of B adds `products[k].1 * w_i` to slot `products[k].0`, for k in `row_starts[i]..row_starts[i + 1]`.
    row_starts: Vec<usize>,
    products: Vec<(usize, f64)>,
    stiffness: SparseMatrix,
    analysis: Analysis,
}

impl AugmentedMatrix {
    /// Joins the patterns of K (n x n) and B (m x n) and analyses them once.
    ///
    /// # Errors
    /// As [`Analysis::of`].
    pub fn new(stiffness: &SymmetricMatrix, rows: &SparseMatrix) -> Result<Self, FactorError> {
        Self::with_last(stiffness, rows, &[])
    }

    /// As [`AugmentedMatrix::new`], with the columns of `last` eliminated last.
    ///
    /// # Errors
    /// As [`Analysis::with_last`].
    pub fn with_last(stiffness: &SymmetricMatrix, rows: &SparseMatrix, last: &[usize]) -> Result<Self, FactorError> {
        let dim = stiffness.dim();
        let by_row = rows.transposed();
        let mut squares = Vec::new();
        let mut row_starts = vec![0];
        for row in 0..by_row.columns() {
            for (first, a) in by_row.column(row) {
                for (second, b) in by_row.column(row).filter(|entry| entry.0 >= first) {
                    squares.push((first, second, a * b));
                }
            }
            row_starts.push(squares.len());
        }
        let mut added: Vec<(usize, usize)> = squares.iter().map(|&(first, second, _)| (first, second)).collect();
        added.sort_unstable();
        added.dedup();
        let mut starts = Vec::with_capacity(dim + 1);
        starts.push(0);
        let mut indices = Vec::with_capacity(stiffness.lower().entries() + added.len());
        let mut of_column = Vec::new();
        let mut rest = added.as_slice();
        for column in 0..dim {
            let (here, later) = rest.split_at(rest.partition_point(|place| place.0 == column));
            rest = later;
            of_column.clear();
            of_column.push(column);
            of_column.extend(stiffness.lower().column(column).map(|entry| entry.0));
            of_column.extend(here.iter().map(|place| place.1));
            of_column.sort_unstable();
            of_column.dedup();
            indices.extend_from_slice(&of_column);
            starts.push(indices.len());
        }
        drop(added);
        let slot = |row: usize, column: usize| {
            let range = starts[column]..starts[column + 1];
            starts[column] + indices[range].partition_point(|&index| index < row)
        };
        let stiffness_slots = stiffness.lower().triplets().map(|(row, column, _)| slot(row, column)).collect();
        let diagonal_slots = (0..dim).map(|column| slot(column, column)).collect();
        let products = squares.iter().map(|&(first, second, product)| (slot(second, first), product)).collect();
        let zeros = vec![0.0; indices.len()];
        let pattern = SparseMatrix::from_parts(dim, starts, indices, zeros);
        let analysis = Analysis::with_last(&SymmetricMatrix::from_sorted_lower(pattern.clone()), last)?;
        let stiffness = stiffness.lower().clone();
        Ok(Self { pattern, stiffness_slots, diagonal_slots, row_starts, products, stiffness, analysis })
    }

    /// The same matrices, whose factorisations use so many threads.
    pub fn with_threads(self, threads: usize) -> Self {
        AugmentedMatrix { analysis: self.analysis.with_threads(threads), ..self }
    }

    /// The order and structure of their factors.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// The matrix K + shift I + B' diag(weight(i)) B.
    pub fn matrix(&self, weight: impl Fn(usize) -> f64, shift: f64) -> SymmetricMatrix {
        let mut values = vec![0.0; self.pattern.entries()];
        for (&slot, &value) in self.stiffness_slots.iter().zip(self.stiffness.values()) {
            values[slot] += value;
        }
        for row in 0..self.row_starts.len() - 1 {
            let factor = weight(row);
            if factor != 0.0 {
                for &(slot, product) in &self.products[self.row_starts[row]..self.row_starts[row + 1]] {
                    values[slot] += factor * product;
                }
            }
        }
        if shift != 0.0 {
            for &slot in &self.diagonal_slots {
                values[slot] += shift;
            }
        }
        SymmetricMatrix::from_sorted_lower(self.pattern.with_values(values))
    }

    /// Factorises a matrix that [`AugmentedMatrix::matrix`] returned.
    ///
    /// # Errors
    /// As [`Analysis::factor`].
    pub fn factor(&self, matrix: &SymmetricMatrix) -> Result<Cholesky, FactorError> {
        self.analysis.factor(matrix)
    }
}
