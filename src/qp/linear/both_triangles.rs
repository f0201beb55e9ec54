//! The lower triangle of a symmetric matrix given with both triangles, in one pass.
//!
//! The columns are walked from the first to the last. An entry (r, c) above the diagonal, r < c, has its mirror image in column
//! r, which was walked before. As c grows, the mirror images of row r come in the order of column r: only a cursor for each column must be
//! kept.

use super::SparseMatrix;
use crate::error::Error;

/// Two triangles count as equal if mirrored entries differ by at most this times the larger diagonal entry of their row and column:
/// assembly in another order differs by rounding, and 1e-10 is far above it.
const SYMMETRY_TOLERANCE: f64 = 1e-10;

/// Compressed columns with indices of any type, as given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns<'a, I> {
    pub starts: &'a [I],
    pub rows: &'a [I],
    pub values: &'a [f64],
}

/// The triangle that gives the values if mirrored entries differ by rounding: the lower one for columns, the upper one for rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Taken {
    Lower,
    Upper,
}

/// A symmetric matrix that takes its rows, with both triangles, one after another.
pub struct SymmetricRows {
    lower: Lower,
}

impl SymmetricRows {
    /// Before the first of `dim` rows with this number of entries in all.
    ///
    /// # Errors
    /// [`Error::Numerical`] if memory does not suffice.
    pub fn new(dim: usize, entries: usize) -> Result<Self, Error> {
        Ok(SymmetricRows { lower: Lower::new(dim, entries, Taken::Upper)? })
    }

    /// Takes the next row: columns from 0, increasing, and values.
    ///
    /// # Errors
    /// [`Error::Pattern`], [`Error::IndexOutOfRange`], [`Error::NotFinite`]; [`Error::NotSymmetric`] for an entry that differs from
    /// its mirror image in a row before.
    pub fn take(&mut self, columns: &[u32], values: &[f64]) -> Result<(), Error> {
        self.lower.take(columns, values)
    }

    /// The lower triangle; a negligible entry may be in one triangle only.
    ///
    /// # Errors
    /// [`Error::NotSymmetric`] for an entry of the upper triangle without a mirror image.
    pub fn lower(mut self) -> Result<SparseMatrix, Error> {
        self.lower.all_matched()?;
        Ok(self.lower.into_matrix())
    }
}

/// The lower triangle under construction.
struct Lower {
    dim: usize,
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    /// For each column, the entry below the diagonal with the next mirror image.
    cursor: Vec<usize>,
    taken: Taken,
    /// An entry has no mirror image.
    is_one_sided: bool,
}

impl<I: Copy + TryInto<usize>> Columns<'_, I> {
    /// The lower triangle.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Pattern`] and [`Error::IndexOutOfRange`] for arrays that are no sorted columns,
    /// [`Error::NotFinite`], [`Error::NotSymmetric`].
    pub fn lower(self) -> Result<SparseMatrix, Error> {
        Ok(self.walked(Taken::Lower)?.into_matrix())
    }

    /// The transposed upper triangle; `None` if a negligible entry is on one side of the diagonal only.
    ///
    /// # Errors
    /// As [`Columns::lower`].
    pub fn upper(self) -> Result<Option<SparseMatrix>, Error> {
        let upper = self.walked(Taken::Upper)?;
        Ok((!upper.is_one_sided).then(|| upper.into_matrix()))
    }

    /// The entries on and below the diagonal, of the values of the triangle `taken`.
    fn walked(self, taken: Taken) -> Result<Lower, Error> {
        let (dim, entries) = (self.starts.len().saturating_sub(1), self.values.len());
        if self.rows.len() != entries {
            let (name, found) = ("row indices", self.rows.len());
            return Err(Error::Length { name, found, expected: entries, of: "values" });
        }
        if self.start(0)? != 0 || self.start(dim)? != entries {
            let message = format!("the column starts must begin with 0 and end with the number of values, {entries}");
            return Err(Error::Pattern { message });
        }
        let mut lower = Lower::new(dim, entries, taken)?;
        let mut first = 0;
        for column in 0..dim {
            let end = self.start(column + 1)?;
            let (Some(rows), Some(values)) = (self.rows.get(first..end), self.values.get(first..end)) else {
                let message = format!("the column starts decrease after column {column} (indices from 0)");
                return Err(Error::Pattern { message });
            };
            lower.take(rows, values)?;
            first = end;
        }
        lower.all_matched()?;
        Ok(lower)
    }

    fn start(&self, column: usize) -> Result<usize, Error> {
        let start = self.starts.get(column).and_then(|&start| start.try_into().ok());
        start.ok_or_else(|| Error::Pattern { message: format!("the start of column {column} is no index (from 0)") })
    }
}

