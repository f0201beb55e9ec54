//! The lower triangle of a symmetric matrix given with both triangles, in one pass.
//!
//! The columns are walked from the first to the last. An entry (r, c) above the diagonal, r < c, has its mirror image
//! in column r, which was walked before. As c grows, the mirror images of row r come in the order of column r: only a
//! cursor for each column must be kept.

use super::columns::{Columns, Taken};
use super::{SparseMatrix, check_rows};
use crate::error::Error;

/// Two triangles count as equal if mirrored entries differ by at most this times the larger diagonal entry of their row
/// and column: assembly in another order differs by rounding, and 1e-10 is far above it.
const SYMMETRY_TOLERANCE: f64 = 1e-10;

/// A symmetric matrix that takes its columns, or its rows, with both triangles, one after another: its lower triangle
/// under construction.
pub struct SymmetricLines {
    dim: usize,
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
    /// For each column, the entry below the diagonal with the next mirror image.
    cursor: Vec<usize>,
    taken: Taken,
    /// An entry has no mirror image.
    is_one_sided: bool,
}

impl<S: Copy + TryInto<usize>, R: Copy + TryInto<usize>> Columns<'_, S, R> {
    /// The entries on and below the diagonal, of the values of the triangle `taken`, and `true` if a negligible entry
    /// has no mirror image.
    pub fn walked(self, taken: Taken) -> Result<(SparseMatrix, bool), Error> {
        let mut lines = SymmetricLines::new(self.starts.len().saturating_sub(1), self.values.len(), taken)?;
        self.each(|_, rows, values| lines.take(rows, values))?;
        lines.matched()
    }
}

/// An empty vector with room for this number of entries.
fn with_room<T>(entries: usize) -> Result<Vec<T>, Error> {
    let (mut room, step) = (Vec::new(), "copying a matrix");
    let asked = room.try_reserve_exact(entries);
    asked.map(|()| room).map_err(|error| Error::Numerical { step, reason: error.to_string() })
}

impl SymmetricLines {
    /// Before the first of `dim` rows with this number of entries in all.
    pub fn of_rows(dim: usize, entries: usize) -> Result<Self, Error> {
        Self::new(dim, entries, Taken::Upper)
    }

    fn new(dim: usize, entries: usize, taken: Taken) -> Result<Self, Error> {
        check_rows(dim)?;
        let room = entries / 2 + dim;
        let mut starts = with_room(dim + 1)?;
        starts.push(0);
        let (rows, values, cursor) = (with_room(room)?, with_room(room)?, with_room(dim)?);
        Ok(SymmetricLines { dim, starts, rows, values, cursor, taken, is_one_sided: false })
    }

    /// The lower triangle; a negligible entry may be in one triangle only.
    pub fn lower(self) -> Result<SparseMatrix, Error> {
        Ok(self.matched()?.0)
    }

    /// Takes the next row or column: indices from 0, increasing, and values. Keeps what lies on and below the diagonal
    /// of a column, and compares what lies above.
    pub fn take<R: Copy + TryInto<usize>>(&mut self, rows: &[R], values: &[f64]) -> Result<(), Error> {
        let (column, start) = (self.cursor.len(), self.rows.len());
        self.taken.check((self.dim, self.dim), column, rows, values)?;
        let index = |row: &R| (*row).try_into().unwrap_or(usize::MAX);
        let above = rows.partition_point(|row| index(row) < column);
        let has_diagonal = rows.get(above).map(index) == Some(column);
        let diagonal = if has_diagonal { values[above].abs() } else { 0.0 };
        for (row, &value) in rows[..above].iter().zip(values) {
            self.compare((index(row), column), value, diagonal)?;
        }
        self.rows.extend(rows[above..].iter().map(|row| index(row) as u32));
        self.values.extend_from_slice(&values[above..]);
        self.starts.push(self.rows.len());
        self.cursor.push(start + usize::from(has_diagonal));
        Ok(())
    }

    /// Compares an entry above the diagonal with its mirror image in column `row`, which the cursor then passes;
    /// `diagonal` is the size of the diagonal entry of its column.
    fn compare(&mut self, (row, column): (usize, usize), value: f64, diagonal: f64) -> Result<(), Error> {
        let end = self.starts[row + 1];
        // A column before this one had no entry in that row.
        while self.cursor[row] < end && (self.rows[self.cursor[row]] as usize) < column {
            self.alone(row)?;
        }
        let place = self.cursor[row];
        if place == end || self.rows[place] as usize != column {
            self.is_one_sided = true;
            return self.alike((column, row), [0.0, value], diagonal);
        }
        self.cursor[row] += 1;
        let below = self.values[place];
        if self.taken == Taken::Upper {
            self.values[place] = value;
        }
        if below == value { Ok(()) } else { self.alike((column, row), [below, value], diagonal) }
    }

    /// The lower triangle, and `true` if an entry has no mirror image; such entries must be negligible.
    fn matched(mut self) -> Result<(SparseMatrix, bool), Error> {
        for column in 0..self.cursor.len() {
            while self.cursor[column] < self.starts[column + 1] {
                self.alone(column)?;
            }
        }
        Ok((SparseMatrix::from_parts(self.dim, self.starts, self.rows, self.values), self.is_one_sided))
    }

    /// The next entry below the diagonal of `column` has no mirror image.
    fn alone(&mut self, column: usize) -> Result<(), Error> {
        self.is_one_sided = true;
        let place = self.cursor[column];
        self.cursor[column] += 1;
        let row = self.rows[place] as usize;
        self.alike((row, column), [self.values[place], 0.0], self.diagonal(row))
    }

    /// The size of the diagonal entry of a column that was walked.
    fn diagonal(&self, column: usize) -> f64 {
        let place = self.starts[column];
        let is_there = place < self.starts[column + 1] && self.rows[place] as usize == column;
        if is_there { self.values[place].abs() } else { 0.0 }
    }

    /// Makes sure that an entry below the diagonal and its mirror image differ by rounding at most; `diagonal` is the
    /// size of the diagonal entry of its row.
    fn alike(&self, (row, column): (usize, usize), values: [f64; 2], diagonal: f64) -> Result<(), Error> {
        let [value, mirrored] = values;
        let size = self.diagonal(column).max(diagonal);
        let scale = if size > 0.0 { size } else { value.abs().max(mirrored.abs()) };
        if (value - mirrored).abs() > SYMMETRY_TOLERANCE * scale {
            let (value, mirrored) = self.taken.place(value, mirrored);
            return Err(Error::NotSymmetric { row, column, value, mirrored });
        }
        Ok(())
    }
}
