//! The problem of a directory of PETSc files: supported components are left out again.

use std::path::Path;

use super::source::{INTEGER, REAL, RowReader, dense_columns, indices, vector};
use super::{BLOCK_SIZE, CONTACT, COORDINATES, EQUALITIES, FREE, GAP, INFO, LOAD, NEAR_NULL, STIFFNESS, VALUES};
use crate::error::{Error, LinearError};
use crate::linear::file::read_text_capped;
use crate::linear::multigrid::NearNullSpace;
use crate::linear::{SparseMatrix, SymmetricLines, SymmetricMatrix};
use crate::problem::ContactProblem;

/// Gaps from this value on mean no obstacle: PETSc has no other infinity for bounds.
const NO_LIMIT: f64 = 1e20;

/// Most bytes of a file of options.
const MOST_OF_INFO: u64 = 1 << 16;

/// Mark of a place of a supported component.
const SUPPORTED: u32 = u32::MAX;

/// Reads the problem of a directory of PETSc files: the small ones first, then the stiffness row by row.
pub fn read_problem(directory: &Path) -> Result<ContactProblem, Error> {
    let stiffness = RowReader::open(&directory.join(STIFFNESS))?;
    let (size, columns) = stiffness.shape;
    if columns != size {
        let message = format!("the stiffness is {size} x {columns}; it must have as many columns as rows");
        return Err(stiffness.wrong_shape(message).into());
    }
    let (free, mut dof) = (indices(&directory.join(FREE), size)?, vec![SUPPORTED; size]);
    free.iter().enumerate().for_each(|(number, &place)| dof[place as usize] = number as u32);
    let places = Places { free, dof };
    let load = places.load(&directory.join(LOAD))?;
    let contact = places.rows(RowReader::open(&directory.join(CONTACT))?)?;
    let gap = gap(&directory.join(GAP), (CONTACT, contact.rows()))?;
    let near_null = places.near_null(directory)?;
    let problem = ContactProblem::new(places.stiffness(stiffness)?, load, contact, gap)?;
    let problem = places.with_equalities(directory, problem)?;
    match near_null {
        Some(near_null) => problem.with_near_null(near_null),
        None => Ok(problem),
    }
}

/// The gaps, or values, of all rows of another file.
fn gap(file: &Path, (of, rows): (&str, usize)) -> Result<Vec<f64>, LinearError> {
    let is_allowed = |gap: f64| gap > f64::NEG_INFINITY;
    let mut gap = vector(file, is_allowed, "a finite gap, or 1e20 or more for a row without obstacle")?;
    if gap.len() != rows {
        let message = format!("it has length {}, but {of} has {rows} rows", gap.len());
        return Err(fault(file, message));
    }
    gap.iter_mut().filter(|gap| **gap >= NO_LIMIT).for_each(|gap| *gap = f64::INFINITY);
    Ok(gap)
}

/// The error of a vector of wrong size.
fn fault(file: &Path, message: String) -> LinearError {
    LinearError::FileBytes { file: file.to_path_buf(), byte: INTEGER as usize, message }
}

struct Places {
    /// The place in the stiffness of each free dof, increasing.
    free: Vec<u32>,
    /// The free dof at each place, or [`SUPPORTED`].
    dof: Vec<u32>,
}

impl Places {
    fn load(&self, file: &Path) -> Result<Vec<f64>, LinearError> {
        let load = vector(file, f64::is_finite, "finite")?;
        if load.len() != self.dof.len() {
            let message = format!("it has length {}, but {STIFFNESS} has {} rows", load.len(), self.dof.len());
            return Err(fault(file, message));
        }
        let supported = |&(place, value): &(usize, &f64)| self.dof[place] == SUPPORTED && *value != 0.0;
        if let Some((place, value)) = load.iter().enumerate().find(supported) {
            let message = format!("value {place} is {value} (from 0), but {FREE} does not name it: it must be 0");
            let byte = (2 * INTEGER + REAL * place as u64) as usize;
            return Err(LinearError::FileBytes { file: file.to_path_buf(), byte, message });
        }
        Ok(self.free.iter().map(|&place| load[place as usize]).collect())
    }

    /// Leaves out entries of supported components, which must be zero but on their diagonal, in the row of place `own`.
    fn leave_out(&self, rows: &mut RowReader, own: Option<usize>) -> Result<(), LinearError> {
        let (supported, mut kept) = (own.filter(|&own| self.dof[own] == SUPPORTED), 0);
        for entry in 0..rows.columns.len() {
            let (column, value) = (rows.columns[entry] as usize, rows.values[entry]);
            let left = supported.unwrap_or(column);
            if self.dof[left] != SUPPORTED {
                (rows.columns[kept], rows.values[kept]) = (self.dof[column], value);
                kept += 1;
            } else if value != 0.0 && own != Some(column) {
                let place = format!("entry ({}, {column}) is {value:e} (indices from 0)", rows.row());
                return Err(rows.fault(entry, format!("{place}, but {FREE} does not name {left}: it must be 0")));
            }
        }
        rows.columns.truncate(kept);
        rows.values.truncate(kept);
        Ok(())
    }

