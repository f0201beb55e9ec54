//! K + t I + B' diag(w) B for many weights w and shifts t: one pattern, one analysis.

use std::sync::OnceLock;

use super::{Analysis, Cholesky, FactorError, SparseMatrix, SymmetricMatrix};

/// A symmetric matrix K and rows B; the weighted squares of the rows are added to K.
///
/// The pattern holds K, the diagonal and every row of B, so that a change of the weights costs a numeric
/// factorisation and nothing else.
#[derive(Clone, Debug)]
pub struct AugmentedMatrix {
    /// K with a place for each entry of B'B and of the diagonal. Every column begins with its diagonal.
    stiffness: SparseMatrix,
    squares: Squares,
    analysis: Analysis,
}

/// The squares b b' of the rows b of B.
#[derive(Clone, Debug)]
enum Squares {
    /// Row i of B adds `products[k].1 * w_i` to entry `products[k].0`, for k in `row_starts[i]..row_starts[i + 1]`.
    Products { row_starts: Vec<usize>, products: Vec<(usize, f64)> },
    /// B', if the rows would have more products than the matrix has entries.
    Rows(SparseMatrix),
}

impl Squares {
    /// The squares of the columns of `by_row`, in a matrix that has a place for each of their products.
    fn of(by_row: SparseMatrix, matrix: &SparseMatrix) -> Self {
        let of_row = |row: usize| triangle(by_row.column(row).count());
        if (0..by_row.columns()).map(of_row).sum::<usize>() > matrix.entries() {
            return Squares::Rows(by_row);
        }
        let (mut row_starts, mut products) = (vec![0], Vec::new());
        for row in 0..by_row.columns() {
            products.extend(by_row.square(row).map(|(second, first, product)| {
                let place = matrix.column_rows(first).partition_point(|&row| (row as usize) < second);
                (matrix.column_starts()[first] + place, product)
            }));
            row_starts.push(products.len());
        }
        Squares::Products { row_starts, products }
    }

    /// Adds B' diag(weight(i)) B to the `values` of the entries of `matrix`.
    fn add_to(&self, values: &mut [f64], matrix: &SparseMatrix, weight: impl Fn(usize) -> f64) {
        let weighted = |rows: usize| (0..rows).map(|row| (row, weight(row))).filter(|entry| entry.1 != 0.0);
        match self {
            Squares::Products { row_starts, products } => {
                for (row, factor) in weighted(row_starts.len() - 1) {
                    let of_row = &products[row_starts[row]..row_starts[row + 1]];
                    of_row.iter().for_each(|&(entry, product)| values[entry] += factor * product);
                }
            }
            Squares::Rows(by_row) => {
                let mut row_values = vec![0.0; by_row.rows()];
                for (row, factor) in weighted(by_row.columns()) {
                    by_row.column(row).for_each(|(dof, b)| row_values[dof] = b);
                    for (dof, b) in by_row.column(row) {
                        let below = matrix.column_rows(dof);
                        let column = values[matrix.column_starts()[dof]..].iter_mut().zip(below);
                        column.for_each(|(value, &i)| *value += factor * b * row_values[i as usize]);
                    }
                    by_row.column(row).for_each(|(dof, _)| row_values[dof] = 0.0);
                }
            }
        }
    }
}

fn triangle(columns: usize) -> usize {
    columns * (columns + 1) / 2
}

impl AugmentedMatrix {
    /// Joins the patterns of K (n x n) and B (m x n) and analyses them once; an available `analysis` of K is kept if K
    /// has a place for every entry.
    pub fn new(
        stiffness: &SymmetricMatrix,
        rows: &SparseMatrix,
        analysis: Option<&Analysis>,
    ) -> Result<Self, FactorError> {
        let entries = stiffness.lower().entries();
        Self::analysed(stiffness, rows, |joined| match analysis {
            Some(analysis) if joined.lower().entries() == entries => Ok(analysis.clone()),
            _ => Analysis::of(joined),
        })
    }

    /// The same with the columns of `last` (in any order) eliminated last.
    pub fn with_last(stiffness: &SymmetricMatrix, rows: &SparseMatrix, last: &[usize]) -> Result<Self, FactorError> {
        Self::analysed(stiffness, rows, |joined| Analysis::with_last(joined, last))
    }

    fn analysed(
        stiffness: &SymmetricMatrix,
        rows: &SparseMatrix,
        analyse: impl FnOnce(&SymmetricMatrix) -> Result<Analysis, FactorError>,
    ) -> Result<Self, FactorError> {
        let by_row = rows.transposed();
        let joined = match missing_places(stiffness.lower(), rows, &by_row) {
            missing if missing.entries() == 0 => stiffness.clone(),
            missing => stiffness
                .combined(1.0, 0.0, &SymmetricMatrix::from_sorted_lower(missing))
                .map_err(|error| FactorError::Failed(error.to_string()))?,
        };
        let (squares, analysis) = (Squares::of(by_row, joined.lower()), analyse(&joined)?);
        Ok(Self { stiffness: joined.lower().clone(), squares, analysis })
    }

    /// The same with factors on so many threads.
    pub fn with_threads(self, threads: usize) -> Self {
        AugmentedMatrix { analysis: self.analysis.with_threads(threads), ..self }
    }

