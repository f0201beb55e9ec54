//! Derivatives of outputs of an answer with respect to parameters of its scene, with the verdict of the proven rows.

mod effect;
pub(crate) mod output;
pub(crate) mod parameter;
mod places;
pub(crate) mod sensitivity;
