//! A PETSc file while it is read: every error names its byte. The rows of a matrix are read one after another: neither
//! the file nor a second matrix is held in memory.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::{Class, DENSE, INDICES, MATRIX, TOO_MANY, VECTOR};
use crate::error::LinearError as Error;
use crate::linear::file::open_regular;

/// Bytes of a PETSc file that are read at a time.
const PIECE: usize = 1 << 20;

/// Bytes of an integer and of a real.
pub const INTEGER: u64 = 4;
pub const REAL: u64 = 8;

/// Bytes before the lengths of the rows of a sparse matrix, or the values of a dense one.
const HEADER: u64 = 4 * INTEGER;

/// Bytes before the number of entries.
const ENTRIES: u64 = 3 * INTEGER;

/// A file, read from some byte on.
pub struct Source {
    path: PathBuf,
    reader: BufReader<File>,
    byte: u64,
    /// Bytes of the file.
    length: u64,
}

impl Source {
    /// Opens a file that holds one object of this class, and reads the class.
    fn open(path: &Path, class: Class) -> Result<Self, Error> {
        let mut source = Self::from_byte(path, 0)?;
        let number = class.number;
        if source.length < 2 * INTEGER {
            let message = format!("the file ends here; {} begins with {number} and its size", class.words);
            return Err(source.fault(source.length, message));
        }
        let found = source.integer()?;
        if found == number {
            return Ok(source);
        }
        let known = |number: i32| [MATRIX, VECTOR, INDICES].into_iter().find(|class| class.number == number);
        let message = if let Some(other) = known(found) {
            format!("the class is {found}, {}; it must be {number}, {}", other.words, class.words)
        } else if known(found.swap_bytes()).is_some() {
            let little = found.swap_bytes();
            format!("the class is {found}, which is {little} in little-endian order; PETSc files are big-endian")
        } else {
            match (found, source.integer()?) {
                (0, next) if known(next).is_some() => {
                    format!("the integers have 64 bits; they must have 32: write {next} and all others in 4 bytes")
                }
                _ => format!("the class is {found}; it must be {number}, {}", class.words),
            }
        };
        Err(source.fault(0, message))
    }

    /// A file from some byte on, which may be read elsewhere too.
    fn from_byte(path: &Path, byte: u64) -> Result<Self, Error> {
        let (mut file, length) = open_regular(path)?;
        let sought = if byte == 0 { Ok(0) } else { file.seek(SeekFrom::Start(byte)) };
        sought.map_err(|source| Error::File { action: "read", path: path.into(), source })?;
        let reader = BufReader::with_capacity(PIECE.min(length as usize + 1), file);
        Ok(Source { path: path.to_path_buf(), reader, byte, length })
    }

    fn fault(&self, byte: u64, message: impl Into<String>) -> Error {
        Error::FileBytes { file: self.path.clone(), byte: byte as usize, message: message.into() }
    }

    fn integer(&mut self) -> Result<i32, Error> {
        self.bytes().map(i32::from_be_bytes)
    }

    /// The next integer, which is a number of `what`.
    fn count(&mut self, what: &str) -> Result<usize, Error> {
        let (byte, count) = (self.byte, self.integer()?);
        let negative = |_| self.fault(byte, format!("the number of {what} is {count}; it must not be negative"));
        usize::try_from(count).map_err(negative)
    }

    /// The next real, which must be allowed; `message` says what is wrong with another one.
    fn real(&mut self, is_allowed: fn(f64) -> bool, message: impl FnOnce(f64) -> String) -> Result<f64, Error> {
        let (byte, value) = (self.byte, self.bytes().map(f64::from_be_bytes)?);
        if is_allowed(value) { Ok(value) } else { Err(self.fault(byte, message(value))) }
    }

    fn bytes<const COUNT: usize>(&mut self) -> Result<[u8; COUNT], Error> {
        let mut bytes = [0; COUNT];
        self.reader.read_exact(&mut bytes).map_err(|source| match source.kind() {
            io::ErrorKind::UnexpectedEof => self.fault(self.length, "the file ends here, but its sizes announce more"),
            _ => Error::File { action: "read", path: self.path.clone(), source },
        })?;
        self.byte += COUNT as u64;
        Ok(bytes)
    }

