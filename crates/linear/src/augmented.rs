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
        let mut search = EntrySearch::of(matrix);
        let (mut row_starts, mut products) = (vec![0], Vec::new());
        for row in 0..by_row.columns() {
            products.extend(by_row.square(row).map(|(second, first, product)| {
                let (Ok(place) | Err(place)) = search.place(first, second);
                (matrix.column_starts()[first] + place, product)
            }));
            row_starts.push(products.len());
        }
        Squares::Products { row_starts, products }
    }

    /// Adds B' diag(weight(i)) B to the `values` of the entries of `matrix`.
    fn add_to(&self, values: &mut [f64], matrix: &SparseMatrix, weight: impl Fn(usize) -> f64) {
        match self {
            Squares::Products { row_starts, products } => {
                for (row, places) in row_starts.windows(2).enumerate() {
                    let factor = weight(row);
                    if factor != 0.0 {
                        for &(entry, product) in &products[places[0]..places[1]] {
                            values[entry] += factor * product;
                        }
                    }
                }
            }
            Squares::Rows(by_row) => {
                let mut row_values = vec![0.0; by_row.rows()];
                for row in 0..by_row.columns() {
                    let factor = weight(row);
                    if factor == 0.0 {
                        continue;
                    }
                    by_row.column(row).for_each(|(dof, b)| row_values[dof] = b);
                    for (dof, b) in by_row.column(row) {
                        let below = matrix.column_rows(dof);
                        let column = &mut values[matrix.column_starts()[dof]..][..below.len()];
                        column
                            .iter_mut()
                            .zip(below)
                            .for_each(|(value, &i)| *value += factor * b * row_values[i as usize]);
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
    /// Joins the patterns of K (n x n) and B (m x n) and analyses them once.
    pub fn new(stiffness: &SymmetricMatrix, rows: &SparseMatrix) -> Result<Self, FactorError> {
        Self::analysed(stiffness, rows, Analysis::of)
    }

    /// As [`AugmentedMatrix::new`], with the columns of `last` eliminated last.
    pub fn with_last(stiffness: &SymmetricMatrix, rows: &SparseMatrix, last: &[usize]) -> Result<Self, FactorError> {
        Self::analysed(stiffness, rows, |joined| Analysis::with_last(joined, last))
    }

    /// As [`AugmentedMatrix::new`], with an available `analysis` of K, if K has a place for every entry.
    pub fn with_analysis(
        stiffness: &SymmetricMatrix,
        rows: &SparseMatrix,
        analysis: Analysis,
    ) -> Result<Self, FactorError> {
        let entries = stiffness.lower().entries();
        let of_joined = |joined: &SymmetricMatrix| {
            if joined.lower().entries() == entries { Ok(analysis) } else { Analysis::of(joined) }
        };
        Self::analysed(stiffness, rows, of_joined)
    }

    fn analysed(
        stiffness: &SymmetricMatrix,
        rows: &SparseMatrix,
        analyse: impl FnOnce(&SymmetricMatrix) -> Result<Analysis, FactorError>,
    ) -> Result<Self, FactorError> {
        let by_row = rows.transposed();
        let stiffness = with_places(stiffness.lower(), rows, &by_row);
        let squares = Squares::of(by_row, &stiffness);
        let analysis = analyse(&SymmetricMatrix::from_sorted_lower(stiffness.clone()))?;
        Ok(Self { stiffness, squares, analysis })
    }

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
        let made = || {
            let matrix = match analysis {
                Some(analysis) => AugmentedMatrix::with_analysis(stiffness, rows, analysis.clone()),
                None => AugmentedMatrix::new(stiffness, rows),
            };
            Ok(matrix?.with_threads(*threads))
        };
        self.matrix.get_or_init(made).as_ref().map_err(FactorError::clone)
    }
}

/// A lower triangle with a place, zero if it had none, for every entry of B'B and of the diagonal; the same memory if
/// nothing was missing. B is given by columns and by rows.
fn with_places(lower: &SparseMatrix, rows: &SparseMatrix, by_row: &SparseMatrix) -> SparseMatrix {
    let missing = missing_places(lower, rows, by_row);
    if missing.is_empty() {
        return lower.clone();
    }
    let entries = lower.entries() + missing.len();
    let (mut starts, mut indices, mut values) = (vec![0], Vec::with_capacity(entries), Vec::with_capacity(entries));
    let mut missing = missing.into_iter().peekable();
    for column in 0..lower.columns() {
        // The last turn takes the places after the last entry.
        for entry in lower.column(column).map(Some).chain([None]) {
            let before = entry.map_or(usize::MAX, |entry| entry.0);
            while let Some((_, row)) = missing.next_if(|place| place.0 == column && place.1 < before) {
                indices.push(row as u32);
                values.push(0.0);
            }
            indices.extend(entry.map(|entry| entry.0 as u32));
            values.extend(entry.map(|entry| entry.1));
        }
        starts.push(indices.len());
    }
    SparseMatrix::from_parts(lower.rows(), starts, indices, values)
}

/// The places `(column, row)` of B'B and of the diagonal that a lower triangle lacks, in their order. Rows that share
/// many dofs are not searched again once a column is full.
fn missing_places(lower: &SparseMatrix, rows: &SparseMatrix, by_row: &SparseMatrix) -> Vec<(usize, usize)> {
    let mut missing = Vec::new();
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
            missing.push((column, column));
        }
        for &row in acting {
            if known.len() + missing.len() - first == lower.columns() - column {
                break;
            }
            for &dof in by_row.column_rows(row as usize).iter().filter(|&&dof| dof as usize > column) {
                if std::mem::replace(&mut met[dof as usize], column) != column {
                    missing.push((column, dof as usize));
                }
            }
        }
        missing[first..].sort_unstable();
    }
    missing
}

/// A search for entries of a matrix, which are mostly asked for in their order: down a column, one after the other.
struct EntrySearch<'a> {
    matrix: &'a SparseMatrix,
    /// The entry that was asked for last, and the place after it in its column.
    last: Option<(usize, usize)>,
    next: usize,
}

