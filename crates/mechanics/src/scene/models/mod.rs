//! A discretised scene: mesh and materials, supports, loads and springs, contact rows, and the problem that they make.

pub(crate) mod build;
pub(crate) mod continuum;
pub(crate) mod elastic;
mod facing;
pub(crate) mod held;
pub(crate) mod load;
mod materials;
pub(crate) mod model;
pub(crate) mod overlap;
mod part;
pub(crate) mod parts;
pub(crate) mod points;
mod preload;
pub(crate) mod resultants;
pub(crate) mod rigid_body_modes;
mod rigid_face;
pub(crate) mod rows;
pub(crate) mod set_up;
mod springs;
pub(crate) mod start;
mod suspect;
mod symmetry;
mod ties;
pub(crate) mod unknowns;
