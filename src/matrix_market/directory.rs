//! Problem directories: which file holds what.

use std::path::Path;

use super::parse::{Content, Values, parse};
use super::{format_matrix, format_symmetric, format_vector};
use crate::error::Error;
use crate::file::{MOST_OF_TABLE, read_capped};
use crate::problem::ContactProblem;
use crate::solution::Solution;
use crate::sparse::{SparseMatrix, SymmetricMatrix};

/// Reads the problem of a directory.
///
/// # Errors
/// [`Error::File`] and [`Error::FileSyntax`] for a file that is missing or malformed, and those of
/// [`ContactProblem::new`].
pub fn read_problem(directory: &Path) -> Result<ContactProblem, Error> {
    let file = directory.join("K.mtx");
    let stiffness = read(&file, Values::Finite)?;
    check_filled(&file, &stiffness, stiffness.rows.max(stiffness.columns))?;
    let (is_symmetric, stiffness) = (stiffness.symmetric, matrix(stiffness)?);
    let stiffness =
        if is_symmetric { SymmetricMatrix::from_lower(stiffness) } else { SymmetricMatrix::from_full(&stiffness) }?;
    let load = read_vector(&directory.join("f.mtx"))?;
    let file = directory.join("B.mtx");
    let contact = read(&file, Values::Finite)?;
    // A body has many dofs without a contact row: as many columns as the stiffness are right.
    let empty = if contact.columns == load.len() { contact.rows } else { contact.rows.max(contact.columns) };
    check_filled(&file, &contact, empty)?;
    let contact = matrix(contact)?;
    let gap = vector(&directory.join("g.mtx"), Values::FiniteOrInfinite)?;
    ContactProblem::new(stiffness, load, contact, gap)
}

/// Reads a vector of finite numbers: one column, or one row.
///
/// # Errors
/// [`Error::File`] and [`Error::FileSyntax`].
pub fn read_vector(file: &Path) -> Result<Vec<f64>, Error> {
    vector(file, Values::Finite)
}

fn vector(file: &Path, values: Values) -> Result<Vec<f64>, Error> {
    let content = read(file, values)?;
    if content.columns != 1 && content.rows != 1 {
        let message = format!("a vector has one column, but this is {} x {}", content.rows, content.columns);
        return Err(Error::FileSyntax { file: file.to_path_buf(), line: content.line, message });
    }
    check_filled(file, &content, content.rows.saturating_mul(content.columns))?;
    let mut vector = vec![0.0; content.rows * content.columns];
    for (row, column, value) in content.entries {
        // Entries of the same place are added, as in a matrix.
        vector[row + column] += value;
    }
    Ok(vector)
}

/// Name and text of the files of a problem.
pub fn problem_files(problem: &ContactProblem) -> [(&'static str, String); 4] {
    [
        ("K.mtx", format_symmetric(problem.stiffness())),
        ("f.mtx", format_vector(problem.load())),
        ("B.mtx", format_matrix(problem.contact())),
        ("g.mtx", format_vector(problem.gap())),
    ]
}

/// Name and text of the files of an answer.
pub fn solution_files(solution: &Solution) -> [(&'static str, String); 2] {
    [("u.mtx", format_vector(&solution.displacement)), ("lambda.mtx", format_vector(&solution.multiplier))]
}

fn read(file: &Path, values: Values) -> Result<Content, Error> {
    let bytes = read_capped(file, MOST_OF_TABLE)?;
    // Comments of older collections hold names in other encodings; numbers are ASCII in all of them.
    parse(file, &String::from_utf8_lossy(&bytes), values)
}

/// Refuses more rows or columns (`lines` of them) than the entries of a file make credible.
fn check_filled(file: &Path, content: &Content, lines: usize) -> Result<(), Error> {
    if content.believes(lines) {
        return Ok(());
    }
    let (rows, columns, entries) = (content.rows, content.columns, content.entries.len());
    let message = format!("{rows} x {columns} with {entries} entries is almost empty; write the size that it has");
    Err(Error::FileSyntax { file: file.to_path_buf(), line: content.line, message })
}

fn matrix(content: Content) -> Result<SparseMatrix, Error> {
    SparseMatrix::from_triplets(content.rows, content.columns, &content.entries)
}