impl<'a> EntrySearch<'a> {
    fn of(matrix: &'a SparseMatrix) -> Self {
        EntrySearch { matrix, last: None, next: 0 }
    }

    /// The place of an entry within its column, or the place that it would have.
    fn place(&mut self, column: usize, row: usize) -> Result<usize, usize> {
        let rows = self.matrix.column_rows(column);
        let from = if self.last.is_some_and(|last| last.0 == column && last.1 < row) { self.next } else { 0 };
        let place = match rows.get(from) {
            Some(&next) if next as usize == row => Ok(from),
            _ => rows[from..].binary_search(&(row as u32)).map(|place| from + place).map_err(|place| from + place),
        };
        (self.last, self.next) = (Some((column, row)), place.map_or_else(|place| place, |place| place + 1));
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_found_in_any_order() {
        let rows = [vec![0, 1, 4, 7], vec![], vec![2, 3, 8]];
        let entries: Vec<_> = rows
            .iter()
            .enumerate()
            .flat_map(|(column, rows)| rows.iter().map(move |&row| (row, column, 1.0)))
            .collect();
        let matrix = SparseMatrix::from_triplets(9, 3, &entries).unwrap();
        let mut search = EntrySearch::of(&matrix);
        // Down each column, then every entry after every other.
        let all: Vec<_> = (0..3).flat_map(|column| (0..9).map(move |row| (column, row))).collect();
        let pairs = all.iter().flat_map(|&first| all.iter().flat_map(move |&second| [first, second]));
        for (column, row) in all.iter().copied().chain(pairs) {
            assert_eq!(search.place(column, row), rows[column].binary_search(&row), "{column} {row}");
        }
    }

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
        let augmented = AugmentedMatrix::new(&stiffness, &contact).unwrap();
        assert!(matches!(augmented.squares, Squares::Rows(_)));
        for (i, j, value) in augmented.matrix(weight, shift).lower().triplets() {
            let squares: f64 = (0..rows).map(|row| weight(row) * b(row, i) * b(row, j)).sum();
            let expected = k(i, j) + squares + if i == j { shift } else { 0.0 };
            // Sums of four products of small integers.
            assert!((value - expected).abs() <= 1e-14 * expected.abs().max(1.0), "{i} {j}: {value} {expected}");
        }
    }
}
