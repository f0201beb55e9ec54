//! The rows of a symmetric matrix, with both triangles, from the stored triangle.
//!
//! The lower triangle is stored column by column: the entries of a row right of its diagonal are one column of the
//! triangle, those on the left are spread over the previous columns. A cursor for each column gives its next entry, and
//! the columns with their next entry in the same row are linked in a list.

use super::SymmetricMatrix;

/// No column follows in a list.
const NONE: u32 = u32::MAX;

impl SymmetricMatrix {
    /// Number of entries in each row, both triangles.
    pub fn row_lengths(&self) -> Vec<u32> {
        let mut lengths: Vec<u32> = (0..self.dim()).map(|row| self.lower().column_rows(row).len() as u32).collect();
        self.lower().triplets().filter(|entry| entry.0 != entry.1).for_each(|(row, _, _)| lengths[row] += 1);
        lengths
    }

    /// Calls `take(columns, values)` for each row, from the first on, with its columns in their order. In addition to
    /// the matrix this takes 16 bytes for each row.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn each_row<E>(&self, mut take: impl FnMut(&[u32], &[f64]) -> Result<(), E>) -> Result<(), E> {
        // The next entry of each column, counted in the column.
        let mut next = vec![0; self.dim()];
        let (mut first_in, mut following) = (vec![NONE; self.dim()], vec![NONE; self.dim()]);
        let (mut columns_of_row, mut values_of_row) = (Vec::new(), Vec::new());
        for row in 0..self.dim() {
            columns_of_row.clear();
            values_of_row.clear();
            let mut column = first_in[row];
            while column != NONE {
                columns_of_row.push(column);
                column = following[column as usize];
            }
            columns_of_row.sort_unstable();
            // The diagonal entry is not in a list: it belongs to the right side.
            let (rows, values) = self.lower().column_slices(row);
            next[row] += usize::from(rows.first() == Some(&(row as u32)));
            for &column in &columns_of_row {
                let place = &mut next[column as usize];
                values_of_row.push(self.lower().column_slices(column as usize).1[*place]);
                *place += 1;
            }
            columns_of_row.push(row as u32);
            for &column in &columns_of_row {
                if let Some(&row) = self.lower().column_rows(column as usize).get(next[column as usize]) {
                    following[column as usize] = std::mem::replace(&mut first_in[row as usize], column);
                }
            }
            columns_of_row.pop();
            columns_of_row.extend_from_slice(rows);
            values_of_row.extend_from_slice(values);
            take(&columns_of_row, &values_of_row)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SparseMatrix;

    /// A matrix with short and long rows, some without a diagonal.
    fn matrix(dim: usize, reach: usize) -> SymmetricMatrix {
        let mut entries = Vec::new();
        for column in 0..dim {
            for row in column..dim.min(column + reach) {
                if (7 * row + 3 * column) % 5 != 0 {
                    entries.push((row, column, (row * dim + column) as f64));
                }
            }
        }
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dim, dim, &entries).unwrap()).unwrap()
    }

    #[test]
    fn rows_are_those_of_both_triangles() {
        for (dim, reach) in [(0, 1), (1, 1), (9, 9), (40_000, 30), (1700, 1700)] {
            let matrix = matrix(dim, reach);
            let (lower, upper) = (matrix.lower().transposed(), matrix.lower());
            let lengths = matrix.row_lengths();
            let mut row = 0;
            let taken: Result<(), ()> = matrix.each_row(|columns, values| {
                let left = lower.column(row).filter(|entry| entry.0 < row);
                let expected: Vec<(u32, f64)> = left.chain(upper.column(row)).map(|(c, v)| (c as u32, v)).collect();
                let found: Vec<(u32, f64)> = columns.iter().copied().zip(values.iter().copied()).collect();
                assert_eq!((found.len(), &found), (lengths[row] as usize, &expected), "row {row} of {dim}");
                row += 1;
                Ok(())
            });
            assert_eq!((taken, row), (Ok(()), dim));
        }
    }
}
