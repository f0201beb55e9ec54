//! Answers to a scene: stresses, forces, and the contact in pieces.

pub(crate) mod answer;
pub(crate) mod beside_nodes;
pub(crate) mod deformation;
pub(crate) mod patch;
pub(crate) mod segments;
