//! Assembly in the free dofs: stiffness, mass, loads, internal forces.
//!
//! Nodal vectors have length `dim * n_nodes` and the order `[x_0, y_0, x_1, y_1, ...]` (in space
//! `[x_0, y_0, z_0, ...]`, in a bar `[x_0, x_1, ...]`); vectors of the problem have one entry per free dof, in the same
//! order with the supported dofs left out. At a node with a [`Frame`], which an inclined support makes, the dofs of the
//! problem run along the axes of the frame.

mod congruent;
mod dofs;
mod element_blocks;
mod element_stiffness;
mod facet_derivative;
mod frame;
mod general_stiffness;
mod internal_force;
mod load;
mod mass;
mod nodal_columns;
mod own_energy;
mod pattern;
mod positive_basis;
mod redistribution;
mod rigid_body_modes;
mod shape_derivative;
mod springs;
mod stiffness;
mod surface;

pub(crate) use dofs::Along;
pub use dofs::DofMap;
pub use element_stiffness::element_stiffness;
pub(crate) use facet_derivative::{Density, Points, area_and_integral, integral_by_places};
pub use frame::Frame;
pub(crate) use frame::perpendicular;
pub use internal_force::internal_force;
pub(crate) use internal_force::{add_to_nodes, of_cell};
pub(crate) use load::{Kinks, add_centrifugal, add_gravity, add_moment, add_traction_with_kinks, turning_traction};
pub use load::{add_body_force, add_body_force_field, add_pressure, add_traction, add_traction_field, free_load};
pub use mass::{MassForm, mass};
pub(crate) use mass::{free_mass, least_over_lumped, nodal_mass};
pub(crate) use nodal_columns::{mass_columns, stiffness_columns};
pub(crate) use own_energy::{own_energy, own_energy_change};
pub(crate) use positive_basis::PositiveBasis;
pub use rigid_body_modes::rigid_body_modes;
pub(crate) use shape_derivative::{
    body_force_by_places, centrifugal_by_places, gravity_by_places, internal_work_by_places, interpolated,
    own_energy_by_places,
};
pub(crate) use springs::{NodalForces, Springs};
pub use stiffness::stiffness;
pub(crate) use surface::{FacetPoint, facet_centres, facet_sizes, normal_sums, outward};
pub use surface::{node_normals, tributary_areas};
