//! Matrix Market files: matrices and vectors as text.
//!
//! # Source
//! R. F. Boisvert, R. Pozo, K. A. Remington, *The Matrix Market Exchange Formats: Initial Design*, NISTIR 5935 (1996).

mod parse;

pub use parse::{AllowedValues, Content};

use std::io::{self, Write};
use std::path::Path;

use crate::error::Error;
use crate::file::{Streamed, open_capped};
use crate::{SparseMatrix, SymmetricMatrix};
use parse::{Quotes, parse};

/// Most bytes of a matrix in text, which is not held in memory: fifty million dofs of a body in space.
const MOST_OF_MATRIX: u64 = 64 << 30;

/// Largest number of empty rows or columns: nothing is allocated from an announced size alone.
const MOST_EMPTY: usize = 1_000_000;

/// The Matrix Market file of a vector in any unit, as text: an array of one column, one entry per line, in the order of
/// the vector.
pub fn format_vector(vector: &[f64]) -> String {
    Streamed::new("vector", |out| write_columns(out, &[vector])).text()
}

impl SparseMatrix {
    /// Reads a Matrix Market file; of a symmetric one both triangles. For the crates of this workspace.
    ///
    /// # Errors
    /// As [`read_vector`].
    #[doc(hidden)]
    pub fn read(file: &Path) -> Result<Self, Error> {
        let mut content = Content::read(file, AllowedValues::Finite)?;
        content.check_filled(file, content.rows.max(content.columns))?;
        if content.symmetric {
            let below = content.entries.iter().filter(|(row, column, _)| row != column);
            let above: Vec<_> = below.map(|&(row, column, value)| (column, row, value)).collect();
            content.entries.extend(above);
        }
        content.matrix()
    }

    /// Reads a file as [`read_vector`] does, in which `-inf` and `inf` stand for no bound. For the crates of this
    /// workspace.
    ///
    /// # Errors
    /// As [`read_vector`].
    #[doc(hidden)]
    pub fn read_bounds(file: &Path) -> Result<Vec<f64>, Error> {
        vector(file, AllowedValues::Bounds)
    }

    /// The matrix as a Matrix Market file of this name.
    pub fn file(&self, name: &'static str) -> Streamed<'_> {
        Streamed::new(name, |out| write_entries(out, self, "general"))
    }
}

impl SymmetricMatrix {
    /// The matrix as a Matrix Market file of this name, by its lower triangle.
    pub fn file(&self, name: &'static str) -> Streamed<'_> {
        Streamed::new(name, |out| write_entries(out, self.lower(), "symmetric"))
    }
}

/// Writes a sparse matrix with `symmetry` `general`, or the lower triangle of a matrix with `symmetry` `symmetric`.
pub fn write_entries(out: &mut dyn Write, matrix: &SparseMatrix, symmetry: &str) -> io::Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real {symmetry}")?;
    writeln!(out, "{} {} {}", matrix.rows(), matrix.columns(), matrix.entries())?;
    matrix.triplets().try_for_each(|(row, column, value)| writeln!(out, "{} {} {value:e}", row + 1, column + 1))
}

/// Writes columns of one length as an array.
pub fn write_columns(out: &mut dyn Write, columns: &[impl AsRef<[f64]>]) -> io::Result<()> {
    let rows = columns.first().map_or(0, |column| column.as_ref().len());
    writeln!(out, "%%MatrixMarket matrix array real general\n{rows} {}", columns.len())?;
    columns.iter().flat_map(AsRef::as_ref).try_for_each(|value| writeln!(out, "{value:e}"))
}

/// Reads a vector of finite numbers from a Matrix Market file of one column, or of one row; its length and unit are
/// those of the file.
///
/// # Errors
/// [`Error::File`] and [`Error::FileSyntax`].
pub fn read_vector(file: &Path) -> Result<Vec<f64>, Error> {
    vector(file, AllowedValues::Finite)
}

/// Reads a vector with `values`, in the unit of its file.
///
/// # Errors
/// As [`read_vector`].
pub fn vector(file: &Path, values: AllowedValues) -> Result<Vec<f64>, Error> {
    let content = Content::read(file, values)?;
    if content.columns != 1 && content.rows != 1 {
        let message = format!("a vector has one column, but this is {} x {}", content.rows, content.columns);
        return Err(Error::FileSyntax { file: file.to_path_buf(), line: content.line, message });
    }
    content.check_filled(file, content.rows.saturating_mul(content.columns))?;
    let mut vector = vec![0.0; content.rows * content.columns];
    for (row, column, value) in content.entries {
        // Entries with the same row and column are added, as in a matrix.
        vector[row + column] += value;
    }
    Ok(vector)
}

/// If `file` is a link out of its folder, errors do not quote the content.
fn quotes(file: &Path) -> Quotes {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    match (file.canonicalize(), folder.canonicalize()) {
        (Ok(file), Ok(folder)) if file.starts_with(&folder) => Quotes::Allowed,
        _ => Quotes::Withheld,
    }
}

impl Content {
    /// Reads the content of a file.
    ///
    /// # Errors
    /// As [`read_vector`].
    pub fn read(file: &Path, values: AllowedValues) -> Result<Content, Error> {
        parse(file, open_capped(file, MOST_OF_MATRIX)?, values, quotes(file))
    }

    /// Refuses a number of rows or columns (`lines`) that is not credible for the entries of the file.
    ///
    /// # Errors
    /// [`Error::FileSyntax`].
    pub fn check_filled(&self, file: &Path, lines: usize) -> Result<(), Error> {
        let (rows, columns, entries) = (self.rows, self.columns, self.entries.len());
        if lines <= entries.saturating_add(MOST_EMPTY) {
            return Ok(());
        }
        let message =
            format!("a matrix of {rows} x {columns} with {entries} entries is almost empty; correct its size");
        Err(Error::FileSyntax { file: file.to_path_buf(), line: self.line, message })
    }

    /// The entries as a matrix: of a symmetric one the lower triangle.
    ///
    /// # Errors
    /// As [`SparseMatrix::from_triplets`].
    pub fn matrix(&self) -> Result<SparseMatrix, Error> {
        SparseMatrix::from_triplets(self.rows, self.columns, &self.entries)
    }

    /// The columns of an array.
    pub fn columns(&self) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; self.rows]; self.columns];
        self.entries.iter().for_each(|&(row, column, value)| columns[column][row] += value);
        columns
    }
}
