//! Problem directories with files of Matrix Market or PETSc.

use std::io;
use std::path::Path;

use super::{matrix_market, petsc};
use crate::error::Error;
use crate::problem::ContactProblem;

/// The reason against a folder without a stiffness.
const NO_PROBLEM: &str = "the folder has neither K.mtx nor K.petsc; a problem directory needs K.mtx (stiffness), f.mtx (load), \
                          B.mtx (contact rows) and g.mtx (gaps), or the same four as .petsc; a complementarity problem needs M.mtx and q.mtx; a \
                          scene is a .json file: give its name";

/// Reads the problem of a directory: Matrix Market files, with `K.mtx`, or PETSc's, with `K.petsc`. A directory with
/// both is refused: they may belong to two problems.
///
/// # Errors
/// [`Error::File`] for a file that is missing and for a directory with both; [`Error::FileSyntax`] and
/// [`Error::FileBytes`] for one that is malformed; those of [`ContactProblem::new`].
pub fn read_problem(directory: &Path) -> Result<ContactProblem, Error> {
    match forms(directory) {
        [true, true] => {
            let both = format!("the folder has both {} and {}", matrix_market::STIFFNESS, petsc::STIFFNESS);
            let source = io::Error::new(io::ErrorKind::InvalidInput, format!("{both}; remove the files of one form"));
            Err(Error::File { action: "read", path: directory.to_path_buf(), source })
        }
        [false, true] => petsc::read_problem(directory),
        [false, false] if directory.is_dir() => {
            let source = io::Error::new(io::ErrorKind::NotFound, NO_PROBLEM);
            Err(Error::File { action: "read", path: directory.to_path_buf(), source })
        }
        _ => matrix_market::read_problem(directory),
    }
}

/// Returns `true` if the directory has a stiffness in either format.
pub(crate) fn is_problem_directory(directory: &Path) -> bool {
    forms(directory).contains(&true)
}

/// Flags: `true` if there is a stiffness in Matrix Market format, and in PETSc's.
fn forms(directory: &Path) -> [bool; 2] {
    [matrix_market::STIFFNESS, petsc::STIFFNESS].map(|name| directory.join(name).exists())
}
