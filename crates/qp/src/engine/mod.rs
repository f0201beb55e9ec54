//! Engines: a problem prepared once, for many gaps, loads and starts. One engine has a factor of the stiffness, the
//! other a multigrid hierarchy. An engine makes the steps that a ladder asks for, and judges nothing.

mod boundary;
mod factored;
mod interface;
mod loading;
mod multigrid;
mod preparation;
mod reduction;
mod refinement;
mod step;

pub(super) use factored::Factored;
pub(super) use interface::{Body, Engine, Found, OnBoundary, Task, Walk};
pub(super) use loading::Load;
pub(super) use multigrid::Hierarchical;
