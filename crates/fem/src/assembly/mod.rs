//! Assembly in the free dofs: stiffness, mass, loads, internal forces.
//!
//! Nodal vectors have length `dim * n_nodes` and the order `[x_0, y_0, x_1, y_1, ...]` (in space
//! `[x_0, y_0, z_0, ...]`, in a bar `[x_0, x_1, ...]`); vectors of the problem have one entry per free dof, in the same
//! order with the supported dofs left out. At a node with a [`Frame`], which an inclined support makes, the dofs of the
//! problem run along the axes of the frame.

mod dofs;
mod element_stiffness;
mod load;
mod mass;
mod positive_basis;
mod shape_derivative;
mod springs;
mod stiffness;

pub use dofs::{Along, Followers, NodeMotion, perpendicular, rigid_motions};
pub use dofs::{DofMap, Frame};
pub use element_stiffness::{add_to_nodes, element_stiffness, internal_force, of_cell};
pub use load::{
    FacetPoint, Kinks, add_centrifugal, add_gravity, add_moment, add_traction_with_kinks, facet_centres, facet_sizes,
    normal_sums, outward, turning_traction,
};
pub use load::{
    add_body_force, add_body_force_field, add_pressure, add_traction, add_traction_field, free_load, node_normals,
    tributary_areas,
};
pub use mass::{MassForm, mass};
pub use mass::{free_mass, least_over_lumped, mass_columns, nodal_mass, stiffness_columns};
pub use positive_basis::PositiveBasis;
pub use shape_derivative::{
    Density, Points, area_and_integral, body_force_by_places, centrifugal_by_places, gravity_by_places,
    integral_by_places, internal_work_by_places, interpolated, own_energy, own_energy_by_places, own_energy_change,
};
pub use springs::{NodalForces, Springs};
pub use stiffness::{stiffness, stiffness_on};
