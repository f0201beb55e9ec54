//! A PETSc file while it is read: every error names its byte.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::{Class, INDICES, MATRIX, VECTOR};
use crate::error::LinearError as Error;
use crate::linear::file::open_regular;

/// Bytes of a PETSc file that are read at a time.
const PIECE: usize = 1 << 20;

/// Bytes of an integer and of a real.
pub(super) const INTEGER: u64 = 4;
pub(super) const REAL: u64 = 8;

/// A file, read from some byte on.
pub(super) struct Source {
    path: PathBuf,
    reader: BufReader<File>,
    byte: u64,
    /// Bytes of the file.
    pub length: u64,
}

impl Source {
    /// Opens a file that holds one object of this class, and reads the class.
    pub fn open(path: &Path, class: Class) -> Result<Self, Error> {
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
    pub fn from_byte(path: &Path, byte: u64) -> Result<Self, Error> {
        let (mut file, length) = open_regular(path)?;
        let sought = if byte == 0 { Ok(0) } else { file.seek(SeekFrom::Start(byte)) };
        sought.map_err(|source| Error::File { action: "read", path: path.into(), source })?;
        let reader = BufReader::with_capacity(PIECE.min(length as usize + 1), file);
        Ok(Source { path: path.to_path_buf(), reader, byte, length })
    }

    pub fn byte(&self) -> u64 {
        self.byte
    }

    pub fn fault(&self, byte: u64, message: impl Into<String>) -> Error {
        Error::FileBytes { file: self.path.clone(), byte: byte as usize, message: message.into() }
    }

    pub fn integer(&mut self) -> Result<i32, Error> {
        self.bytes().map(i32::from_be_bytes)
    }

    /// The next integer, which is a number of `what`.
    pub fn count(&mut self, what: &str) -> Result<usize, Error> {
        let (byte, count) = (self.byte, self.integer()?);
        let negative = |_| self.fault(byte, format!("the number of {what} is {count}; it must not be negative"));
        usize::try_from(count).map_err(negative)
    }

    /// The next real, which must be allowed; `message` says what is wrong with another one.
    pub fn real(&mut self, is_allowed: fn(f64) -> bool, message: impl FnOnce(f64) -> String) -> Result<f64, Error> {
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
    pub fn ends_at(&self, end: u64, holds: impl FnOnce() -> String) -> Result<(), Error> {
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
pub(super) fn vector(path: &Path, is_allowed: fn(f64) -> bool, allowed: &str) -> Result<Vec<f64>, Error> {
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
pub(super) fn indices(path: &Path, most: usize) -> Result<Vec<u32>, Error> {
    let mut source = Source::open(path, INDICES)?;
    let length = source.count("indices")?;
    source.ends_at(INTEGER * (2 + length as u64), || format!("an index set of {length}"))?;
    let mut indices: Vec<u32> = Vec::with_capacity(length);
    for number in 0..length {
        let (byte, index) = (source.byte(), source.integer()?);
        let least = indices.last().map_or(0, |&before| i64::from(before) + 1);
        if !(least..most as i64).contains(&i64::from(index)) {
            let allowed = format!("it must lie beyond the one before and below {most}, the size of the stiffness");
            return Err(source.fault(byte, format!("index {number} is {index} (from 0); {allowed}")));
        }
        indices.push(index as u32);
    }
    Ok(indices)
}
