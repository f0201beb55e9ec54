//! Directories of complementarity problems: `M.mtx`, `q.mtx`, and for bounds other than 0 and infinity `lower.mtx` and
//! `upper.mtx`; an answer adds `z.mtx` and `w.mtx`.

use std::io;
use std::path::Path;

use signorini_qp::{ContactProblem, LinearError, SparseMatrix, format_vector, read_vector};

use crate::answer::LcpSolution;
use crate::error::Error;
use crate::problem::Lcp;

/// The file that makes a directory one of a complementarity problem.
const OFFSET: &str = "q.mtx";

impl Lcp {
    /// Returns `true` if the directory is that of a complementarity problem: it has `q.mtx`.
    ///
    /// # Errors
    /// `File` for a directory that has the stiffness of a contact problem as well.
    pub fn is_directory(directory: &Path) -> Result<bool, LinearError> {
        let is_one = directory.join(OFFSET).exists();
        if is_one && ContactProblem::is_directory(directory) {
            let both = "the folder has both q.mtx, of a complementarity problem, and the stiffness K of a contact problem; \
                        remove the files of one of them";
            let source = io::Error::new(io::ErrorKind::InvalidInput, both);
            return Err(LinearError::File { action: "read", path: directory.to_path_buf(), source });
        }
        Ok(is_one)
    }

    /// Reads the problem of a directory: `M.mtx` (n x n), `q.mtx`, and `lower.mtx` and `upper.mtx`, of length n;
    /// without these files the bounds are 0 and infinity.
    ///
    /// # Errors
    /// [`Error::Qp`] with `File`, `FileSyntax` or `FileBytes` for a file that is missing or malformed, and those of
    /// [`Lcp::is_directory`] and [`Lcp::new`].
    pub fn read(directory: &Path) -> Result<Self, Error> {
        Self::is_directory(directory)?;
        let [matrix, offset, lower, upper] =
            ["M.mtx", OFFSET, "lower.mtx", "upper.mtx"].map(|name| directory.join(name));
        let offset = read_vector(&offset)?;
        let bounds = |file: &Path, without: f64| match file.exists() {
            true => SparseMatrix::read_bounds(file),
            false => Ok(vec![without; offset.len()]),
        };
        let (lower, upper) = (bounds(&lower, 0.0)?, bounds(&upper, f64::INFINITY)?);
        Lcp::new(SparseMatrix::read(&matrix)?, offset, lower, upper)
    }
}

impl LcpSolution {
    /// The files of an answer: name and text, `z.mtx` and `w.mtx`.
    pub fn files(&self) -> [(&'static str, String); 2] {
        [("z.mtx", format_vector(&self.z)), ("w.mtx", format_vector(&self.w))]
    }
}
