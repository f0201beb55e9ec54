//! Answers to a scene: stresses, forces, and the contact in pieces.

pub(crate) mod answer;
pub(crate) mod deformation;
pub(crate) mod depths;
pub(crate) mod of_deck;
pub(crate) mod patch;
pub(crate) mod segments;
