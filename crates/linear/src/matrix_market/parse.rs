//! Reading the text of a Matrix Market file, line by line; every error names its line.

use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::file::Capped;

/// Bytes of a text that are read at a time.
const PIECE: usize = 1 << 20;

/// Bytes of a line beyond this number are skipped: no valid line is as long.
const LONGEST: usize = 1 << 16;

/// More rows or columns than this are refused before anything is allocated.
const LARGEST_DIMENSION: usize = 100_000_000;

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

/// The required content of the second line of a file of coordinates.
const COORDINATE_SIZES: &str = "3 whole numbers (rows, columns and entries)";

/// Least bytes of an entry or a value, with the end of its line.
const LEAST_OF_ENTRY: u64 = 2;

/// Words of a file in an error are cut to this number of characters.
const LONGEST_EXCERPT: usize = 80;

/// The values that a file may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AllowedValues {
    /// Finite numbers.
    Finite,
    /// Gaps: `inf` is a row without obstacle.
    FiniteOrInfinite,
    /// Lower and upper bounds: `-inf` and `inf` are none.
    Bounds,
}

/// Permission for an error to quote the content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quotes {
    Allowed,
    /// A link leads out of the folder, perhaps to a file that the reader of the error may not see.
    Withheld,
}

/// Parses an open file; errors name its path.
pub(super) fn parse(file: &Path, text: Capped, values: AllowedValues, quotes: Quotes) -> Result<Content, Error> {
    let source = TextSource { file, length: text.length, values, quotes };
    let mut lines = TextLines::of(file, text);
    let header = match lines.next()? {
        Some((_, first)) => source.header(first)?,
        None => return Err(source.fault(1, "the file is empty")),
    };
    let Some((line, sizes)) = lines.next_data()? else {
        return Err(source.fault(1, "the line with the sizes is missing"));
    };
    let (rows, columns, announced) = source.sizes(&header, line, sizes)?;
    let symmetric = header.symmetric;
    let content = Content { line, rows, columns, symmetric, entries: Vec::new() };
    match header.is_array {
        true => source.array(content, &mut lines),
        false => source.coordinates(content, announced, &mut lines),
    }
}

/// A file and its permitted content.
struct TextSource<'a> {
    file: &'a Path,
    /// Bytes of the file, if known.
    length: u64,
    values: AllowedValues,
    quotes: Quotes,
}

/// The content of the first line.
struct Header {
    is_array: bool,
    symmetric: bool,
}

