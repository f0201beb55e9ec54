//! A scene or a problem directory: the common interface for the commands.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::options::Limits;
use super::outcome::unfit;
use crate::Error;
use crate::lcp::Lcp;
use crate::qp::{self, ContactProblem, Goal, Solution, read_problem};
use crate::scene::{Answer, Model, Scene, Units};
use crate::study::Summary;

/// The file name that means standard input.
const STANDARD_INPUT: &str = "-";

/// The input to be solved.
pub(super) struct Input {
    pub title: String,
    pub units: Units,
    pub assemble_seconds: f64,
    pub content: Content,
}

pub(super) enum Content {
    Scene(Arc<Model>),
    Directory(Box<ContactProblem>),
}

/// The input as read, before anything is built; a pipe is read only once.
pub(super) enum Source {
    /// A scene, with the time of reading it in seconds.
    Scene(Box<Scene>, f64),
    Directory(Box<Input>),
}

impl Source {
    /// Reads a problem directory, if `path` is one, or else a scene, of any size.
    pub fn read(path: &Path, limits: &Limits) -> Result<Self, Error> {
        let clock = Instant::now();
        if !path.is_dir() {
            let scene = Box::new(scene_of(path, limits)?);
            return Ok(Source::Scene(scene, clock.elapsed().as_secs_f64()));
        }
        check_contact(path)?;
        let content = Content::Directory(Box::new(read_problem(path)?));
        let (title, units) = (format!("Problem directory {}", path.display()), Units::unnamed());
        let assemble_seconds = clock.elapsed().as_secs_f64();
        Ok(Source::Directory(Box::new(Input { title, units, assemble_seconds, content })))
    }
}

/// Refuses the directory of a complementarity problem.
pub(super) fn check_contact(path: &Path) -> Result<(), Error> {
    if !Lcp::is_directory(path)? {
        return Ok(());
    }
    let message = "it is a complementarity problem (q.mtx), which only `solve`, `compare` and `verify` take";
    Err(qp::LinearError::File {
        action: "read",
        path: path.into(),
        source: io::Error::new(io::ErrorKind::InvalidInput, message),
    }
    .into())
}

impl Input {
    /// Reads a problem directory, if `path` is one, or else a scene that fits into these `limits`.
    pub fn read(path: &Path, limits: &Limits) -> Result<Self, Error> {
        match Source::read(path, limits)? {
            Source::Scene(scene, read_seconds) => {
                scene.check_size(limits.most_memory())?;
                rests(&scene)?;
                Input::of_scene(&scene, path, limits, read_seconds)
            }
            Source::Directory(input) => Ok(*input),
        }
    }

    /// The model of a static scene that was read in `read_seconds`.
    pub fn of_scene(scene: &Scene, path: &Path, limits: &Limits, read_seconds: f64) -> Result<Self, Error> {
        let clock = Instant::now();
        let model = build(scene, path, limits)?;
        let assemble_seconds = read_seconds + clock.elapsed().as_secs_f64();
        let (title, units) = (scene_title(&model, path), model.units().clone());
        Ok(Input { title, units, assemble_seconds, content: Content::Scene(Arc::new(model)) })
    }

    pub fn problem(&self) -> &ContactProblem {
        match &self.content {
            Content::Scene(model) => model.problem(),
            Content::Directory(problem) => problem,
        }
    }

    /// An answer of any size, joined with its scene; `None` for a problem directory.
    pub fn answer(&self, solution: &Solution) -> Result<Option<Answer>, Error> {
        match &self.content {
            Content::Scene(model) => Answer::of_any_size(model.clone(), solution).map(Some),
            Content::Directory(_) => Ok(None),
        }
    }

    /// The numbers of a solution; for a scene with those that only its answer gives.
    pub fn summary(
        &self,
        solution: Solution,
        answer: Option<&Answer>,
        goal: impl Into<Goal>,
    ) -> Result<Summary, Error> {
        match answer {
            Some(answer) => Summary::of_answer(answer, solution, goal, self.assemble_seconds),
            None => Ok(Summary::of_problem(self.problem(), solution, goal, self.assemble_seconds)),
        }
    }

    /// An error in the words of the scene.
    pub fn explain(&self, error: impl Into<Error>) -> Error {
        match &self.content {
            Content::Scene(model) => model.explain(error),
            Content::Directory(_) => error.into(),
        }
    }

    /// The warnings of the scene, or of the problem of a directory, one line each.
    pub fn warnings(&self) -> String {
        match &self.content {
            Content::Scene(model) => warnings(model),
            Content::Directory(problem) => {
                problem.warnings().iter().map(|(_, warning)| format!("warning: {warning}\n")).collect()
            }
        }
    }
}

/// The model of a scene at rest.
pub(super) fn still_model(path: &Path, limits: &Limits) -> Result<Model, Error> {
    let scene = read_scene(path, limits)?;
    rests(&scene)?;
    build(&scene, path, limits)
}

/// Refuses a scene that asks for its motion or its modes.
pub(super) fn rests(scene: &Scene) -> Result<(), Error> {
    if scene.analysis.is_none() {
        return Ok(());
    }
    let message = match scene.modes() {
        Some(_) => {
            "the scene asks for its modes, which only the command `solve` computes; remove `analysis` for its equilibrium"
        }
        None => {
            "the scene is a motion, which only the commands `solve` and `tradeoff` compute; remove `analysis` for its equilibrium"
        }
    };
    unfit("analysis", message)
}

/// Reads a scene of any size.
pub(super) fn scene_of(path: &Path, limits: &Limits) -> Result<Scene, Error> {
    if let Some(option) = limits.deck.of_decks_only().filter(|_| !Scene::is_deck(path)) {
        return unfit(option, "this option is for decks of CalculiX, whose names end with .inp");
    }
    // A scene from a pipe has the working folder of the program as its folder.
    let scene = match path == Path::new(STANDARD_INPUT) {
        false if Scene::is_deck(path) => Scene::read_deck(path, &limits.deck.permits(), limits.deck.step)?,
        true => Scene { folder: Some(PathBuf::new()), ..Scene::read("/dev/stdin")? },
        false => Scene::read(path)?,
    };
    Ok(Scene { reads_outside: limits.deck.allow_outside, is_linear: limits.deck.linear, ..scene })
}

/// Reads a scene and makes sure that it fits into these `limits`.
pub(super) fn read_scene(path: &Path, limits: &Limits) -> Result<Scene, Error> {
    let scene = scene_of(path, limits)?;
    scene.check_size(limits.most_memory())?;
    Ok(scene)
}

/// Builds the scene of a file; an error names the line and column of the wrong value.
pub(super) fn build(scene: &Scene, path: &Path, limits: &Limits) -> Result<Model, Error> {
    scene.build_within(limits.most_memory()).map_err(|error| Scene::located(error, path))
}

pub(super) fn scene_title(model: &Model, path: &Path) -> String {
    if model.title().is_empty() { path.display().to_string() } else { model.title().to_string() }
}

/// The warnings of a scene, one line each.
pub(super) fn warnings(model: &Model) -> String {
    model.warnings().iter().map(|warning| format!("warning: {warning}\n")).collect()
}

/// Adds the estimated error of the mesh and the strain energy.
pub(super) fn add_error_and_energy(summary: &mut Summary, answer: &Answer) -> Result<(), Error> {
    let (of_mesh, energy) = answer.error_and_energy()?;
    summary.discretisation_error = Some(of_mesh);
    summary.strain_energy = Some(answer.model().parts_of_whole() * energy);
    Ok(())
}
