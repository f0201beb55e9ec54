//! Matrix Market files: matrices and vectors as text, read line by line; every error names its line.
//!
//! # Source
//! R. F. Boisvert, R. Pozo, K. A. Remington, *The Matrix Market Exchange Formats: Initial Design*, NISTIR 5935 (1996).

use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

use crate::error::Error;
use crate::file::{Capped, Streamed, open_capped, unread};
use crate::{SparseMatrix, SymmetricMatrix};

/// The Matrix Market file of a vector in any unit, as text: an array of one column, one entry per line, in the order of
/// the vector.
pub fn format_vector(vector: &[f64]) -> String {
    Streamed::new("vector", |out| write_columns(out, &[vector])).text()
}

impl SparseMatrix {
    /// Reads a Matrix Market file; of a symmetric one both triangles. For the crates of this workspace.
    #[doc(hidden)]
    pub fn read(file: &Path) -> Result<Self, Error> {
        let (is_symmetric, lower) = matrix(file, None)?;
        if !is_symmetric {
            return Ok(lower);
        }
        let below = lower.triplets().filter(|(row, column, _)| row != column);
        let above = below.map(|(row, column, value)| (column, row, value));
        let all: Vec<_> = lower.triplets().chain(above).collect();
        SparseMatrix::from_triplets(lower.rows(), lower.columns(), &all)
    }

    /// Reads a file as [`read_vector`] does, in which `-inf` and `inf` stand for no bound. For the crates of this
    /// workspace.
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
pub fn matrix(file: &Path, dofs: Option<usize>) -> Result<(bool, SparseMatrix), Error> {
    let content = Content::read(file, FINITE)?;
    let fits = dofs == Some(content.columns);
    content.check_filled(file, if fits { content.rows } else { content.rows.max(content.columns) })?;
    let matrix = SparseMatrix::from_triplets(content.rows, content.columns, &content.entries)?;
    Ok((content.symmetric, matrix))
}

/// Most bytes of a matrix in text, which is not held in memory: fifty million dofs of a body in space.
const MOST_OF_MATRIX: u64 = 64 << 30;

/// Bytes of a text that are read at a time.
const PIECE: usize = 1 << 20;

/// Bytes of a line beyond this number are skipped: no valid line is as long.
const LONGEST: usize = 1 << 16;

/// More rows or columns than this are refused before anything is allocated.
const LARGEST_DIMENSION: usize = 100_000_000;

/// Largest number of empty rows or columns: nothing is allocated from an announced size alone.
const MOST_EMPTY: usize = 1_000_000;

/// The content of a file: shape, entries (indices from 0), and whether only one triangle is stored.
#[derive(Debug)]
pub struct Content {
    /// The line of its sizes, from 1.
    pub line: usize,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// `true` if the file has the lower triangle of a symmetric matrix.
    pub symmetric: bool,
    /// Row and column from 0, and value.
    pub entries: Vec<(usize, usize, f64)>,
}

/// Least bytes of an entry or a value, with the end of its line.
const LEAST_OF_ENTRY: u64 = 2;

/// Words of a file in an error are cut to this number of characters.
const LONGEST_EXCERPT: usize = 80;

/// The values that a file may hold, and the same in words.
pub type Allowed = (fn(f64) -> bool, &'static str);

/// Finite numbers.
pub const FINITE: Allowed = (f64::is_finite, "finite");

/// Gaps: `inf` is a row without obstacle.
pub const GAPS: Allowed = (|gap| gap > f64::NEG_INFINITY, "finite, or inf for a row without obstacle");

/// Lower and upper bounds: `-inf` and `inf` are none.
pub const BOUNDS: Allowed = (|bound| !bound.is_nan(), "a number, or -inf or inf without a bound");

impl Content {
    /// Reads a file with these values; errors name its path.
    pub fn read(file: &Path, allowed: Allowed) -> Result<Self, Error> {
        let text = open_capped(file, MOST_OF_MATRIX)?;
        let (length, may_quote) = (text.length, is_inside(file));
        let reader = BufReader::with_capacity(PIECE, text);
        let mut lines = TextLines { file, may_quote, reader, number: 0, bytes: Vec::new(), text: String::new() };
        if !lines.advance()? {
            return Err(lines.fault_at(1, "the file is empty"));
        }
        let (is_array, symmetric) = lines.header()?;
        if !lines.advance_to_data()? {
            return Err(lines.fault_at(1, "the line with the sizes is missing"));
        }
        let (rows, columns, announced) = lines.sizes(is_array, symmetric)?;
        let mut content = Content { line: lines.number, rows, columns, symmetric, entries: Vec::new() };
        // Room for the announced entries, as far as the length of the file makes their number credible: without it, a
        // growing vector would take twice the memory for a while. Without reserved room, entries are taken one by one.
        let _ = content.entries.try_reserve_exact(announced.min((length / LEAST_OF_ENTRY) as usize));
        match is_array {
            true => lines.array(&mut content, allowed)?,
            false => lines.coordinates(&mut content, announced, allowed)?,
        }
        Ok(content)
    }

    /// Refuses a number of rows or columns (`lines`) that is not credible for the entries of the file.
    pub fn check_filled(&self, file: &Path, lines: usize) -> Result<(), Error> {
        let (rows, columns, entries) = (self.rows, self.columns, self.entries.len());
        if lines <= entries.saturating_add(MOST_EMPTY) {
            return Ok(());
        }
        let message =
            format!("a matrix of {rows} x {columns} with {entries} entries is almost empty; correct its size");
        Err(Error::FileSyntax { file: file.to_path_buf(), line: self.line, message })
    }

    /// The columns of an array, length `rows` each, in the unit of its file.
    pub fn columns(&self) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; self.rows]; self.columns];
        self.entries.iter().for_each(|&(row, column, value)| columns[column][row] += value);
        columns
    }
}

