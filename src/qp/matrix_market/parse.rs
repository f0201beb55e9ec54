//! Reading the text of a Matrix Market file; every fault has its line.

use std::path::Path;

use crate::error::Error;

/// More rows or columns than this are refused before anything is allocated.
const LARGEST_DIMENSION: usize = 100_000_000;

/// Rows or columns may be empty, but not more of them than this: nothing is allocated from an announcement alone.
const MOST_EMPTY: usize = 1_000_000;

/// The content of a file: shape, entries (indices from 0), and whether only one triangle is stored.
#[derive(Debug)]
pub(super) struct Content {
    /// The line with the sizes.
    pub line: usize,
    pub rows: usize,
    pub columns: usize,
    pub symmetric: bool,
    pub entries: Vec<(usize, usize, f64)>,
}

/// Words of a file that an error repeats are cut to this many characters.
const LONGEST_EXCERPT: usize = 80;

/// Which values a file may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Values {
    Finite,
    /// Gaps: `inf` is a row without obstacle.
    FiniteOrInfinite,
}

/// May an error repeat what stands in a file?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quotes {
    Allowed,
    /// A link leads out of the folder, perhaps to what the reader of the error may not see.
    Withheld,
}

/// Parses `text`; `file` is named in errors.
pub(super) fn parse(file: &Path, text: &str, values: Values, quotes: Quotes) -> Result<Content, Error> {
    let excerpt = |words: &str| quotes.excerpt(words);
    // Some editors put a byte order mark in front.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let fault = |line: usize, message: String| Error::FileSyntax { file: file.to_path_buf(), line, message };
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let (_, header) = lines.next().ok_or_else(|| fault(1, "the file is empty".into()))?;
    let words: Vec<String> = header.split_whitespace().map(str::to_lowercase).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ["%%matrixmarket", "matrix", layout, field, symmetry] = words[..] else {
        let expected = "%%MatrixMarket matrix coordinate|array real|integer general|symmetric";
        return Err(fault(1, format!("the first line is {}; it must be `{expected}`", excerpt(header))));
    };
    let is_array = match layout {
        "coordinate" => false,
        "array" => true,
        other => {
            return Err(fault(1, format!("the layout is {}; it must be `coordinate` or `array`", excerpt(other))));
        }
    };
    if !["real", "integer", "double"].contains(&field) {
        return Err(fault(1, format!("the field is {}; it must be `real` or `integer`", excerpt(field))));
    }
    let symmetric = match symmetry {
        "general" => false,
        "symmetric" => true,
        other => {
            return Err(fault(1, format!("the symmetry is {}; it must be `general` or `symmetric`", excerpt(other))));
        }
    };

    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('%'));
    let (line, sizes) = lines.next().ok_or_else(|| fault(1, "the line with the sizes is missing".into()))?;
    let wanted = if is_array { 2 } else { 3 };
    let numbers: Option<Vec<usize>> = sizes.split_whitespace().map(|word| word.parse().ok()).collect();
    let numbers = numbers.filter(|numbers| numbers.len() == wanted).ok_or_else(|| {
        let names = if is_array { "rows and columns" } else { "rows, columns and entries" };
        fault(line, format!("the sizes are {}; they must be {wanted} whole numbers ({names})", excerpt(sizes)))
    })?;
    let (rows, columns) = (numbers[0], numbers[1]);
    if rows.max(columns) > LARGEST_DIMENSION {
        return Err(fault(line, format!("{rows} x {columns} is too large; at most {LARGEST_DIMENSION} each way")));
    }
    if symmetric && rows != columns {
        return Err(fault(line, format!("a symmetric matrix must be square, not {rows} x {columns}")));
    }

    let mut entries = Vec::new();
    if is_array {
        let mut places =
            (0..columns).flat_map(|column| (if symmetric { column } else { 0 }..rows).map(move |row| (row, column)));
        for (line, word) in lines {
            let value = number(word).ok_or_else(|| fault(line, format!("{} is not a number", excerpt(word))))?;
            values.check(value).map_err(|message| fault(line, message))?;
            let Some((row, column)) = places.next() else {
                return Err(fault(line, format!("there are more values than the {rows} x {columns} announced")));
            };
            entries.push((row, column, value));
        }
        if let Some((row, column)) = places.next() {
            let message = format!("the file ends before the value of ({}, {})", row + 1, column + 1);
            return Err(fault(text.lines().count(), message));
        }
    } else {
        let announced = numbers[2];
        for (line, content) in lines {
            let words: Vec<&str> = content.split_whitespace().collect();
            let entry = match words[..] {
                [row, column, value] => row.parse().ok().zip(column.parse().ok()).zip(number(value)),
                _ => None,
            };
            let Some(((row, column), value)): Option<((usize, usize), f64)> = entry else {
                return Err(fault(
                    line,
                    format!("{} is not an entry; it must be `row column value`", excerpt(content)),
                ));
            };
            if row == 0 || column == 0 || row > rows || column > columns {
                let message = format!("entry ({row}, {column}) lies outside {rows} x {columns} (indices from 1)");
                return Err(fault(line, message));
            }
            if symmetric && row < column {
                let message = format!(
                    "entry ({row}, {column}) lies above the diagonal; a symmetric file holds the lower triangle"
                );
                return Err(fault(line, message));
            }
            if entries.len() == announced {
                return Err(fault(line, format!("there are more entries than the {announced} announced")));
            }
            values.check(value).map_err(|message| fault(line, message))?;
            entries.push((row - 1, column - 1, value));
        }
        if entries.len() < announced {
            let message = format!("the file ends after {} of {announced} entries", entries.len());
            return Err(fault(text.lines().count(), message));
        }
    }
    Ok(Content { line, rows, columns, symmetric, entries })
}

impl Content {
    /// Are there, for so many `lines` of a matrix, rows or columns, entries enough to believe in them?
    pub fn believes(&self, lines: usize) -> bool {
        lines <= self.entries.len().saturating_add(MOST_EMPTY)
    }
}

impl Values {
    fn check(self, value: f64) -> Result<(), String> {
        match self {
            _ if value.is_finite() => Ok(()),
            Values::FiniteOrInfinite if value == f64::INFINITY => Ok(()),
            Values::Finite => Err(format!("the value is {value}; it must be finite")),
            Values::FiniteOrInfinite => {
                Err(format!("the value is {value}; it must be finite, or inf for a row without obstacle"))
            }
        }
    }
}

impl Quotes {
    /// The beginning of what stands in a file, in quotation marks.
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

fn number(word: &str) -> Option<f64> {
    word.parse().ok()
}
