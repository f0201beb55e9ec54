//! `signorini export`: the problem of a scene as Matrix Market files.

use super::input::{still_model, warnings};
use super::options::Export;
use super::outcome::{Outcome, warn};
use crate::error::Error;
use crate::output::{tables, write_files};
use crate::qp::matrix_market;

pub(super) fn run(options: &Export) -> Result<Outcome, Error> {
    let model = still_model(&options.scene, &options.limits)?;
    warn(&warnings(&model));
    let problem = model.problem();
    write_files(&options.directory, &matrix_market::problem_files(problem))?;
    write_files(&options.directory, &tables::of_model(&model))?;
    let near_null = matrix_market::near_null_file(problem);
    let also = if near_null.is_some() { ", near_null.mtx" } else { "" };
    write_files(&options.directory, &near_null.into_iter().collect::<Vec<_>>())?;
    let text = format!(
        "{}: K.mtx, f.mtx, B.mtx, g.mtx{also}, dofs.csv, rows.csv with {} dofs and {} contact rows\n",
        options.directory.display(),
        problem.dofs(),
        problem.rows()
    );
    Ok(Outcome::done(text))
}