    /// The order and structure of their factors.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// The matrix K + shift I + B' diag(weight(i)) B.
    pub fn matrix(&self, weight: impl Fn(usize) -> f64, shift: f64) -> SymmetricMatrix {
        let mut values = self.stiffness.values().to_vec();
        self.squares.add_to(&mut values, &self.stiffness, weight);
        if shift != 0.0 {
            for &start in &self.stiffness.column_starts()[..self.stiffness.columns()] {
                values[start] += shift;
            }
        }
        SymmetricMatrix::from_sorted_lower(self.stiffness.with_values(values))
    }

    /// Factorises a matrix that [`AugmentedMatrix::matrix`] returned, and frees it.
    pub fn factor(&self, matrix: SymmetricMatrix) -> Result<Cholesky, FactorError> {
        self.analysis.factor_last(matrix)
    }
}

/// The augmented matrix of a stiffness and rows, joined and analysed at its first use.
#[derive(Clone, Debug)]
pub struct Augmented {
    stiffness: SymmetricMatrix,
    rows: SparseMatrix,
    /// The analysis of the stiffness, if it may serve.
    analysis: Option<Analysis>,
    threads: usize,
    matrix: OnceLock<Result<AugmentedMatrix, FactorError>>,
}

impl Augmented {
    /// That of K (n x n) and B (m x n), factorised with this number of threads; an `analysis` of K is kept if K has a
    /// place for every entry.
    pub fn new(stiffness: &SymmetricMatrix, rows: &SparseMatrix, analysis: Option<Analysis>, threads: usize) -> Self {
        Augmented { stiffness: stiffness.clone(), rows: rows.clone(), analysis, threads, matrix: OnceLock::new() }
    }

    /// A matrix that is analysed already.
    pub fn of(stiffness: &SymmetricMatrix, rows: &SparseMatrix, matrix: AugmentedMatrix) -> Self {
        Augmented { matrix: OnceLock::from(Ok(matrix)), ..Self::new(stiffness, rows, None, 1) }
    }

    /// The augmented matrix, analysed when it is first asked for.
    pub fn matrix(&self) -> Result<&AugmentedMatrix, FactorError> {
        let Augmented { stiffness, rows, analysis, threads, .. } = self;
        let made = || Ok(AugmentedMatrix::new(stiffness, rows, analysis.as_ref())?.with_threads(*threads));
        self.matrix.get_or_init(made).as_ref().map_err(FactorError::clone)
    }
}

/// Zeros at the places of B'B and of the diagonal that a lower triangle lacks; B is given by columns and by rows. Rows
/// that share many dofs are not searched again once a column is full.
fn missing_places(lower: &SparseMatrix, rows: &SparseMatrix, by_row: &SparseMatrix) -> SparseMatrix {
    let (mut starts, mut missing) = (vec![0], Vec::new());
    // The last column in which each row was met.
    let mut met = vec![usize::MAX; lower.columns()];
    for column in 0..lower.columns() {
        let (first, known) = (missing.len(), lower.column_rows(column));
        let acting = rows.column_rows(column);
        if !acting.is_empty() {
            known.iter().for_each(|&row| met[row as usize] = column);
        }
        if known.first() != Some(&(column as u32)) {
            met[column] = column;
            missing.push(column as u32);
        }
        for &row in acting {
            if known.len() + missing.len() - first == lower.columns() - column {
                break;
            }
            for &dof in by_row.column_rows(row as usize).iter().filter(|&&dof| dof as usize > column) {
                if std::mem::replace(&mut met[dof as usize], column) != column {
                    missing.push(dof);
                }
            }
        }
        missing[first..].sort_unstable();
        starts.push(missing.len());
    }
    let zeros = vec![0.0; missing.len()];
    SparseMatrix::from_parts(lower.rows(), starts, missing, zeros)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_rows_are_added_without_a_list_of_their_products() {
        let (dofs, rows, shift) = (5, 4, 0.5);
        let b = |row: usize, dof: usize| ((3 * row + 2 * dof) % 7) as f64 - 3.0;
        let k = |i: usize, j: usize| if i == j { 9.0 } else { 1.0 / (1 + i + j) as f64 };
        let weight = |row: usize| row as f64;
        let all = |of: &dyn Fn(usize, usize) -> f64, count: usize, first: bool| -> Vec<(usize, usize, f64)> {
            let columns = |i: usize| if first { i + 1 } else { dofs };
            (0..count).flat_map(|i| (0..columns(i)).map(move |j| (i, j))).map(|(i, j)| (i, j, of(i, j))).collect()
        };
        let stiffness = SparseMatrix::from_triplets(dofs, dofs, &all(&k, dofs, true)).unwrap();
        let stiffness = SymmetricMatrix::from_lower(stiffness).unwrap();
        let contact = SparseMatrix::from_triplets(rows, dofs, &all(&b, rows, false)).unwrap();
        let augmented = AugmentedMatrix::new(&stiffness, &contact, None).unwrap();
        assert!(matches!(augmented.squares, Squares::Rows(_)));
        for (i, j, value) in augmented.matrix(weight, shift).lower().triplets() {
            let squares: f64 = (0..rows).map(|row| weight(row) * b(row, i) * b(row, j)).sum();
            let expected = k(i, j) + squares + if i == j { shift } else { 0.0 };
            // Sums of four products of small integers.
            assert!((value - expected).abs() <= 1e-14 * expected.abs().max(1.0), "{i} {j}: {value} {expected}");
        }
    }
}
