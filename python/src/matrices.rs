//! Converts matrices of scipy, numpy and dolfinx into matrices of the library, and back.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use signorini::qp::LinearError as Error;
use signorini::{SparseMatrix, SymmetricMatrix};

use crate::arrays::{Indices, is_array, kind_of, room, slice, with_reals, with_table};
use crate::errors::{bad_input, bad_type};
use crate::exceptions::plain_exception;

/// The forms in which a matrix can be given.
enum Source<'py> {
    /// Compressed columns.
    Columns(Compressed<'py>),
    /// Compressed rows.
    Rows(Compressed<'py>),
    /// Entries, each with its row and column.
    Entries { rows: Bound<'py, PyAny>, columns: Bound<'py, PyAny>, values: Bound<'py, PyAny> },
    /// A dense array.
    Table(Bound<'py, PyAny>),
}

/// The arrays of compressed columns or rows.
struct Compressed<'py> {
    starts: Bound<'py, PyAny>,
    indices: Bound<'py, PyAny>,
    values: Bound<'py, PyAny>,
}

impl<'py> Compressed<'py> {
    fn of(matrix: &Bound<'py, PyAny>) -> PyResult<Self> {
        Ok(Compressed {
            starts: matrix.getattr("indptr")?,
            indices: matrix.getattr("indices")?,
            values: matrix.getattr("data")?,
        })
    }
}

/// The form of a matrix and its shape. The shape is `None` for a dense array, which is converted before its shape is
/// known.
struct Seen<'py> {
    source: Source<'py>,
    shape: Option<[usize; 2]>,
}

fn shape_of(name: &str, matrix: &Bound<'_, PyAny>) -> PyResult<[usize; 2]> {
    let shape = matrix.getattr("shape")?;
    shape
        .extract::<(usize, usize)>()
        .map(<[usize; 2]>::from)
        .map_err(|_| bad_input(matrix.py(), format!("{name} has the shape {shape}; it must have two dimensions")))
}

/// Largest number of rows or columns that a matrix may have beyond its number of entries. More of them would waste
/// memory.
const MOST_EMPTY: usize = 1_000_000;

/// Returns `true` if `matrix` is none of scipy but converts itself into one without a copy, as a matrix of dolfinx
/// does.
fn converts_itself(matrix: &Bound<'_, PyAny>) -> PyResult<bool> {
    Ok(!matrix.hasattr("format")? && matrix.hasattr("to_scipy")?)
}

/// Determines the form of `matrix`. A matrix with `dofs` columns may have any number of empty ones.
fn look<'py>(name: &str, matrix: &Bound<'py, PyAny>, dofs: usize) -> PyResult<Seen<'py>> {
    let py = matrix.py();
    if matrix.is_none() {
        return Err(bad_type(py, format!("{name} is None; it must be a sparse matrix of scipy or an array of numpy")));
    }
    if is_array(matrix)? {
        return Ok(Seen { source: Source::Table(matrix.clone()), shape: None });
    }
    let converted;
    let matrix = if converts_itself(matrix)? {
        converted = matrix.call_method0("to_scipy")?;
        // One level only: an object may return itself.
        if converts_itself(&converted)? {
            let (given, returned) = (kind_of(matrix), kind_of(&converted));
            let sentence = format!(
                "{name} is a {given} whose `to_scipy()` returns a {returned}, which is no matrix; it must return a sparse matrix of scipy"
            );
            return Err(bad_type(py, sentence));
        }
        &converted
    } else {
        matrix
    };
    let Ok(format) = matrix.getattr("format").and_then(|format| format.extract::<String>()) else {
        if matrix.hasattr("indptr")? {
            let kind = kind_of(matrix);
            return Err(bad_type(
                py,
                format!("{name} is a {kind} with `indptr`; make it a csr_array or csc_array of scipy"),
            ));
        }
        return Ok(Seen { source: Source::Table(matrix.clone()), shape: None });
    };
    let [rows, columns] = shape_of(name, matrix)?;
    let shape = Some([rows, columns]);
    if !matches!(format.as_str(), "csc" | "csr") {
        let entries = matrix.getattr("nnz").and_then(|entries| entries.extract::<usize>());
        let entries = entries.map_err(|error| bad_input(py, format!("{name} is no matrix: {}", error.value(py))))?;
        let lines = if columns == dofs { rows } else { rows.max(columns) };
        if lines > entries.saturating_add(MOST_EMPTY) {
            let sentence =
                format!("{name} is {rows} x {columns} with {entries} entries, almost empty; check its shape");
            return Err(bad_input(py, sentence));
        }
    }
    let source = match format.as_str() {
        "csc" => Source::Columns(Compressed::of(matrix)?),
        "csr" => Source::Rows(Compressed::of(matrix)?),
        "coo" => Source::Entries {
            rows: matrix.getattr("row")?,
            columns: matrix.getattr("col")?,
            values: matrix.getattr("data")?,
        },
        _ => {
            if format == "bsr" {
                // scipy does not check this itself: for blocks outside the matrix it would write outside its memory.
                let checked = matrix.call_method1("check_format", (true,));
                checked.map_err(|error| bad_input(py, format!("{name} is no matrix: {}", error.value(py))))?;
            }
            let columns = matrix.call_method0("tocsc");
            let columns = columns.map_err(|error| {
                bad_input(py, format!("{name} cannot be converted to compressed columns: {}", error.value(py)))
            })?;
            Source::Columns(Compressed::of(&columns)?)
        }
    };
    Ok(Seen { source, shape })
}

