//! Problem directories: which file holds what.

use std::path::Path;

use super::parse::{Content, Values, parse};
use super::{format_matrix, format_symmetric, format_vector};
use crate::error::Error;
use crate::problem::ContactProblem;
use crate::solution::Solution;
use crate::sparse::{SparseMatrix, SymmetricMatrix};

/// Reads the problem of a directory.
///
/// # Errors
/// [`Error::File`] and [`Error::FileSyntax`] for a file that is missing or malformed, and those of
/// [`ContactProblem::new`].
pub fn read_problem(directory: &Path) -> Result<ContactProblem, Error> {
    let stiffness = read(&directory.join("K.mtx"), Values::Finite)?;
    let (is_symmetric, stiffness) = (stiffness.symmetric, matrix(stiffness)?);
    let stiffness =
        if is_symmetric { SymmetricMatrix::from_lower(stiffness) } else { SymmetricMatrix::from_full(&stiffness) }?;
    let load = read_vector(&directory.join("f.mtx"))?;
    let contact = matrix(read(&directory.join("B.mtx"), Values::Finite)?)?;
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
        return Err(Error::FileSyntax { file: file.to_path_buf(), line: 1, message });
    }
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
    let bytes =
        std::fs::read(file).map_err(|source| Error::File { action: "read", path: file.to_path_buf(), source })?;
    // Comments of older collections hold names in other encodings; numbers are ASCII in all of them.
    parse(file, &String::from_utf8_lossy(&bytes), values)
}

fn matrix(content: Content) -> Result<SparseMatrix, Error> {
    SparseMatrix::from_triplets(content.rows, content.columns, &content.entries)
}
