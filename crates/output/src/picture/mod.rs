//! Pictures of a body: fields, the displaced mesh under its obstacles, a scene before it is solved.

pub(crate) mod arrows;
pub(crate) mod body;
mod contour;
mod inset;
pub(crate) mod mark;
pub(crate) mod mesh_series;
pub(crate) mod obstacle;
mod panels;
mod plan;
pub(crate) mod plane_scene;
pub(crate) mod set_up;
mod space;
pub(crate) mod space_scene;