/// Compressed rows or columns ("lines") that are read in place.
struct Lines<'a> {
    starts: Indices,
    indices: Indices,
    values: &'a [f64],
    /// Number of lines.
    count: usize,
}

/// Passes `count` compressed lines to `take`, in place.
fn with_lines<T>(
    name: &str,
    compressed: &Compressed<'_>,
    count: usize,
    take: impl FnOnce(Lines<'_>) -> PyResult<T>,
) -> PyResult<T> {
    let py = compressed.starts.py();
    let starts = Indices::of(&format!("indptr of {name}"), &compressed.starts)?;
    let indices = Indices::of(&format!("indices of {name}"), &compressed.indices)?;
    if starts.len() != count + 1 {
        let found = starts.len();
        return Err(bad_input(py, format!("indptr of {name} has length {found}; it must have length {}", count + 1)));
    }
    with_reals(&format!("data of {name}"), &compressed.values, |values| {
        if values.len() != indices.len() {
            let (data, indices) = (values.len(), indices.len());
            return Err(bad_input(py, format!("{name} has {data} entries in data and {indices} in indices")));
        }
        take(Lines { starts, indices, values, count })
    })
}

impl Lines<'_> {
    /// Returns the entries `(line, index, value)` in any order, with duplicates. The starts of the lines must not
    /// decrease.
    fn entries(&self, py: Python<'_>, name: &str) -> PyResult<Vec<(usize, usize, f64)>> {
        let (starts, indices) = (self.starts.to_usize(py)?, self.indices.to_usize(py)?);
        if let Some(&first) = starts.first().filter(|&&first| first != 0) {
            let first = if first == usize::MAX { "a negative number".into() } else { first.to_string() };
            return Err(bad_input(py, format!("indptr of {name} begins with {first}; it must begin with 0")));
        }
        let mut entries = room(py, self.values.len())?;
        for line in 0..self.count {
            let (first, end) = (starts[line], starts[line + 1]);
            let (Some(indices), Some(values)) = (indices.get(first..end), self.values.get(first..end)) else {
                let sentence = format!(
                    "indptr of {name} goes from {first} to {end} in line {line} (from 0); it must not decrease, nor go beyond {} entries",
                    self.values.len()
                );
                return Err(bad_input(py, sentence));
            };
            entries.extend(indices.iter().zip(values).map(|(&index, &value)| (line, index, value)));
        }
        Ok(entries)
    }
}