    fn rows(&self, mut rows: RowReader) -> Result<SparseMatrix, LinearError> {
        if rows.shape.1 != self.dof.len() {
            let found = format!("it has {} columns, but {STIFFNESS} has {} rows", rows.shape.1, self.dof.len());
            return Err(rows.wrong_shape(found));
        }
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        while rows.read()? {
            self.leave_out(&mut rows, None)?;
            columns.extend(rows.columns.iter().map(|&column| column as usize));
            values.extend_from_slice(&rows.values);
            starts.push(columns.len());
        }
        Ok(SparseMatrix::from_csc(self.free.len(), starts, columns, values)?.transposed())
    }

    /// The problem with the equality rows of `E.petsc` and `e.petsc`, if there is either file.
    fn with_equalities(&self, directory: &Path, problem: ContactProblem) -> Result<ContactProblem, Error> {
        let [rows, values] = [EQUALITIES, VALUES].map(|name| directory.join(name));
        if !rows.exists() && !values.exists() {
            return Ok(problem);
        }
        let rows = self.rows(RowReader::open(&rows)?)?;
        problem.with_equalities(&rows, gap(&values, (EQUALITIES, rows.rows()))?)
    }

    fn stiffness(&self, mut rows: RowReader) -> Result<SymmetricMatrix, LinearError> {
        let mut matrix = SymmetricLines::of_rows(self.free.len(), rows.entries)?;
        while rows.read()? {
            let own = rows.row();
            self.leave_out(&mut rows, Some(own))?;
            if self.dof[own] != SUPPORTED {
                matrix.take(&rows.columns, &rows.values).map_err(|error| self.located(error, &rows))?;
            }
        }
        SymmetricMatrix::from_lower(matrix.lower().map_err(|error| self.located(error, &rows))?)
    }

    /// Two triangles that differ, at their places in the file.
    fn located(&self, error: LinearError, rows: &RowReader) -> LinearError {
        let LinearError::NotSymmetric { row, column, value, mirrored } = error else { return error };
        let [row, column] = [row, column].map(|dof| self.free[dof]);
        let entries = format!("entry ({row}, {column}) is {value:e}, entry ({column}, {row}) is {mirrored:e}");
        let allowed = "they may differ by 1e-10 of the diagonal";
        rows.fault(0, format!("the stiffness is not symmetric: {entries} (indices from 0); {allowed}"))
    }

    /// The near-null space: `near_null.petsc`, a column for each vector, or else the rigid-body modes of the nodes in
    /// `coordinates.petsc`. The latter are not exact if components are in a local frame.
    fn near_null(&self, directory: &Path) -> Result<Option<NearNullSpace>, LinearError> {
        let of_free = |vector: &Vec<f64>| self.free.iter().map(|&place| vector[place as usize]).collect();
        let file = directory.join(NEAR_NULL);
        if file.exists() {
            let vectors = dense_columns(&file, self.dof.len())?;
            let near_null = NearNullSpace::new(vectors.iter().map(of_free).collect(), self.free.len());
            return near_null.map(Some).map_err(|error| fault(&file, error.to_string()));
        }
        let file = directory.join(COORDINATES);
        if !file.exists() {
            return Ok(None);
        }
        let (size, coordinates) = (block_size(directory)?, vector(&file, f64::is_finite, "finite")?);
        if coordinates.len() != self.dof.len() || coordinates.len() % size != 0 {
            let needed = format!("{STIFFNESS} has {} rows in blocks of {size}", self.dof.len());
            return Err(fault(&file, format!("it has length {}, but {needed}", coordinates.len())));
        }
        let axis = |axis: usize| coordinates.iter().skip(axis).step_by(size).copied().collect();
        let modes = NearNullSpace::of_nodes(&(0..size).map(axis).collect::<Vec<_>>());
        let modes = modes.map_err(|error| fault(&file, error.to_string()))?;
        Ok(NearNullSpace::of_modes(modes.vectors().iter().map(of_free).collect()))
    }
}

/// The number of dofs of a node, from `K.petsc.info`.
fn block_size(directory: &Path) -> Result<usize, LinearError> {
    let file = directory.join(INFO);
    let text = read_text_capped(&file, MOST_OF_INFO)?;
    let mut words = text.split_whitespace().skip_while(|&word| word != BLOCK_SIZE).skip(1);
    match words.next().and_then(|word| word.parse().ok()) {
        Some(size @ 1..=3) => Ok(size),
        _ => {
            let message = format!("it must have the line `{BLOCK_SIZE} D`, with 1, 2 or 3 dofs for each node");
            Err(LinearError::FileSyntax { file, line: 1, message })
        }
    }
}
