//! `signorini export`: the problem of a scene as Matrix Market files.

use super::input::{build, read_scene, warnings};
use super::options::Export;
use super::{Outcome, warn};
use crate::error::Error;
use crate::matrix_market;
use crate::output::write_files;

pub(super) fn run(options: &Export) -> Result<Outcome, Error> {
    let model = build(&read_scene(&options.scene, &options.memory)?, &options.scene)?;
    warn(&warnings(&model));
    let problem = model.problem();
    write_files(&options.directory, &matrix_market::problem_files(problem))?;
    let text = format!(
        "{}: K.mtx, f.mtx, B.mtx, g.mtx with {} dofs and {} contact rows\n",
        options.directory.display(),
        problem.dofs(),
        problem.rows()
    );
    Ok(Outcome::certified(text))
}
