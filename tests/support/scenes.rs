//! Builds and solves the scenes of tests.

use std::sync::Arc;

use serde_json::Value;
use signorini::scene::Answer;
use signorini::{Error, Model, Scene, solve_qp};

use crate::program::example;

/// The model of a scene, or the error of building it.
pub fn build(scene: &Value) -> Result<Model, Error> {
    Scene::from_json(&scene.to_string(), "scene").and_then(|scene| scene.build())
}

/// The model of a valid scene.
#[track_caller]
pub fn built(scene: &Value) -> Model {
    build(scene).unwrap_or_else(|error| panic!("{error}"))
}

/// The model of an example scene.
#[track_caller]
pub fn built_example(name: &str) -> Model {
    Scene::read(example(name)).and_then(|scene| scene.build()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The certified answer to a scene.
#[track_caller]
pub fn answer(scene: &Value) -> Answer {
    let model = built(scene);
    let solution = solve_qp(model.problem()).unwrap_or_else(|error| panic!("{error}"));
    Answer::of(Arc::new(model), &solution).unwrap()
}
