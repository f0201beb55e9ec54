//! Problem directories, whichever files they are made of.

use std::io;
use std::path::Path;

use super::{matrix_market, petsc};
use crate::error::Error;
use crate::qp::problem::ContactProblem;

/// Reads the problem of a directory: Matrix Market files, with `K.mtx`, or PETSc's, with `K.petsc`. One with both is refused: they
/// may be of two problems.
///
/// # Errors
/// [`Error::File`] for a file that is missing and for a directory with both; [`Error::FileSyntax`] and [`Error::FileBytes`] for one
/// that is malformed; those of [`ContactProblem::new`].
pub fn read_problem(directory: &Path) -> Result<ContactProblem, Error> {
    let [of_text, of_petsc] = [matrix_market::STIFFNESS, petsc::STIFFNESS].map(|name| directory.join(name).exists());
    match (of_text, of_petsc) {
        (true, true) => {
            let both = format!("{} and {} both stand there", matrix_market::STIFFNESS, petsc::STIFFNESS);
            let source =
                io::Error::new(io::ErrorKind::InvalidInput, format!("{both}; take the files of one form away"));
            Err(Error::File { action: "read", path: directory.to_path_buf(), source })
        }
        (false, true) => petsc::read_problem(directory),
        _ => matrix_market::read_problem(directory),
    }
}
