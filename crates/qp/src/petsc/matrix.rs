//! The rows of a PETSc matrix, one after another: neither the file nor a second matrix is held in memory.

use std::path::Path;

use super::source::{INTEGER, REAL, Source};
use super::{DENSE, MATRIX, TOO_MANY};
use crate::error::LinearError as Error;

/// Bytes before the lengths of the rows of a sparse matrix, or the values of a dense one.
const HEADER: u64 = 4 * INTEGER;

/// Bytes before the number of entries.
const ENTRIES: u64 = 3 * INTEGER;

/// The header of a matrix: rows and columns, and the number of entries or what takes its place.
fn read_header(path: &Path) -> Result<(Source, [usize; 2], i32), Error> {
    let mut source = Source::open(path, MATRIX)?;
    let shape = [source.count("rows")?, source.count("columns")?];
    let entries = source.integer()?;
    Ok((source, shape, entries))
}

/// A sparse matrix that is read row by row.
pub(super) struct RowReader {
    /// Rows and columns.
    pub shape: (usize, usize),
    pub entries: usize,
    lengths: Vec<u32>,
    columns: Source,
    values: Source,
    /// The row that is read next.
    next: usize,
    /// The byte of the values of the last row.
    byte: u64,
}

/// A row: columns from 0, increasing, and values.
#[derive(Default)]
pub(super) struct MatrixRow {
    pub columns: Vec<u32>,
    pub values: Vec<f64>,
}

impl RowReader {
    /// Opens a sparse matrix, and reads the lengths of its rows.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let (mut source, [rows, columns], announced) = read_header(path)?;
        if announced == DENSE {
            let message = format!("the matrix is stored dense (its number of entries is {DENSE}); store it as AIJ");
            return Err(source.fault(ENTRIES, message));
        }
        if announced < 0 {
            let message = format!("the number of entries is {announced}; it must not be negative");
            return Err(source.fault(ENTRIES, message));
        }
        let after_lengths = HEADER + INTEGER * rows as u64;
        if source.length < after_lengths {
            source.ends_at(after_lengths, || format!("the header of a matrix of {rows} rows"))?;
        }
        let mut lengths = Vec::with_capacity(rows);
        let mut entries = 0_u64;
        for row in 0..rows {
            let (byte, length) = (source.byte(), source.integer()?);
            if length < 0 || length as usize > columns {
                let allowed = format!("it must be from 0 to {columns}, the number of columns");
                return Err(source.fault(byte, format!("row {row} has length {length} (from 0); {allowed}")));
            }
            lengths.push(length as u32);
            entries += length as u64;
        }
        if announced != TOO_MANY && entries != announced as u64 {
            let message =
                format!("the number of entries is {announced}, but the lengths of the rows add up to {entries}");
            return Err(source.fault(ENTRIES, message));
        }
        let after_columns = after_lengths + INTEGER * entries;
        let holds = || format!("a matrix of {rows} rows and {entries} entries");
        source.ends_at(after_columns + REAL * entries, holds)?;
        let values = Source::from_byte(path, after_columns)?;
        let (shape, entries) = ((rows, columns), entries as usize);
        Ok(RowReader { shape, entries, lengths, columns: source, values, next: 0, byte: after_columns })
    }

    /// Reads the next row; `false` behind the last.
    pub fn read(&mut self, into: &mut MatrixRow) -> Result<bool, Error> {
        let Some(&length) = self.lengths.get(self.next) else { return Ok(false) };
        let row = self.next;
        into.columns.clear();
        into.values.clear();
        let mut least = 0;
        for _ in 0..length {
            let (byte, column) = (self.columns.byte(), self.columns.integer()?);
            if !(least..self.shape.1 as i64).contains(&i64::from(column)) {
                let allowed = format!("columns must increase and lie below {}", self.shape.1);
                let before = into.columns.last().map_or(String::new(), |before| format!(" behind column {before}"));
                let message = format!("row {row} has column {column}{before} (indices from 0); {allowed}");
                return Err(self.columns.fault(byte, message));
            }
            least = i64::from(column) + 1;
            into.columns.push(column as u32);
        }
        self.byte = self.values.byte();
        for &column in &into.columns {
            into.values.push(self.values.real(f64::is_finite, not_finite(row, column as usize))?);
        }
        self.next += 1;
        Ok(true)
    }

    /// The row that was read last.
    pub fn row(&self) -> usize {
        self.next - 1
    }

    /// The error of an entry of the row that was read last; `place` is its number in the row.
    pub fn fault(&self, place: usize, message: impl Into<String>) -> Error {
        self.values.fault(self.byte + REAL * place as u64, message)
    }

    pub fn wrong_shape(&self, message: impl Into<String>) -> Error {
        self.values.fault(INTEGER, message)
    }
}

/// The columns of a matrix of `rows` rows that is stored with all its entries.
pub(super) fn dense_columns(path: &Path, rows: usize) -> Result<Vec<Vec<f64>>, Error> {
    let (mut source, [found, count], announced) = read_header(path)?;
    if found != rows || count == 0 {
        let message = format!("it is {found} x {count}, but it must have {rows} rows, as the stiffness, and a column");
        return Err(source.fault(INTEGER, message));
    }
    if announced != DENSE {
        let message = format!("the number of entries is {announced}; it must be {DENSE}: store the matrix dense");
        return Err(source.fault(ENTRIES, message));
    }
    let bytes = (rows as u64).saturating_mul(count as u64).saturating_mul(REAL).saturating_add(HEADER);
    source.ends_at(bytes, || format!("a dense matrix of {rows} x {count}"))?;
    let mut columns = vec![Vec::with_capacity(rows); count];
    for row in 0..rows {
        for (index, column) in columns.iter_mut().enumerate() {
            column.push(source.real(f64::is_finite, not_finite(row, index))?);
        }
    }
    Ok(columns)
}

/// The message for an entry with a value that is not finite.
fn not_finite(row: usize, column: usize) -> impl FnOnce(f64) -> String {
    move |value| format!("entry ({row}, {column}) is {value} (indices from 0); it must be finite")
}