/// An entry of the matrix.
struct Entry {
    row: usize,
    column: usize,
    value: f64,
}

/// An empty vector with room for this number of entries.
fn with_room<T>(entries: usize) -> Result<Vec<T>, Error> {
    let mut room = Vec::new();
    match room.try_reserve_exact(entries) {
        Ok(()) => Ok(room),
        Err(error) => Err(Error::Numerical { step: "copying a matrix", reason: error.to_string() }),
    }
}

impl Lower {
    /// Before the first of `dim` lines with this number of entries in all.
    fn new(dim: usize, entries: usize, taken: Taken) -> Result<Self, Error> {
        let room = entries / 2 + dim;
        let mut starts = with_room(dim + 1)?;
        starts.push(0);
        let (rows, values, cursor) = (with_room(room)?, with_room(room)?, with_room(dim)?);
        Ok(Lower { dim, starts, rows, values, cursor, taken, is_one_sided: false })
    }

    fn into_matrix(self) -> SparseMatrix {
        SparseMatrix::from_parts(self.dim, self.starts, self.rows, self.values)
    }

    /// Takes the entries of the next column on and below the diagonal, and compares those above.
    fn take<I: Copy + TryInto<usize>>(&mut self, rows: &[I], values: &[f64]) -> Result<(), Error> {
        let column = self.cursor.len();
        let (start, mut above, mut least) = (self.rows.len(), 0, 0);
        for (&row, &value) in rows.iter().zip(values) {
            let Ok(row) = row.try_into() else { break };
            if !(least..column).contains(&row) || !value.is_finite() {
                break;
            }
            if !self.is_mirrored(row, column, value) {
                self.compare(Entry { row, column, value }, || diagonal_of(column, rows, values))?;
            }
            (above, least) = (above + 1, row + 1);
        }
        // All other entries are taken at once, and checked afterwards.
        let of_rest = &values[above..];
        self.rows.extend(rows[above..].iter().map(|&row| row.try_into().unwrap_or(usize::MAX)));
        self.values.extend_from_slice(of_rest);
        let rest = &self.rows[start..];
        let lies_below = rest.first().is_none_or(|&row| row >= column) && rest.last().is_none_or(|&row| row < self.dim);
        let increases = rest.windows(2).all(|pair| pair[0] < pair[1]);
        if !(lies_below && increases && of_rest.iter().all(|value| value.is_finite())) {
            return Err(self.fault(rows, values));
        }
        self.starts.push(self.rows.len());
        let has_diagonal = self.rows.get(start) == Some(&column);
        self.cursor.push(start + usize::from(has_diagonal));
        Ok(())
    }

    /// Returns `true` if an entry above the diagonal equals its mirror image; the cursor then passes the mirror image.
    fn is_mirrored(&mut self, row: usize, column: usize, value: f64) -> bool {
        let place = self.cursor[row];
        let is_next = place < self.starts[row + 1] && self.rows[place] == column;
        let is_same = is_next && self.values[place].to_bits() == value.to_bits();
        self.cursor[row] += usize::from(is_same);
        is_same
    }

