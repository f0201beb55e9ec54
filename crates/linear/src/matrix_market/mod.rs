//! Matrix Market files: matrices and vectors as text.
//!
//! # Source
//! R. F. Boisvert, R. Pozo, K. A. Remington, *The Matrix Market Exchange Formats: Initial Design*, NISTIR 5935 (1996).

mod parse;

pub use parse::{Allowed, Content, FINITE, GAPS};

use std::io::{self, Write};
use std::path::Path;

use crate::error::Error;
use crate::file::Streamed;
use crate::{SparseMatrix, SymmetricMatrix};
use parse::BOUNDS;

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
        let (is_symmetric, lower) = matrix(file, None)?;
        if !is_symmetric {
            return Ok(lower);
        }
        let below = lower.triplets().filter(|(row, column, _)| row != column);
        let above: Vec<_> = below.map(|(row, column, value)| (column, row, value)).collect();
        let all: Vec<_> = lower.triplets().chain(above).collect();
        SparseMatrix::from_triplets(lower.rows(), lower.columns(), &all)
    }

    /// Reads a file as [`read_vector`] does, in which `-inf` and `inf` stand for no bound. For the crates of this
    /// workspace.
    ///
    /// # Errors
    /// As [`read_vector`].
    #[doc(hidden)]
    pub fn read_bounds(file: &Path) -> Result<Vec<f64>, Error> {
        vector(file, BOUNDS)
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
    vector(file, FINITE)
}

/// Reads a vector with `values`, in the order and the unit of its file.
///
/// # Errors
/// As [`read_vector`].
pub fn vector(file: &Path, values: Allowed) -> Result<Vec<f64>, Error> {
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

/// A matrix, and whether the file holds its lower triangle only. A body has many dofs without a row: a matrix of rows
/// must have as many columns as there are `dofs`, or else be credible by its entries.
///
/// # Errors
/// As [`read_vector`].
pub fn matrix(file: &Path, dofs: Option<usize>) -> Result<(bool, SparseMatrix), Error> {
    let content = Content::read(file, FINITE)?;
    let fits = dofs == Some(content.columns);
    content.check_filled(file, if fits { content.rows } else { content.rows.max(content.columns) })?;
    let matrix = SparseMatrix::from_triplets(content.rows, content.columns, &content.entries)?;
    Ok((content.symmetric, matrix))
}