/// Returns `false` if the file is a link out of its folder, perhaps to one that the reader of an error may not see.
fn is_inside(file: &Path) -> bool {
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    matches!((file.canonicalize(), folder.canonicalize()), (Ok(file), Ok(folder)) if file.starts_with(&folder))
}

struct TextLines<'a> {
    file: &'a Path,
    /// Permission for an error to quote the content of the file.
    may_quote: bool,
    reader: BufReader<Capped>,
    /// Number of the present line, from 1.
    number: usize,
    bytes: Vec<u8>,
    /// The present line without blanks at its ends.
    text: String,
}

impl TextLines<'_> {
    fn fault_at(&self, line: usize, message: impl Into<String>) -> Error {
        Error::FileSyntax { file: self.file.to_path_buf(), line, message: message.into() }
    }

    fn fault(&self, message: impl Into<String>) -> Error {
        self.fault_at(self.number, message)
    }

    /// The beginning of a text from the file, in quotation marks.
    fn excerpt(&self, words: &str) -> String {
        match words.char_indices().nth(LONGEST_EXCERPT) {
            _ if !self.may_quote => {
                "something that is not shown (a link leads to a file outside the folder)".to_string()
            }
            Some((end, _)) => format!("`{}...`", &words[..end]),
            None => format!("`{words}`"),
        }
    }

    /// The content of the first line: whether the file is an array, and whether it is symmetric.
    fn header(&self) -> Result<(bool, bool), Error> {
        let words: Vec<String> = self.text.split_whitespace().map(str::to_lowercase).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let ["%%matrixmarket", "matrix", layout, field, symmetry] = words[..] else {
            let expected = "%%MatrixMarket matrix coordinate|array real|integer general|symmetric";
            let found = self.excerpt(&self.text);
            return Err(self.fault(format!("the first line is {found}; it must be `{expected}`")));
        };
        let one_of = |what: &str, found: &str, [one, other]: [&str; 2]| {
            let words = || format!("the {what} is {}; it must be `{one}` or `{other}`", self.excerpt(found));
            if [one, other].contains(&found) { Ok(found == other) } else { Err(self.fault(words())) }
        };
        let is_array = one_of("layout", layout, ["coordinate", "array"])?;
        one_of("field", if field == "double" { "real" } else { field }, ["real", "integer"])?;
        Ok((is_array, one_of("symmetry", symmetry, ["general", "symmetric"])?))
    }

    /// Rows, columns and the number of entries, which a file of coordinates announces.
    fn sizes(&self, is_array: bool, symmetric: bool) -> Result<(usize, usize, usize), Error> {
        let numbers: Option<Vec<usize>> = self.text.split_whitespace().map(|word| word.parse().ok()).collect();
        let (rows, columns, announced) = match (numbers.as_deref(), is_array) {
            (Some(&[rows, columns]), true) => (rows, columns, rows.saturating_mul(columns)),
            (Some(&[rows, columns, announced]), false) => (rows, columns, announced),
            (_, is_array) => {
                let (count, names) = if is_array { (2, "rows and columns") } else { (3, "rows, columns and entries") };
                let found = self.excerpt(&self.text);
                return Err(self.fault(format!("the sizes are {found}; they must be {count} whole numbers ({names})")));
            }
        };
        if rows.max(columns) > LARGEST_DIMENSION {
            let message = format!("{rows} x {columns} is too large; at most {LARGEST_DIMENSION} each way");
            return Err(self.fault(message));
        }
        if symmetric && rows != columns {
            return Err(self.fault(format!("a symmetric matrix must be square, not {rows} x {columns}")));
        }
        Ok((rows, columns, announced))
    }

    /// One value a line, column by column.
    fn array(&mut self, content: &mut Content, allowed: Allowed) -> Result<(), Error> {
        let Content { rows, columns, symmetric, .. } = *content;
        let mut places =
            (0..columns).flat_map(|column| (if symmetric { column } else { 0 }..rows).map(move |row| (row, column)));
        while self.advance_to_data()? {
            let not_a_number = |_| self.fault(format!("{} is not a number", self.excerpt(&self.text)));
            let value = self.checked(self.text.parse().map_err(not_a_number)?, allowed)?;
            let Some((row, column)) = places.next() else {
                return Err(self.fault(format!("there are more values than the {rows} x {columns} announced")));
            };
            content.entries.push((row, column, value));
        }
        let Some((row, column)) = places.next() else { return Ok(()) };
        Err(self.fault(format!("the file ends before the value of ({}, {})", row + 1, column + 1)))
    }

    /// One entry a line: row, column, value.
    fn coordinates(&mut self, content: &mut Content, announced: usize, allowed: Allowed) -> Result<(), Error> {
        while self.advance_to_data()? {
            let (row, column, value) = self.entry(content)?;
            if content.entries.len() == announced {
                return Err(self.fault(format!("there are more entries than the {announced} announced")));
            }
            content.entries.push((row, column, self.checked(value, allowed)?));
        }
        let found = content.entries.len();
        if found < announced {
            return Err(self.fault(format!("the file ends after {found} of {announced} entries")));
        }
        Ok(())
    }

    fn checked(&self, value: f64, (is_allowed, words): Allowed) -> Result<f64, Error> {
        let refused = || self.fault(format!("the value is {value}; it must be {words}"));
        is_allowed(value).then_some(value).ok_or_else(refused)
    }

    /// The entry of the present line, indices from 0.
    fn entry(&self, content: &Content) -> Result<(usize, usize, f64), Error> {
        let Content { rows, columns, symmetric, .. } = *content;
        let mut words = self.text.split_whitespace();
        let mut word = || words.next();
        let entry = match (word(), word(), word(), word()) {
            (Some(row), Some(column), Some(value), None) => {
                row.parse().ok().zip(column.parse().ok()).zip(value.parse().ok())
            }
            _ => None,
        };
        let Some(((row, column), value)): Option<((usize, usize), f64)> = entry else {
            let found = self.excerpt(&self.text);
            return Err(self.fault(format!("{found} is not an entry; it must be `row column value`")));
        };
        if row == 0 || column == 0 || row > rows || column > columns {
            let message = format!("entry ({row}, {column}) lies outside {rows} x {columns} (indices from 1)");
            return Err(self.fault(message));
        }
        if symmetric && row < column {
            let rule = "a symmetric file holds the lower triangle";
            return Err(self.fault(format!("entry ({row}, {column}) lies above the diagonal; {rule}")));
        }
        Ok((row - 1, column - 1, value))
    }

    /// Reads the next line that is neither blank nor a comment; `false` at the end of the file.
    fn advance_to_data(&mut self) -> Result<bool, Error> {
        while self.advance()? {
            if !self.text.is_empty() && !self.text.starts_with('%') {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Reads a line; `false` at the end of the file.
    fn advance(&mut self) -> Result<bool, Error> {
        self.bytes.clear();
        let piece = self.reader.by_ref().take(LONGEST as u64).read_until(b'\n', &mut self.bytes);
        piece.map_err(unread(self.file))?;
        if self.bytes.is_empty() {
            return Ok(false);
        }
        if self.bytes.len() == LONGEST && !self.bytes.ends_with(b"\n") {
            self.reader.skip_until(b'\n').map_err(unread(self.file))?;
        }
        self.number += 1;
        // Comments of older collections hold names in other encodings; the numbers are always ASCII.
        let text = String::from_utf8_lossy(&self.bytes);
        // Some editors put a byte order mark in front.
        let mark = if self.number == 1 { "\u{feff}" } else { "" };
        self.text.clear();
        self.text.push_str(text.strip_prefix(mark).unwrap_or(&text).trim());
        Ok(true)
    }
}
