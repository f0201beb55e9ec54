//! Answers to a scene: stresses, forces, and the contact in pieces.

pub mod answer;
pub mod beside_nodes;
pub mod deformation;
pub mod patch;
pub mod segments;
