//! The rows of a symmetric matrix, with both triangles, from the stored triangle.
//!
//! The lower triangle is stored column by column: the entries of a row right of its diagonal are one column of the triangle, those on
//! the left are spread over the previous columns. Some rows at a time are gathered from all columns that reach them. A cursor for each
//! column gives its next entry, and the number of entries left of the diagonal of each row gives the room that the row needs.

use super::SymmetricMatrix;

/// Number of entries in the rows that are gathered at a time, unless one row has more.
const GATHERED: usize = 1 << 19;

/// Gathered consecutive rows.
#[derive(Default)]
struct Gathered {
    /// The first row.
    first: usize,
    /// The present end of each row.
    ends: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// Number of entries in each row, both triangles.
    pub fn row_lengths(&self) -> Vec<u32> {
        let mut lengths = self.lengths_on_the_left();
        lengths.iter_mut().zip(self.lower().column_starts().windows(2)).for_each(|(length, column)| {
            *length += (column[1] - column[0]) as u32;
        });
        lengths
    }

    /// Calls `take(columns, values)` for each row, from the first on, with its columns in their order. In addition to the matrix this
    /// takes 4 + 8 bytes for each row, and 12 bytes for each of half a million entries.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn each_row<E>(&self, mut take: impl FnMut(&[u32], &[f64]) -> Result<(), E>) -> Result<(), E> {
        let left = self.lengths_on_the_left();
        let starts = self.lower().column_starts();
        let mut next: Vec<usize> = starts[..self.dim()].to_vec();
        let mut gathered = Gathered::default();
        let (mut open, mut first) = (0, 0);
        while first < self.dim() {
            let length = |row: usize| left[row] as usize + starts[row + 1] - starts[row];
            let (mut last, mut entries) = (first + 1, length(first));
            while last < self.dim() && entries + length(last) <= GATHERED {
                entries += length(last);
                last += 1;
            }
            gathered.make_room(first, (first..last).map(length));
            // Finished columns are skipped.
            while open < first && next[open] == starts[open + 1] {
                open += 1;
            }
            (open..last).for_each(|column| gathered.add(self, column, &mut next[column]));
            let mut start = 0;
            for &end in &gathered.ends {
                take(&gathered.columns[start..end], &gathered.values[start..end])?;
                start = end;
            }
            first = last;
        }
        Ok(())
    }

    /// Number of entries left of the diagonal in each row.
    fn lengths_on_the_left(&self) -> Vec<u32> {
        let mut lengths = vec![0; self.dim()];
        self.lower().triplets().filter(|entry| entry.0 != entry.1).for_each(|(row, _, _)| lengths[row] += 1);
        lengths
    }
}

impl Gathered {
    /// Starts with the row `first`, for rows of these lengths.
    fn make_room(&mut self, first: usize, lengths: impl Iterator<Item = usize>) {
        self.first = first;
        self.ends.clear();
        let mut room = 0;
        for length in lengths {
            self.ends.push(room);
            room += length;
        }
        // Exactly the room needed: a vector that grows doubles its capacity.
        self.columns.reserve_exact(room.max(GATHERED).saturating_sub(self.columns.len()));
        self.values.reserve_exact(room.max(GATHERED).saturating_sub(self.values.len()));
        self.columns.resize(room, 0);
        self.values.resize(room, 0.0);
    }

    /// Adds the entries of a column of the lower triangle in these rows, from its entry `next` on. If its own
    /// row is one of these rows, adds also the entries right of the diagonal there.
    fn add(&mut self, matrix: &SymmetricMatrix, column: usize, next: &mut usize) {
        let (rows, values) = (matrix.lower().row_indices(), matrix.lower().values());
        let (end, last) = (matrix.lower().column_starts()[column + 1], self.first + self.ends.len());
        if column >= self.first {
            for place in *next..end {
                self.push(column, rows[place], values[place]);
            }
            if *next < end && rows[*next] == column {
                *next += 1;
            }
        }
        while *next < end && rows[*next] < last {
            self.push(rows[*next], column, values[*next]);
            *next += 1;
        }
    }

    fn push(&mut self, row: usize, column: usize, value: f64) {
        let place = &mut self.ends[row - self.first];
        self.columns[*place] = column as u32;
        self.values[*place] = value;
        *place += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qp::linear::SparseMatrix;

    /// A matrix with short and long rows, some without a diagonal, with enough rows to be gathered several times.
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
        // The last two matrices have more entries than are gathered at a time.
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