impl TextSource<'_> {
    fn fault(&self, line: usize, message: impl Into<String>) -> Error {
        Error::FileSyntax { file: self.file.to_path_buf(), line, message: message.into() }
    }

    fn header(&self, first: &str) -> Result<Header, Error> {
        let words: Vec<String> = first.split_whitespace().map(str::to_lowercase).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let ["%%matrixmarket", "matrix", layout, field, symmetry] = words[..] else {
            let expected = "%%MatrixMarket matrix coordinate|array real|integer general|symmetric";
            let message = format!("the first line is {}; it must be `{expected}`", self.quotes.excerpt(first));
            return Err(self.fault(1, message));
        };
        let wrong = |what: &str, found: &str, allowed: &str| {
            self.fault(1, format!("the {what} is {}; it must be {allowed}", self.quotes.excerpt(found)))
        };
        let is_array = match layout {
            "coordinate" => false,
            "array" => true,
            other => return Err(wrong("layout", other, "`coordinate` or `array`")),
        };
        if !["real", "integer", "double"].contains(&field) {
            return Err(wrong("field", field, "`real` or `integer`"));
        }
        match symmetry {
            "general" => Ok(Header { is_array, symmetric: false }),
            "symmetric" => Ok(Header { is_array, symmetric: true }),
            other => Err(wrong("symmetry", other, "`general` or `symmetric`")),
        }
    }

    /// Rows, columns and, in a file of coordinates, the number of entries announced.
    fn sizes(&self, header: &Header, line: usize, sizes: &str) -> Result<(usize, usize, usize), Error> {
        let numbers: Option<Vec<usize>> = sizes.split_whitespace().map(|word| word.parse().ok()).collect();
        let (rows, columns, announced) = match (numbers.as_deref(), header.is_array) {
            (Some(&[rows, columns]), true) => (rows, columns, 0),
            (Some(&[rows, columns, announced]), false) => (rows, columns, announced),
            (_, is_array) => {
                let names = if is_array { "2 whole numbers (rows and columns)" } else { COORDINATE_SIZES };
                let message = format!("the sizes are {}; they must be {names}", self.quotes.excerpt(sizes));
                return Err(self.fault(line, message));
            }
        };
        if rows.max(columns) > LARGEST_DIMENSION {
            let message = format!("{rows} x {columns} is too large; at most {LARGEST_DIMENSION} each way");
            return Err(self.fault(line, message));
        }
        if header.symmetric && rows != columns {
            let message = format!("a symmetric matrix must be square, not {rows} x {columns}");
            return Err(self.fault(line, message));
        }
        Ok((rows, columns, announced))
    }

    /// One value a line, column by column.
    fn array(&self, mut content: Content, lines: &mut TextLines) -> Result<Content, Error> {
        let Content { rows, columns, symmetric, .. } = content;
        self.make_room(&mut content, rows.saturating_mul(columns));
        let mut places =
            (0..columns).flat_map(|column| (if symmetric { column } else { 0 }..rows).map(move |row| (row, column)));
        while let Some((line, word)) = lines.next_data()? {
            let not_a_number = |_| self.fault(line, format!("{} is not a number", self.quotes.excerpt(word)));
            let value = word.parse().map_err(not_a_number)?;
            self.values.check(value).map_err(|message| self.fault(line, message))?;
            let Some((row, column)) = places.next() else {
                return Err(self.fault(line, format!("there are more values than the {rows} x {columns} announced")));
            };
            content.entries.push((row, column, value));
        }
        match places.next() {
            Some((row, column)) => {
                let message = format!("the file ends before the value of ({}, {})", row + 1, column + 1);
                Err(self.fault(lines.number(), message))
            }
            None => Ok(content),
        }
    }

    /// One entry a line: row, column, value.
    fn coordinates(&self, mut content: Content, announced: usize, lines: &mut TextLines) -> Result<Content, Error> {
        self.make_room(&mut content, announced);
        while let Some((line, words)) = lines.next_data()? {
            let entry = self.entry(&content, words).map_err(|message| self.fault(line, message))?;
            if content.entries.len() == announced {
                return Err(self.fault(line, format!("there are more entries than the {announced} announced")));
            }
            self.values.check(entry.2).map_err(|message| self.fault(line, message))?;
            content.entries.push(entry);
        }
        let found = content.entries.len();
        if found < announced {
            let message = format!("the file ends after {found} of {announced} entries");
            return Err(self.fault(lines.number(), message));
        }
        Ok(content)
    }

    /// Reserves room for the announced entries, as far as the length of the file makes their number credible: without
    /// it, a growing vector would take twice the memory for a while.
    fn make_room(&self, content: &mut Content, announced: usize) {
        let credible = (self.length / LEAST_OF_ENTRY) as usize;
        // Without reserved room, entries are taken one by one.
        let _ = content.entries.try_reserve_exact(announced.min(credible));
    }

    /// The entry of a line, indices from 0, or its error.
    fn entry(&self, content: &Content, line: &str) -> Result<(usize, usize, f64), String> {
        let Content { rows, columns, symmetric, .. } = *content;
        let mut words = line.split_whitespace();
        let mut word = || words.next();
        let entry = match (word(), word(), word(), word()) {
            (Some(row), Some(column), Some(value), None) => {
                row.parse().ok().zip(column.parse().ok()).zip(value.parse().ok())
            }
            _ => None,
        };
        let Some(((row, column), value)): Option<((usize, usize), f64)> = entry else {
            return Err(format!("{} is not an entry; it must be `row column value`", self.quotes.excerpt(line)));
        };
        if row == 0 || column == 0 || row > rows || column > columns {
            return Err(format!("entry ({row}, {column}) lies outside {rows} x {columns} (indices from 1)"));
        }
        if symmetric && row < column {
            let rule = "a symmetric file holds the lower triangle";
            return Err(format!("entry ({row}, {column}) lies above the diagonal; {rule}"));
        }
        Ok((row - 1, column - 1, value))
    }
}

