//! Derivatives of outputs of an answer with respect to parameters of its scene, with the verdict of the proven rows.

mod differences;
mod effect;
pub(crate) mod output;
pub(crate) mod parameter;
pub(crate) mod sensitivity;
