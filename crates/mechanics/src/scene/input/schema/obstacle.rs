//! Obstacles as they are written in a scene.

use super::model::{Approach, Rule};
use crate::scene::input::obstacle::ShapeSpec;

specs! {
/// How the contacts between bodies are given.
#[derive(Copy, Eq)]
pub enum ContactSpec {
    /// All surfaces of different bodies that face each other within reach are found; those that an obstacle names stay
    /// as they are.
    Auto,
}

/// A frictionless obstacle and the boundary that may touch it.
pub struct ObstacleSpec {
    /// The boundary that contains the candidate nodes.
    pub boundary: String,
    /// The direction from the body to the obstacle. Another body with the rule `closest-point` needs none.
    pub approach: Option<Approach>,
    /// The rule for the contact row of a node.
    #[serde(default)]
    pub rule: Rule,
    /// Shift of this obstacle along its approach direction, in addition to that of the whole scene; a negative shift
    /// moves it towards the body.
    pub gap: Option<f64>,
    /// The force, positive, that presses the obstacle against its approach direction; the obstacle moves only along
    /// this direction. In force; for a body of revolution that of the full circle. The travel of the obstacle is
    /// computed.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub force: Option<f64>,
    /// The mass of an obstacle that moves along its approach direction in a motion, positive, as a hammer does; for a
    /// body of revolution that of the full circle. It starts at its `gap`, with its `speed`, under its `force`, if it
    /// has one.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass: Option<f64>,
    /// The velocity towards the body with which an obstacle with `mass` starts, in length over time; 0 if left out.
    pub speed: Option<f64>,
    /// The surface of the obstacle.
    pub shape: ShapeSpec,
}
}