fn check_square(py: Python<'_>, name: &str, [rows, columns]: [usize; 2]) -> PyResult<()> {
    match rows == columns {
        true => Ok(()),
        false => Err(bad_input(py, format!("{name} is {rows} x {columns}; it must be square"))),
    }
}

fn look_square<'py>(name: &str, matrix: &Bound<'py, PyAny>) -> PyResult<Seen<'py>> {
    let seen = look(name, matrix, 0)?;
    seen.shape.map_or(Ok(()), |shape| check_square(matrix.py(), name, shape))?;
    Ok(seen)
}

/// Reads a square matrix; the shape of a dense one is not checked.
pub fn square(name: &str, matrix: &Bound<'_, PyAny>) -> PyResult<SparseMatrix> {
    general(name, look_square(name, matrix)?)
}

/// Reads the stiffness: a symmetric matrix, given with both triangles.
pub fn stiffness(name: &str, matrix: &Bound<'_, PyAny>) -> PyResult<SymmetricMatrix> {
    let py = matrix.py();
    let seen = look_square(name, matrix)?;
    if let Source::Table(table) = &seen.source {
        return with_table(name, table, |values, shape| {
            check_square(py, name, shape)?;
            SymmetricMatrix::from_table(shape[0], values).map_err(|error| plain_exception(py, error))
        });
    }
    if let (Source::Columns(lines), Some([dim, _])) | (Source::Rows(lines), Some([dim, _])) = (&seen.source, seen.shape)
    {
        let is_columns = matches!(seen.source, Source::Columns(_));
        let direct = with_lines(name, lines, dim, |lines| Ok(in_place(py, &lines, is_columns)))?;
        match direct {
            Some(Ok(matrix)) => return Ok(matrix),
            Some(Err(error @ (Error::NotSymmetric { .. } | Error::NotFinite { .. }))) => {
                return Err(plain_exception(py, error));
            }
            // The lines are not sorted, have duplicates or are not valid: they are read entry by entry below.
            Some(Err(_)) | None => {}
        }
    }
    let full = general(name, seen)?;
    SymmetricMatrix::from_full(&full).map_err(|error| plain_exception(py, error))
}

/// Reads the lower triangle of sorted lines in one pass. Returns `None` if the two index arrays have different widths.
fn in_place(py: Python<'_>, lines: &Lines<'_>, is_columns: bool) -> Option<Result<SymmetricMatrix, Error>> {
    fn of<I: Copy + TryInto<usize>>(
        starts: &[I],
        indices: &[I],
        values: &[f64],
        is_columns: bool,
    ) -> Result<SymmetricMatrix, Error> {
        match is_columns {
            true => SymmetricMatrix::from_csc(starts, indices, values),
            false => SymmetricMatrix::from_csr(starts, indices, values),
        }
    }
    match (&lines.starts, &lines.indices) {
        (Indices::Short(starts), Indices::Short(indices)) => {
            Some(of(slice(starts, py)?, slice(indices, py)?, lines.values, is_columns))
        }
        (Indices::Long(starts), Indices::Long(indices)) => {
            Some(of(slice(starts, py)?, slice(indices, py)?, lines.values, is_columns))
        }
        _ => None,
    }
}

/// Reads a matrix with any number of rows and `dofs` columns.
pub fn rows(name: &str, matrix: &Bound<'_, PyAny>, dofs: usize) -> PyResult<SparseMatrix> {
    let seen = look(name, matrix, dofs)?;
    if let Some([rows, columns]) = seen.shape.filter(|shape| shape[1] != dofs) {
        let sentence =
            format!("{name} is {rows} x {columns}; it must have {dofs} columns, one for each row of the stiffness");
        return Err(bad_input(matrix.py(), sentence));
    }
    general(name, seen)
}