    /// The error of the next column, with rows that do not increase or lie outside, or with values that are not finite.
    #[cold]
    fn fault<I: Copy + TryInto<usize>>(&self, rows: &[I], values: &[f64]) -> Error {
        let (dim, column) = (self.dim, self.cursor.len());
        let [line, entry] = self.taken.words();
        let mut before = None;
        for (&row, &value) in rows.iter().zip(values) {
            let Ok(row) = row.try_into() else { break };
            let place = self.taken.place(row, column);
            if row >= dim {
                return Error::IndexOutOfRange { row: place.0, column: place.1, rows: dim, columns: dim };
            }
            if let Some(before) = before.filter(|&before| before >= row) {
                let where_to = format!("{entry} {row} of {line} {column} does not lie beyond {entry} {before}");
                return Error::Pattern { message: format!("{where_to}, the one before (indices from 0)") };
            }
            before = Some(row);
            if !value.is_finite() {
                return Error::NotFinite { name: "matrix", at: format!("{place:?}"), value, allowed: "finite" };
            }
        }
        Error::Pattern { message: format!("a {entry} of {line} {column} is negative (indices from 0)") }
    }

    /// Compares an entry above the diagonal with its mirror image in column `row`.
    fn compare(&mut self, above: Entry, diagonal: impl Fn() -> f64) -> Result<(), Error> {
        let Entry { row, column, value } = above;
        let mirror = |value: f64| Entry { row: column, column: row, value };
        let end = self.starts[row + 1];
        loop {
            let place = self.cursor[row];
            if place >= end || self.rows[place] > column {
                self.is_one_sided = true;
                return self.alike(mirror(0.0), value, diagonal());
            }
            self.cursor[row] += 1;
            let below = self.values[place];
            if self.rows[place] == column {
                if value.to_bits() == below.to_bits() {
                    return Ok(());
                }
                if self.taken == Taken::Upper {
                    self.values[place] = value;
                }
                return self.alike(mirror(below), value, diagonal());
            }
            // A column before this one had no entry in that row.
            self.alone(place, row)?;
        }
    }

    /// Entries without a mirror image must be negligible.
    fn all_matched(&mut self) -> Result<(), Error> {
        for column in 0..self.cursor.len() {
            for place in self.cursor[column]..self.starts[column + 1] {
                self.alone(place, column)?;
            }
        }
        Ok(())
    }

    /// An entry below the diagonal of `column` that has no mirror image.
    fn alone(&mut self, place: usize, column: usize) -> Result<(), Error> {
        self.is_one_sided = true;
        let row = self.rows[place];
        self.alike(Entry { row, column, value: self.values[place] }, 0.0, self.diagonal(row))
    }

    /// The size of the diagonal entry of a column that was walked.
    fn diagonal(&self, column: usize) -> f64 {
        let place = self.starts[column];
        let is_there = place < self.starts[column + 1] && self.rows[place] == column;
        if is_there { self.values[place].abs() } else { 0.0 }
    }

    /// Makes sure that an entry below the diagonal and its mirror image differ by rounding at most; `diagonal` is the size of the
    /// diagonal entry of its row.
    fn alike(&self, below: Entry, mirrored: f64, diagonal: f64) -> Result<(), Error> {
        let Entry { row, column, value } = below;
        let size = self.diagonal(column).max(diagonal);
        let scale = if size > 0.0 { size } else { value.abs().max(mirrored.abs()) };
        if (value - mirrored).abs() > SYMMETRY_TOLERANCE * scale {
            let (value, mirrored) = self.taken.place(value, mirrored);
            return Err(Error::NotSymmetric { row, column, value, mirrored });
        }
        Ok(())
    }
}

impl Taken {
    /// A walked line of the matrix is a row or a column; this names its entries in errors.
    fn words(self) -> [&'static str; 2] {
        match self {
            Taken::Lower => ["column", "row"],
            Taken::Upper => ["row", "column"],
        }
    }

    /// Row and column of an entry, or of a pair of mirrored entries, in a line that is walked as a column.
    fn place<T>(self, row: T, column: T) -> (T, T) {
        match self {
            Taken::Lower => (row, column),
            Taken::Upper => (column, row),
        }
    }
}

/// The size of the diagonal entry of a column that is being walked.
fn diagonal_of<I: Copy + TryInto<usize>>(column: usize, rows: &[I], values: &[f64]) -> f64 {
    let place = rows.iter().position(|&row| row.try_into().ok() == Some(column));
    place.map_or(0.0, |place| values[place].abs())
}
