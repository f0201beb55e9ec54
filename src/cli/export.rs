//! `signorini export`: the problem of a scene as files of Matrix Market or PETSc.

use super::input::{build, rests, scene_of, warnings};
use super::options::{Export, Form};
use super::outcome::{Outcome, unfit, warn};
use crate::Error;
use crate::output::{tables_of_model, write_streamed};
use crate::qp::PetscLayout;
use crate::qp::file::Streamed;
use crate::scene::{Meaning, Model};

/// Bytes of a megabyte.
const MEGABYTE: f64 = 1e6;

pub(super) fn run(options: &Export) -> Result<Outcome, Error> {
    let scene = scene_of(&options.scene, &options.limits)?;
    scene.check_size_of_model(options.limits.most_memory())?;
    rests(&scene)?;
    let model = build(&scene, &options.scene, &options.limits)?;
    warn(&warnings(&model));
    let layout;
    let files = match options.format {
        Form::MatrixMarket => model.problem().files(),
        Form::Petsc => {
            layout = layout_of(&model)?;
            model.problem().petsc_files(&layout)
        }
    };
    let files: Vec<Streamed> = files.into_iter().chain(tables_of_model(&model)).collect();
    let (folder, problem) = (&options.directory, model.problem());
    let bytes: u64 = files.iter().map(Streamed::bytes).sum();
    warn(&format!("writing {bytes} bytes ({:.1} MB) into {}\n", bytes as f64 / MEGABYTE, folder.display()));
    write_streamed(folder, &files)?;
    let names: Vec<&str> = files.iter().map(|file| file.name).collect();
    let text = format!(
        "{}: {} with {} dofs and {} contact rows\n",
        folder.display(),
        names.join(", "),
        problem.dofs(),
        problem.rows()
    );
    Ok(Outcome::done(text))
}

/// The places of the dofs of a model in PETSc's files.
fn layout_of(model: &Model) -> Result<PetscLayout, Error> {
    if model.meanings().any(|meaning| !matches!(meaning, Meaning::Node { .. })) {
        let message = "the form petsc has only the unknowns of nodes, but rigid faces and obstacles that a force \
                       presses have further unknowns; take --format matrix-market";
        return unfit("--format", message);
    }
    Ok(PetscLayout::of(model.body().dimension(), model.dofs().free(), model.mesh().nodes()))
}
