//! Assembly in the free dofs: stiffness, loads, internal forces.
//!
//! Nodal vectors have length `2 * n_nodes` and the order `[x_0, y_0, x_1, y_1, ...]`; vectors of the problem have one
//! entry per free dof, in the same order with the supported dofs left out.

mod dofs;
mod load;
mod stiffness;

pub use dofs::DofMap;
pub use load::{add_body_force, add_traction, tributary_areas};
pub use stiffness::{internal_force, stiffness};