fn general(name: &str, seen: Seen<'_>) -> PyResult<SparseMatrix> {
    let [rows, columns] = seen.shape.unwrap_or_default();
    match &seen.source {
        Source::Columns(lines) => {
            let py = lines.starts.py();
            with_lines(name, lines, columns, |lines| sorted_or_not(py, name, &lines, [rows, columns]))
        }
        Source::Rows(lines) => {
            let py = lines.starts.py();
            with_lines(name, lines, rows, |lines| {
                let of_lines = lines.entries(py, name)?;
                triplets(py, name, [rows, columns], of_lines)
            })
        }
        Source::Entries { rows: of_rows, columns: of_columns, values } => {
            let py = values.py();
            let of_rows = Indices::of(&format!("row of {name}"), of_rows)?.to_usize(py)?;
            let of_columns = Indices::of(&format!("col of {name}"), of_columns)?.to_usize(py)?;
            with_reals(&format!("data of {name}"), values, |values| {
                if of_rows.len() != values.len() || of_columns.len() != values.len() {
                    let (row, column, data) = (of_rows.len(), of_columns.len(), values.len());
                    return Err(bad_input(
                        py,
                        format!("{name} has {row} entries in row, {column} in col and {data} in data"),
                    ));
                }
                let mut entries = room(py, values.len())?;
                let places = of_rows.iter().zip(&of_columns);
                entries.extend(places.zip(values).map(|((&row, &column), &value)| (row, column, value)));
                triplets(py, name, [rows, columns], entries)
            })
        }
        Source::Table(table) => with_table(name, table, |values, [rows, columns]| {
            SparseMatrix::from_table(rows, columns, values).map_err(|error| plain_exception(table.py(), error))
        }),
    }
}

/// Reads compressed columns directly if they are sorted, and entry by entry otherwise.
fn sorted_or_not(py: Python<'_>, name: &str, lines: &Lines<'_>, shape: [usize; 2]) -> PyResult<SparseMatrix> {
    let (starts, indices) = (lines.starts.to_usize(py)?, lines.indices.to_usize(py)?);
    match SparseMatrix::from_csc(shape[0], starts, indices, crate::arrays::copied(py, lines.values)?) {
        Ok(matrix) => Ok(matrix),
        Err(_) => {
            let entries = lines.entries(py, name)?;
            let entries = entries.into_iter().map(|(column, row, value)| (row, column, value)).collect();
            triplets(py, name, shape, entries)
        }
    }
}

fn triplets(
    py: Python<'_>,
    name: &str,
    [rows, columns]: [usize; 2],
    entries: Vec<(usize, usize, f64)>,
) -> PyResult<SparseMatrix> {
    if let Some(&(row, column, value)) = entries.iter().find(|entry| entry.0 >= rows || entry.1 >= columns) {
        let index = |index: usize| if index == usize::MAX { "a negative index".into() } else { index.to_string() };
        let (row, column) = (index(row), index(column));
        let sentence = format!(
            "{name} has the entry {value} in row {row} and column {column} (from 0), outside its {rows} rows and {columns} columns"
        );
        return Err(bad_input(py, sentence));
    }
    SparseMatrix::from_triplets(rows, columns, &entries).map_err(|error| plain_exception(py, error))
}

/// Returns the arrays `(data, indices, indptr)` of compressed columns, as scipy expects them.
pub fn compressed<'py>(
    py: Python<'py>,
    matrix: &SparseMatrix,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let indices = crate::arrays::of_indices(py, matrix.row_indices().map(|row| row as usize))?;
    let starts = crate::arrays::of_indices(py, matrix.column_starts().iter().copied())?;
    Ok((crate::arrays::of_reals(py, matrix.values())?, indices, starts))
}

/// Converts a matrix into a csc_array of scipy.
pub fn csc<'py>(py: Python<'py>, matrix: &SparseMatrix) -> PyResult<Bound<'py, PyAny>> {
    let shape = PyDict::new(py);
    shape.set_item("shape", (matrix.rows(), matrix.columns()))?;
    py.import("scipy.sparse")?.getattr("csc_array")?.call((compressed(py, matrix)?,), Some(&shape))
}
