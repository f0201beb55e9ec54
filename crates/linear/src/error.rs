//! The errors of faulty data, of files and of steps of libraries: each states what is wrong, where, which value, and
//! what is allowed. And the one place that catches panics of libraries: only calls that solve and factorise are wrapped
//! in it.
//!
//! The code of this crate does not panic on any input. For a library nobody can promise that, and a panic that crosses
//! it ends the caller's program too.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

/// Faulty data, files and failed steps. Each has a [`class`](Self::class), and one sentence for a reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A vector with a length that does not fit the rest of the problem.
    #[error("{name} has length {found}, but there are {expected} {of}")]
    Length {
        /// The vector in words, as `load vector`.
        name: &'static str,
        /// Number of its entries.
        found: usize,
        /// Number of entries that it must have.
        expected: usize,
        /// The unit of the fitting length, such as `dofs`.
        of: &'static str,
    },
    /// A matrix with a shape that does not fit the rest of the problem.
    #[error("{name} is {} x {}, but it must be {} x {}", found.0, found.1, expected.0, expected.1)]
    Shape {
        /// The matrix in words, as `contact matrix`.
        name: &'static str,
        /// Rows and columns that it has.
        found: (usize, usize),
        /// Rows and columns that fit.
        expected: (usize, usize),
    },
    /// An entry outside its matrix.
    #[error("entry ({row}, {column}) lies outside a matrix of {rows} rows and {columns} columns (indices from 0)")]
    IndexOutOfRange {
        /// Row of the entry, counted from 0.
        row: usize,
        /// Column of the entry, counted from 0.
        column: usize,
        /// Number of rows that the matrix has.
        rows: usize,
        /// Number of columns that the matrix has.
        columns: usize,
    },
    /// Compressed columns that form no matrix.
    #[error("compressed columns: {message}")]
    Pattern {
        /// A sentence on what is wrong, and where.
        message: String,
    },
    /// A number that is not finite, at a place that needs a finite one.
    #[error("{name} has the value {value} at {at} (indices from 0); it must be {allowed}")]
    NotFinite {
        /// The vector or matrix in words.
        name: &'static str,
        /// Index of the entry, or row and column in parentheses, from 0.
        at: String,
        /// The number found: NaN or an infinity, or one that overflows.
        value: f64,
        /// The values allowed there.
        allowed: &'static str,
    },
    /// A stiffness given with both triangles, which differ.
    #[error(
        "the stiffness is not symmetric: entry ({row}, {column}) is {value:e}, entry ({column}, {row}) is \
         {mirrored:e} (indices from 0); give both triangles with equal entries, or only the lower one"
    )]
    NotSymmetric {
        /// Row of the entry below the diagonal, from 0.
        row: usize,
        /// Column of the entry below the diagonal, from 0.
        column: usize,
        /// Value of entry (row, column), in the unit of the matrix.
        value: f64,
        /// Value of entry (column, row), in the unit of the matrix.
        mirrored: f64,
    },
    /// A stiffness with a negative eigenvalue: the problem has no unique minimum.
    #[error("the stiffness is not positive semidefinite ({evidence}): the problem is not convex")]
    NotConvex {
        /// The evidence for it in words, such as a pivot or a direction.
        evidence: String,
    },
    /// A setting outside its range.
    #[error("{name} is {value}; it must be {allowed}")]
    Setting {
        /// The setting in words, as `threads`.
        name: &'static str,
        /// The number that was given for it.
        value: f64,
        /// The range in words, as `positive and finite`.
        allowed: &'static str,
    },
    /// A library step that failed for its own reason.
    #[error("{step} failed: {reason}")]
    Numerical {
        /// The step in words, as `sparse Cholesky factorisation`.
        step: &'static str,
        /// The cause, as the library states it.
        reason: String,
    },
    /// A matrix or mesh file that does not have the right form.
    #[error("{}:{line}: {message}", file.display())]
    FileSyntax {
        /// Path of the faulty text or mesh file, as it was given.
        file: PathBuf,
        /// Line, from 1; in a binary mesh the line at which the section begins.
        line: usize,
        /// A sentence on what is wrong, and what is allowed; in a binary mesh after the byte of the file, from 0.
        message: String,
    },
    /// A binary file, such as an STL file, that does not have the right form.
    #[error("{}, byte {byte}: {message}", file.display())]
    FileBytes {
        /// Path of the faulty binary file, as it was given.
        file: PathBuf,
        /// Offset of the fault, from 0.
        byte: usize,
        /// A sentence on what is wrong at this byte, and what is allowed.
        message: String,
    },
    /// A file or folder that cannot be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// `read`, `write` or `make the folder`.
        action: &'static str,
        /// Path of the file or folder at which the system refused.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

impl Error {
    /// Refuses a vector, named in words, that has not as many entries as there are `of`.
    pub fn check_length(name: &'static str, found: usize, expected: usize, of: &'static str) -> Result<(), Error> {
        if found == expected { Ok(()) } else { Err(Error::Length { name, found, expected, of }) }
    }

    /// The name of the kind of error, the same in every version, and the `status` of a report that ends with it.
    pub fn class(&self) -> (&'static str, &'static str) {
        let bad_input = |code| (code, "bad_input");
        match self {
            Error::Length { .. } => bad_input("length"),
            Error::Pattern { .. } => bad_input("pattern"),
            Error::Shape { .. } => bad_input("shape"),
            Error::IndexOutOfRange { .. } => bad_input("index-out-of-range"),
            Error::NotFinite { .. } => bad_input("not-finite"),
            Error::NotSymmetric { .. } => bad_input("not-symmetric"),
            Error::NotConvex { .. } => ("not-convex", "not_convex"),
            Error::Setting { .. } => bad_input("setting"),
            Error::Numerical { .. } => ("numerical", "failed"),
            Error::FileSyntax { .. } | Error::FileBytes { .. } => bad_input("file-syntax"),
            Error::File { .. } => bad_input("file"),
        }
    }
}

/// Runs `work`, a call of a library that changes nothing which outlives it; a panic is returned as its message.
#[expect(clippy::disallowed_methods, reason = "the one place")]
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // Data that `work` has left half done are dropped with it.
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let literal = panic.downcast_ref::<&str>().copied();
        let message = literal.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        format!("it panicked: {}", message.unwrap_or("without a message"))
    })
}

#[cfg(test)]
mod tests {
    use super::guarded;

    #[test]
    fn a_panic_of_a_library_is_an_error_with_its_message() {
        assert_eq!(guarded(|| 1), Ok(1));
        let formatted: Result<(), String> = guarded(|| panic!("{} of {}", 1, 2));
        assert_eq!(formatted, Err("it panicked: 1 of 2".into()));
        let odd: Result<(), String> = guarded(|| std::panic::panic_any(7));
        assert_eq!(odd, Err("it panicked: without a message".into()));
        let beyond: Result<usize, String> = guarded(|| [1, 2, 3].get(7).copied().unwrap());
        assert!(beyond.unwrap_err().contains("None"));
    }
}