    /// Refuses a file that does not end with the byte before `end`, the end of the object that `holds` names.
    fn ends_at(&self, end: u64, holds: impl FnOnce() -> String) -> Result<(), Error> {
        if self.length == end {
            return Ok(());
        }
        let what = if self.length < end { "the file ends here" } else { "the file is longer" };
        let byte = self.length.min(end);
        let message = format!("{what}, after {} bytes; {} takes {end} bytes", self.length, holds());
        Err(self.fault(byte, message))
    }
}

/// Reads a vector with values that satisfy `is_allowed`; `allowed` says the same in words.
pub fn vector(path: &Path, is_allowed: fn(f64) -> bool, allowed: &str) -> Result<Vec<f64>, Error> {
    let mut source = Source::open(path, VECTOR)?;
    let length = source.count("values")?;
    source.ends_at(2 * INTEGER + REAL * length as u64, || format!("a vector of {length} values"))?;
    let mut values = Vec::with_capacity(length);
    for index in 0..length {
        let message = |value| format!("value {index} is {value} (from 0); it must be {allowed}");
        values.push(source.real(is_allowed, message)?);
    }
    Ok(values)
}

/// Reads a set of indices that increase and lie below `most`.
pub fn indices(path: &Path, most: usize) -> Result<Vec<u32>, Error> {
    let mut source = Source::open(path, INDICES)?;
    let length = source.count("indices")?;
    source.ends_at(INTEGER * (2 + length as u64), || format!("an index set of {length}"))?;
    let mut indices: Vec<u32> = Vec::with_capacity(length);
    for number in 0..length {
        let (byte, index) = (source.byte, source.integer()?);
        let least = indices.last().map_or(0, |&before| i64::from(before) + 1);
        if !(least..most as i64).contains(&i64::from(index)) {
            let allowed = format!("it must lie beyond the one before and below {most}, the size of the stiffness");
            return Err(source.fault(byte, format!("index {number} is {index} (from 0); {allowed}")));
        }
        indices.push(index as u32);
    }
    Ok(indices)
}

/// The header of a matrix: rows and columns, and the number of entries or what takes its place.
fn read_header(path: &Path) -> Result<(Source, [usize; 2], i32), Error> {
    let mut source = Source::open(path, MATRIX)?;
    let shape = [source.count("rows")?, source.count("columns")?];
    let entries = source.integer()?;
    Ok((source, shape, entries))
}

/// A sparse matrix that is read row by row.
pub struct RowReader {
    /// Rows and columns.
    pub shape: (usize, usize),
    pub entries: usize,
    lengths: Vec<u32>,
    indices: Source,
    reals: Source,
    /// The row that is read next.
    next: usize,
    /// The byte of the values of the last row.
    byte: u64,
    /// The columns of the last row, from 0, increasing.
    pub columns: Vec<u32>,
    /// Its values.
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
            let (byte, length) = (source.byte, source.integer()?);
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
        let (reals, shape, entries) = (Source::from_byte(path, after_columns)?, (rows, columns), entries as usize);
        let (indices, columns, values) = (source, Vec::new(), Vec::new());
        Ok(RowReader { shape, entries, lengths, indices, reals, next: 0, byte: after_columns, columns, values })
    }

    /// Reads the next row; `false` behind the last.
    pub fn read(&mut self) -> Result<bool, Error> {
        let Some(&length) = self.lengths.get(self.next) else { return Ok(false) };
        let (row, mut least) = (self.next, 0);
        self.columns.clear();
        self.values.clear();
        for _ in 0..length {
            let (byte, column) = (self.indices.byte, self.indices.integer()?);
            if !(least..self.shape.1 as i64).contains(&i64::from(column)) {
                let allowed = format!("columns must increase and lie below {}", self.shape.1);
                let before = self.columns.last().map_or(String::new(), |before| format!(" behind column {before}"));
                let message = format!("row {row} has column {column}{before} (indices from 0); {allowed}");
                return Err(self.indices.fault(byte, message));
            }
            least = i64::from(column) + 1;
            self.columns.push(column as u32);
        }
        self.byte = self.reals.byte;
        for &column in &self.columns {
            self.values.push(self.reals.real(f64::is_finite, not_finite(row, column as usize))?);
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
        self.reals.fault(self.byte + REAL * place as u64, message)
    }

    pub fn wrong_shape(&self, message: impl Into<String>) -> Error {
        self.reals.fault(INTEGER, message)
    }
}

/// The columns of a matrix of `rows` rows that is stored with all its entries.
pub fn dense_columns(path: &Path, rows: usize) -> Result<Vec<Vec<f64>>, Error> {
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