impl AllowedValues {
    fn check(self, value: f64) -> Result<(), String> {
        match self {
            _ if value.is_finite() => Ok(()),
            AllowedValues::FiniteOrInfinite if value == f64::INFINITY => Ok(()),
            AllowedValues::Bounds if !value.is_nan() => Ok(()),
            AllowedValues::Bounds => {
                Err(format!("the value is {value}; it must be a number, or -inf or inf without a bound"))
            }
            AllowedValues::Finite => Err(format!("the value is {value}; it must be finite")),
            AllowedValues::FiniteOrInfinite => {
                Err(format!("the value is {value}; it must be finite, or inf for a row without obstacle"))
            }
        }
    }
}

impl Quotes {
    /// The beginning of a text from a file, in quotation marks.
    fn excerpt(self, words: &str) -> String {
        match (self, words.char_indices().nth(LONGEST_EXCERPT)) {
            (Quotes::Withheld, _) => {
                "something that is not shown (a link leads to a file outside the folder)".to_string()
            }
            (Quotes::Allowed, Some((end, _))) => format!("`{}...`", &words[..end]),
            (Quotes::Allowed, None) => format!("`{words}`"),
        }
    }
}

/// The lines of a file, one at a time.
struct TextLines {
    file: PathBuf,
    reader: BufReader<Capped>,
    number: usize,
    bytes: Vec<u8>,
    text: String,
}

impl TextLines {
    /// Before the first line.
    fn of(file: &Path, text: Capped) -> Self {
        let reader = BufReader::with_capacity(PIECE, text);
        TextLines { file: file.to_path_buf(), reader, number: 0, bytes: Vec::new(), text: String::new() }
    }

    fn number(&self) -> usize {
        self.number
    }

    /// The next line, with its number from 1 and without blanks at its ends.
    fn next(&mut self) -> Result<Option<(usize, &str)>, Error> {
        let there = self.advance().map_err(|source| Error::File { action: "read", path: self.file.clone(), source })?;
        Ok(there.then(|| (self.number, self.text.trim())))
    }

    /// The next line that is neither blank nor a comment.
    fn next_data(&mut self) -> Result<Option<(usize, &str)>, Error> {
        loop {
            match self.next()? {
                None => return Ok(None),
                Some((_, line)) if line.is_empty() || line.starts_with('%') => {}
                Some(_) => return Ok(Some((self.number, self.text.trim()))),
            }
        }
    }

    /// Reads a line; `false` at the end of the file.
    fn advance(&mut self) -> io::Result<bool> {
        self.bytes.clear();
        self.reader.by_ref().take(LONGEST as u64).read_until(b'\n', &mut self.bytes)?;
        if self.bytes.is_empty() {
            return Ok(false);
        }
        if self.bytes.len() == LONGEST && !self.bytes.ends_with(b"\n") {
            self.reader.skip_until(b'\n')?;
        }
        self.number += 1;
        // Comments of older collections hold names in other encodings; the numbers are always ASCII.
        let text = String::from_utf8_lossy(&self.bytes);
        // Some editors put a byte order mark in front.
        let mark = if self.number == 1 { "\u{feff}" } else { "" };
        self.text.clear();
        self.text.push_str(text.strip_prefix(mark).unwrap_or(&text));
        Ok(true)
    }
}
