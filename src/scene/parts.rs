//! What a model consists of before its contact rows.

use super::held::Held;
use super::obstacle::PlacedObstacle;
use super::unknowns::Unknowns;
use super::{Units, Warning};
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;

/// What a change of the gap leaves alone.
#[derive(Debug)]
pub(super) struct Parts {
    pub title: String,
    pub units: Units,
    pub body: ElasticBody,
    pub dofs: DofMap,
    /// What holds the nodes.
    pub held: Held,
    /// Number of supports in the scene.
    pub supports: usize,
    /// `true` if a support may stand for the other half of a symmetric body.
    pub is_part: bool,
    /// External load at all nodes, length `dim * n_nodes`.
    pub load: Vec<f64>,
    pub obstacles: Vec<PlacedObstacle>,
    pub unknowns: Unknowns,
    pub warnings: Vec<Warning>,
    /// `true` if the analysis is dynamic: inertia then resists motions that no support holds.
    pub moves: bool,
}
