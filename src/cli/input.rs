//! A scene or a problem directory: what is the same of both for the commands.

use std::path::Path;
use std::time::Instant;

use super::options::Memory;
use crate::error::Error;
use crate::matrix_market;
use crate::output::UnitNames;
use crate::problem::ContactProblem;
use crate::scene::{Model, Scene};
use crate::solution::{Goal, Solution};
use crate::study::{ModelSize, Summary, scene_summary};

/// What there is to solve.
pub(super) struct Input {
    pub title: String,
    pub units: UnitNames,
    pub assemble_seconds: f64,
    pub content: Content,
}

pub(super) enum Content {
    Scene(Box<Model>),
    Directory(ContactProblem),
}

impl Input {
    /// Reads a problem directory, if `path` is one, or else a scene that fits into so much `memory`.
    pub fn read(path: &Path, memory: &Memory) -> Result<Self, Error> {
        let clock = Instant::now();
        let (title, units, content) = if path.is_dir() {
            let title = format!("Problem directory {}", path.display());
            (title, UnitNames::default(), Content::Directory(matrix_market::read_problem(path)?))
        } else {
            let model = still_model(path, memory)?;
            (scene_title(&model, path), unit_names(&model), Content::Scene(Box::new(model)))
        };
        Ok(Input { title, units, assemble_seconds: clock.elapsed().as_secs_f64(), content })
    }

    pub fn problem(&self) -> &ContactProblem {
        match &self.content {
            Content::Scene(model) => model.problem(),
            Content::Directory(problem) => problem,
        }
    }

    /// The numbers of an answer, with what only a scene can tell.
    pub fn summary(&self, solution: &Solution, goal: impl Into<Goal>) -> Result<Summary, Error> {
        match &self.content {
            Content::Scene(model) => scene_summary(model, solution, goal, self.assemble_seconds),
            Content::Directory(problem) => {
                Ok(Summary::new(solution, ModelSize::of(problem), goal, self.assemble_seconds))
            }
        }
    }

    /// An error in the words of the scene.
    pub fn explain(&self, error: Error) -> Error {
        match &self.content {
            Content::Scene(model) => model.explain(error),
            Content::Directory(_) => error,
        }
    }

    /// The warnings of the scene, one line each; none of a problem directory.
    pub fn warnings(&self) -> String {
        match &self.content {
            Content::Scene(model) => warnings(model),
            Content::Directory(_) => String::new(),
        }
    }
}

/// The scene at `path`, if its motion is asked for.
pub(super) fn moving_scene(path: &Path, memory: &Memory) -> Result<Option<Scene>, Error> {
    if path.is_dir() {
        return Ok(None);
    }
    Ok(Some(read_scene(path, memory)?).filter(|scene| scene.analysis.is_some()))
}

/// The model of a scene at rest.
pub(super) fn still_model(path: &Path, memory: &Memory) -> Result<Model, Error> {
    let scene = read_scene(path, memory)?;
    if scene.analysis.is_some() {
        let message =
            "the scene moves; only `solve` and `tradeoff` can do with that: leave the analysis out for its rest";
        return Err(Error::Scene { path: "analysis".into(), message: message.into() });
    }
    build(&scene, path)
}

/// Reads a scene and makes sure that it fits into so much `memory`.
pub(super) fn read_scene(path: &Path, memory: &Memory) -> Result<Scene, Error> {
    let scene = Scene::read(path)?;
    scene.check_size(memory.most())?;
    Ok(scene)
}

/// Builds the scene of a file; a value at fault is named with its line and column.
pub(super) fn build(scene: &Scene, path: &Path) -> Result<Model, Error> {
    scene.build().map_err(|error| Scene::located(error, path))
}

/// The title of a scene, or its file where it has none.
pub(super) fn scene_title(model: &Model, path: &Path) -> String {
    if model.title().is_empty() { path.display().to_string() } else { model.title().to_string() }
}

/// The warnings of a scene, one line each.
pub(super) fn warnings(model: &Model) -> String {
    model.warnings().iter().map(|warning| format!("warning: {warning}\n")).collect()
}

pub(super) fn unit_names(model: &Model) -> UnitNames {
    let units = model.units();
    UnitNames { length: units.length.clone(), force: units.force.clone(), stress: units.pressure() }
}
