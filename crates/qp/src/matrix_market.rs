//! Problem directories of Matrix Market files: the raw form in which problems and answers are exchanged.
//!
//! A problem directory holds `K.mtx` (symmetric), `f.mtx`, `B.mtx` and `g.mtx`; an answer adds `u.mtx` and
//! `lambda.mtx`. Indices are the free dofs. A gap may be `inf`: a row without obstacle. Multigrid reads `near_null.mtx`
//! (one column for each displacement that costs next to no energy, as the rigid-body modes) or `coordinates.mtx` (one
//! row for each node). A sweep goes to other gaps, `g1.mtx`, another load, `f1.mtx`, or both.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::{Error, LinearError, Result};
use crate::linear::SymmetricMatrix;
use crate::linear::file::Streamed;
use crate::linear::matrix_market::{
    Allowed, Content, FINITE, GAPS, format_vector, matrix, read_vector, vector, write_columns, write_entries,
};
use crate::linear::multigrid::NearNullSpace;
use crate::problem::ContactProblem;
use crate::solution::Solution;

/// The file that makes a directory one of Matrix Market files.
pub const STIFFNESS: &str = "K.mtx";

pub fn read_problem(directory: &Path) -> Result<ContactProblem> {
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
fn with_equalities(directory: &Path, problem: ContactProblem) -> Result<ContactProblem> {
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

pub fn read_other_end(directory: &Path, problem: &ContactProblem) -> Result<ContactProblem> {
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
fn near_null(directory: &Path, dofs: usize) -> Result<Option<NearNullSpace>> {
    let [given, of_nodes] = ["near_null.mtx", "coordinates.mtx"].map(|name| directory.join(name));
    let is_given = given.exists();
    let file = if is_given { given } else { of_nodes };
    if !file.exists() {
        return Ok(None);
    }
    let content = Content::read(&file, FINITE)?;
    let (rows, columns) = (content.rows, content.columns);
    let found = format!("it is {rows} x {columns}");
    if is_given && (rows != dofs || columns == 0) {
        return Err(fault(file, format!("{found}, but it must have {dofs} rows, one per dof, and a column at least")));
    }
    if !is_given && (!(1..=3).contains(&columns) || rows.checked_mul(columns) != Some(dofs)) {
        let message = format!(
            "{found}, which makes {} dofs, but there are {dofs}; it must have a row for each node and a column for each \
             coordinate, 1 to 3 (if supports have removed dofs, use near_null.mtx)",
            rows.saturating_mul(columns)
        );
        return Err(fault(file, message));
    }
    let columns = content.columns();
    let found = if is_given { NearNullSpace::new(columns, dofs) } else { NearNullSpace::of_nodes(&columns) };
    found.map(Some).map_err(|error| fault(file, error.to_string()))
}

fn fault(file: PathBuf, message: String) -> Error {
    LinearError::FileSyntax { file, line: 1, message }.into()
}

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
