//! Matrix Market files: the raw form in which problems and answers are exchanged.
//!
//! A problem directory holds `K.mtx` (symmetric), `f.mtx`, `B.mtx` and `g.mtx`; an answer adds `u.mtx` and
//! `lambda.mtx`. Indices are the free dofs. A gap may be `inf`: a row without obstacle. Multigrid reads `near_null.mtx`
//! (one column for each displacement that costs next to no energy, as the rigid-body modes) or `coordinates.mtx` (one
//! row for each node). A sweep goes to other gaps, `g1.mtx`, another load, `f1.mtx`, or both.
//!
//! # Source
//! R. F. Boisvert, R. Pozo, K. A. Remington, *The Matrix Market Exchange Formats: Initial Design*, NISTIR 5935 (1996).

mod directory;
mod parse;

pub use directory::{
    STIFFNESS, read_bounds, read_matrix, read_other_end, read_problem, read_vector, solution_files, streamed_files,
};

use std::io::{self, Write};

use crate::file::Streamed;
use crate::linear::{SparseMatrix, SymmetricMatrix};

/// The Matrix Market file of a vector in any unit, as text: an array of one column, one entry per line, in the order of
/// the vector.
pub fn format_vector(vector: &[f64]) -> String {
    Streamed::new("vector", |out| write_columns(out, &[vector])).text()
}

/// A matrix by its lower triangle, under this name.
pub fn symmetric_file<'a>(name: &'static str, matrix: &'a SymmetricMatrix) -> Streamed<'a> {
    Streamed::new(name, |out| write_entries(out, matrix.lower(), "symmetric"))
}

/// Writes a sparse matrix with `symmetry` `general`, or the lower triangle of a matrix with `symmetry` `symmetric`.
pub fn write_entries(out: &mut dyn Write, matrix: &SparseMatrix, symmetry: &str) -> io::Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real {symmetry}")?;
    writeln!(out, "{} {} {}", matrix.rows(), matrix.columns(), matrix.entries())?;
    matrix.triplets().try_for_each(|(row, column, value)| writeln!(out, "{} {} {value:e}", row + 1, column + 1))
}

/// Writes columns of one length as an array.
fn write_columns(out: &mut dyn Write, columns: &[impl AsRef<[f64]>]) -> io::Result<()> {
    let rows = columns.first().map_or(0, |column| column.as_ref().len());
    writeln!(out, "%%MatrixMarket matrix array real general\n{rows} {}", columns.len())?;
    columns.iter().flat_map(AsRef::as_ref).try_for_each(|value| writeln!(out, "{value:e}"))
}
