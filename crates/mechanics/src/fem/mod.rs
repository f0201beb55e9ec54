//! Linear elastic bodies by finite elements: meshes, elements, materials, assembly of K and f, recovery of stresses,
//! error norms. It depends on no contact problem and no solver.

pub(crate) mod assembly;
pub(crate) mod body;
pub(crate) mod dense;
pub(crate) mod element;
pub(crate) mod formulation;
pub mod geometry;
pub(crate) mod material;
pub(crate) mod mesh;
pub(crate) mod mortar;
pub(crate) mod norms;
pub(crate) mod recovery;
pub(crate) mod surface;
pub(crate) mod threads;

pub use assembly::{
    DofMap, Frame, MassForm, add_body_force, add_body_force_field, add_pressure, add_traction, add_traction_field,
    free_load, internal_force, mass, rigid_body_modes, stiffness, tributary_areas,
};
pub use body::{ElasticBody, Integration, Region};
pub use element::{ElementKind, FacetKind, QuadraturePoint};
pub use formulation::Formulation;
pub use material::Material;
pub use mesh::gmsh::GmshFile;
pub use mesh::{Axis, Boundary, Mesh, Zone};
pub use mortar::{Mortar, MortarRows};
pub use norms::{ErrorNorms, ExactState, error_norms, error_norms_by};
pub use recovery::along::{PathPiece, PathPoint};
pub use recovery::{Stress, StressField, discretisation_error, stress};
pub use surface::ClosedSurface;
pub use threads::limit_threads;
