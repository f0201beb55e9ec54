//! Problem directories: the content of each file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::parse::{Allowed, BOUNDS, Content, FINITE, GAPS, read};
use super::{format_vector, write_columns, write_entries};
use crate::error::Error;
use crate::file::Streamed;
use crate::linear::multigrid::NearNullSpace;
use crate::linear::{SparseMatrix, SymmetricMatrix};
use crate::problem::ContactProblem;
use crate::solution::Solution;

/// The file that makes a directory one of Matrix Market files.
pub const STIFFNESS: &str = "K.mtx";

/// Largest number of empty rows or columns: nothing is allocated from an announced size alone.
const MOST_EMPTY: usize = 1_000_000;

/// Reads the problem of a directory.
pub fn read_problem(directory: &Path) -> Result<ContactProblem, Error> {
    let (is_symmetric, stiffness) = matrix(&directory.join(STIFFNESS), None)?;
    let stiffness =
        if is_symmetric { SymmetricMatrix::from_lower(stiffness) } else { SymmetricMatrix::from_full(&stiffness) }?;
    let load = read_vector(&directory.join("f.mtx"))?;
    let (_, contact) = matrix(&directory.join("B.mtx"), Some(load.len()))?;
    let gap = vector(&directory.join("g.mtx"), GAPS)?;
    let problem = with_equalities(directory, ContactProblem::new(stiffness, load, contact, gap)?)?;
    match near_null(directory, problem.dofs())? {
        Some(near_null) => problem.with_near_null(near_null),
        None => Ok(problem),
    }
}

/// The problem with the equality rows of `E.mtx` and `e.mtx`, if there are these files.
fn with_equalities(directory: &Path, problem: ContactProblem) -> Result<ContactProblem, Error> {
    let [rows, values] = ["E.mtx", "e.mtx"].map(|name| directory.join(name));
    let missing = |file: PathBuf, sentence: &str| Err(fault(file, format!("it is missing, but {sentence}")));
    match (rows.exists(), values.exists()) {
        (false, false) => return Ok(problem),
        (true, false) => return missing(values, "there is E.mtx: every row of E needs a value"),
        (false, true) => return missing(rows, "there is e.mtx: every value needs a row of E"),
        (true, true) => {}
    }
    let (_, rows) = matrix(&rows, Some(problem.dofs()))?;
    problem.with_equalities(&rows, read_vector(&values)?)
}

/// Reads the gaps in `g1.mtx` and the load in `f1.mtx` of a directory, as [`ContactProblem::read_other_end`] describes.
pub fn read_other_end(directory: &Path, problem: &ContactProblem) -> Result<ContactProblem, Error> {
    let [gap_file, load_file] = ["g1.mtx", "f1.mtx"].map(|name| directory.join(name));
    if !gap_file.exists() && !load_file.exists() {
        let message =
            "it is missing, and so is f1.mtx: a sweep needs the gaps or the load of the other end".to_string();
        return Err(fault(gap_file, message));
    }
    let end = |file: &Path, values: Allowed, own: &[f64], of: &str| {
        if !file.exists() {
            return Ok(own.to_vec());
        }
        let end = vector(file, values)?;
        if end.len() == own.len() {
            return Ok(end);
        }
        Err(fault(file.to_path_buf(), format!("it has length {}, but there are {} {of}", end.len(), own.len())))
    };
    let gap = end(&gap_file, GAPS, problem.inequalities_given().1, "contact rows")?;
    let load = end(&load_file, FINITE, problem.load(), "dofs")?;
    let last = problem.with(load, gap)?;
    let mut rows = problem.gap().iter().zip(last.gap()).enumerate();
    match rows.find(|(_, (first, last))| first.is_finite() != last.is_finite()) {
        Some((row, (first, last))) => Err(fault(
            gap_file,
            format!(
                "the gap of row {row} goes from {first} to {last}; a row must have a finite gap at both ends, or an \
                 infinite gap at both"
            ),
        )),
        None => Ok(last),
    }
}

/// The near-null space of the body: from `near_null.mtx`, one column for each vector, or from `coordinates.mtx`, one
/// row for each node. The dofs of a node then follow each other and are all free.
fn near_null(directory: &Path, dofs: usize) -> Result<Option<NearNullSpace>, Error> {
    let file = directory.join("near_null.mtx");
    if file.exists() {
        let content = read(&file, FINITE)?;
        if content.rows != dofs || content.columns == 0 {
            let found = format!("it is {} x {}", content.rows, content.columns);
            return Err(fault(
                file,
                format!("{found}, but it must have {dofs} rows, one per dof, and a column at least"),
            ));
        }
        let near_null = NearNullSpace::new(columns(content), dofs);
        return near_null.map(Some).map_err(|error| fault(file, error.to_string()));
    }
    let file = directory.join("coordinates.mtx");
    if !file.exists() {
        return Ok(None);
    }
    let content = read(&file, FINITE)?;
    let (nodes, dimension) = (content.rows, content.columns);
    if !(1..=3).contains(&dimension) || nodes.checked_mul(dimension) != Some(dofs) {
        let message = format!(
            "it is {nodes} x {dimension}, which makes {} dofs, but there are {dofs}; it must have a row for \
             each node and a column for each coordinate, 1 to 3 (if supports have removed dofs, use \
             near_null.mtx)",
            nodes.saturating_mul(dimension)
        );
        return Err(fault(file, message));
    }
    let of_nodes = NearNullSpace::of_nodes(&columns(content));
    of_nodes.map(Some).map_err(|error| fault(file, error.to_string()))
}

