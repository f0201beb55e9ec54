//! Builds and solves the scenes of tests.
#![allow(dead_code)]

use std::sync::Arc;

use serde_json::Value;
use signorini::scene::Answer;
use signorini::{Error, Model, Scene, solve_qp};

/// The model of a scene, or the error of building it.
pub fn built(scene: &Value) -> Result<Model, Error> {
    Scene::from_json(&scene.to_string(), "scene").and_then(|scene| scene.build())
}

/// The certified answer to a scene.
pub fn answer(scene: &Value) -> Answer {
    let model = built(scene).unwrap_or_else(|error| panic!("{error}"));
    let solution = solve_qp(model.problem()).unwrap_or_else(|error| panic!("{error}"));
    Answer::of(Arc::new(model), &solution).unwrap()
}
