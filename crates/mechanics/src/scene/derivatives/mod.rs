//! Derivatives of results: what an answer changes by with the data of its scene.

pub(crate) mod places;