fn fault(file: PathBuf, message: String) -> Error {
    Error::FileSyntax { file, line: 1, message }
}

fn columns(content: Content) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; content.rows]; content.columns];
    content.entries.iter().for_each(|&(row, column, value)| columns[column][row] += value);
    columns
}

/// The files of a problem, with its near-null space if it has one.
pub fn streamed_files<'a>(problem: &'a ContactProblem) -> Vec<Streamed<'a>> {
    let (contact, gap) = problem.inequalities_given();
    let mut files = vec![
        Streamed::new(STIFFNESS, |out| write_entries(out, problem.stiffness().lower(), "symmetric")),
        Streamed::new("f.mtx", |out| write_columns(out, &[problem.load()])),
        Streamed::new("B.mtx", move |out| write_entries(out, &contact, "general")),
        Streamed::new("g.mtx", move |out| write_columns(out, &[gap])),
    ];
    if problem.equality_rows() > 0 {
        let (rows, values) = problem.equalities_given();
        files.push(Streamed::new("E.mtx", move |out| write_entries(out, &rows, "general")));
        files.push(Streamed::new("e.mtx", move |out| write_columns(out, &[&values])));
    }
    let of_modes = |near_null: &'a Arc<NearNullSpace>| {
        Streamed::new("near_null.mtx", |out| write_columns(out, near_null.vectors()))
    };
    files.extend(problem.near_null().map(of_modes));
    files
}

/// Reads a vector of finite numbers from a Matrix Market file of one column, or of one row; its length and unit are
/// those of the file.
///
/// # Errors
/// [`Error::File`] and [`Error::FileSyntax`].
pub fn read_vector(file: &Path) -> Result<Vec<f64>, Error> {
    vector(file, FINITE)
}

/// A vector, in the unit of its file, that may have the entries `-inf` and `inf`.
pub fn read_bounds(file: &Path) -> Result<Vec<f64>, Error> {
    vector(file, BOUNDS)
}

/// All entries of a file; if it is symmetric, it holds the lower triangle only.
pub fn read_matrix(file: &Path) -> Result<SparseMatrix, Error> {
    let (is_symmetric, lower) = matrix(file, None)?;
    if !is_symmetric {
        return Ok(lower);
    }
    let below = lower.triplets().filter(|(row, column, _)| row != column);
    let above: Vec<_> = below.map(|(row, column, value)| (column, row, value)).collect();
    SparseMatrix::from_triplets(lower.rows(), lower.columns(), &lower.triplets().chain(above).collect::<Vec<_>>())
}

fn vector(file: &Path, values: Allowed) -> Result<Vec<f64>, Error> {
    let content = read(file, values)?;
    if content.columns != 1 && content.rows != 1 {
        let message = format!("a vector has one column, but this is {} x {}", content.rows, content.columns);
        return Err(Error::FileSyntax { file: file.to_path_buf(), line: content.line, message });
    }
    check_filled(file, &content, content.rows.saturating_mul(content.columns))?;
    let mut vector = vec![0.0; content.rows * content.columns];
    for (row, column, value) in content.entries {
        // Entries with the same row and column are added, as in a matrix.
        vector[row + column] += value;
    }
    Ok(vector)
}

/// Name and text of the Matrix Market files of an answer: `u.mtx` (displacement, length n), `lambda.mtx` (multiplier,
/// length m), and with equality rows `mu.mtx` (their multiplier, length p).
pub fn solution_files(solution: &Solution) -> Vec<(&'static str, String)> {
    let vectors = [
        ("u.mtx", &solution.displacement),
        ("lambda.mtx", &solution.multiplier),
        ("mu.mtx", &solution.equality_multiplier),
    ];
    let is_there = |entry: &(&str, &Vec<f64>)| entry.0 != "mu.mtx" || !entry.1.is_empty();
    vectors.into_iter().filter(is_there).map(|(name, values)| (name, format_vector(values))).collect()
}

/// Refuses a number of rows or columns (`lines`) that is not credible for the entries of a file.
fn check_filled(file: &Path, content: &Content, lines: usize) -> Result<(), Error> {
    let (rows, columns, entries) = (content.rows, content.columns, content.entries.len());
    if lines <= entries.saturating_add(MOST_EMPTY) {
        return Ok(());
    }
    let message = format!("a matrix of {rows} x {columns} with {entries} entries is almost empty; correct its size");
    Err(Error::FileSyntax { file: file.to_path_buf(), line: content.line, message })
}

/// A matrix, and whether the file holds its lower triangle only. A body has many dofs without a row: a matrix of rows
/// must have as many columns as there are `dofs`, or else be credible by its entries.
fn matrix(file: &Path, dofs: Option<usize>) -> Result<(bool, SparseMatrix), Error> {
    let content = read(file, FINITE)?;
    let fits = dofs == Some(content.columns);
    check_filled(file, &content, if fits { content.rows } else { content.rows.max(content.columns) })?;
    let matrix = SparseMatrix::from_triplets(content.rows, content.columns, &content.entries)?;
    Ok((content.symmetric, matrix))
}
