//! `signorini export`: the problem of a scene as files of Matrix Market or PETSc.

use std::borrow::Cow;
use std::path::Path;

use super::input::{Content, Input, build, scene_of, warnings};
use super::options::{Export, Form};
use super::outcome::{Outcome, unfit, warn};
use crate::Error;
use crate::fem::MassForm;
use crate::output::{tables_of_model, write_streamed};
use crate::qp::file::Streamed;
use crate::qp::{ContactProblem, PetscLayout, Prepared, Settings, SparseMatrix, SymmetricMatrix, format_vector};
use crate::scene::{Dynamics, Meaning, Model, Scene};

/// Bytes of a megabyte.
const MEGABYTE: f64 = 1e6;

pub(super) fn run(options: &Export) -> Result<Outcome, Error> {
    if options.format == Form::Lcp {
        return complementarity(options);
    }
    let scene = scene_of(&options.scene, &options.limits)?;
    scene.check_size_of_model(options.limits.most_memory())?;
    let model = build(&scene, &options.scene, &options.limits)?;
    warn(&warnings(&model));
    let Inertia { statics: problem, mass, damping } = Inertia::of(&scene, &model)?;
    let layout;
    let mut files = match options.format {
        Form::MatrixMarket | Form::Lcp => problem.files(),
        Form::Petsc if mass.is_some() => {
            let message = "the form petsc has no mass; take --format matrix-market, or leave `analysis` out";
            return unfit("--format", message);
        }
        Form::Petsc => {
            layout = layout_of(&model)?;
            problem.petsc_files(&layout)
        }
    };
    files.extend(mass.iter().map(|mass| mass.file("M.mtx")));
    files.extend(damping.iter().map(|damping| damping.file("C.mtx")));
    files.extend(tables_of_model(&model));
    let names = write(&options.directory, &files)?;
    let mut text = format!("{names} with {} dofs and {} contact rows", problem.dofs(), problem.inequalities());
    match problem.equality_rows() {
        0 => {}
        1 => text += ", 1 equality row",
        count => text += &format!(", {count} equality rows"),
    }
    text += "\n";
    Ok(Outcome::done(text))
}

/// Writes the files into the folder, and names both.
fn write(folder: &Path, files: &[Streamed]) -> Result<String, Error> {
    let bytes: u64 = files.iter().map(Streamed::bytes).sum();
    warn(&format!("writing {bytes} bytes ({:.1} MB) into {}\n", bytes as f64 / MEGABYTE, folder.display()));
    write_streamed(folder, files)?;
    let names: Vec<&str> = files.iter().map(|file| file.name).collect();
    Ok(format!("{}: {}", folder.display(), names.join(", ")))
}

/// Exports the complementarity problem of the forces of a scene at rest, or of a problem directory.
fn complementarity(options: &Export) -> Result<Outcome, Error> {
    let input = Input::read(&options.scene, &options.limits)?;
    warn(&input.warnings());
    let mut settings = Settings::default();
    settings.memory = Some(options.limits.most_memory());
    let lcp = Prepared::for_gaps(input.problem(), 1, &settings).and_then(|prepared| prepared.delassus());
    let lcp = lcp.map_err(|error| input.explain(error))?;
    let numbers: Vec<f64> = lcp.rows.iter().map(|&row| row as f64).collect();
    let mut vectors = vec![("q.mtx", &lcp.offset), ("rows.mtx", &numbers)];
    let of_motion =
        |(column, r): (usize, &Vec<f64>)| r.iter().enumerate().map(move |(dof, &r)| (dof, column, r)).collect();
    let motions: Vec<Vec<_>> = lcp.motions.iter().enumerate().map(of_motion).collect();
    let motions = SparseMatrix::from_triplets(input.problem().dofs(), motions.len(), &motions.concat())?;
    let mut files = vec![lcp.matrix.file("M.mtx")];
    if motions.columns() > 0 {
        vectors.extend([("lower.mtx", &lcp.lower), ("upper.mtx", &lcp.upper)]);
        files.push(motions.file("R.mtx"));
    }
    for (name, values) in vectors {
        files.push(Streamed::new(name, |out| out.write_all(format_vector(values).as_bytes())));
    }
    if let Content::Scene(model) = &input.content {
        files.extend(tables_of_model(model));
    }
    let names = write(&options.directory, &files)?;
    let mut text = format!("{names} with {} unknowns z = -lambda of the rows in rows.mtx, from 0", lcp.rows.len());
    if motions.columns() > 0 {
        text += &format!(", and {} unknowns a without bounds: u = K+ (f - B'z) + R a", motions.columns());
    }
    Ok(Outcome::done(text + "\n"))
}

/// A problem with the mass of its analysis, and the damping of a motion.
struct Inertia<'a> {
    statics: Cow<'a, ContactProblem>,
    mass: Option<SymmetricMatrix>,
    damping: Option<SymmetricMatrix>,
}

impl<'a> Inertia<'a> {
    fn of(scene: &Scene, model: &'a Model) -> Result<Self, Error> {
        let still = Inertia { statics: Cow::Borrowed(model.problem()), mass: None, damping: None };
        if scene.modes().is_some() {
            return Ok(Inertia { mass: Some(model.mass(MassForm::Consistent)?), ..still });
        }
        let Some(Dynamics { problem, .. }) = scene.dynamics(model)? else { return Ok(still) };
        let [of_mass, of_stiffness] = problem.damping();
        let damping = problem.statics().stiffness().combined(of_stiffness, of_mass, problem.mass())?;
        let (statics, mass) = (Cow::Owned(problem.statics().clone()), Some(problem.mass().clone()));
        Ok(Inertia { statics, mass, damping: Some(damping) })
    }
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
