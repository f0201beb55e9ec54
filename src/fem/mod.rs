//! Linear elastic bodies by finite elements: meshes, elements, materials, assembly of K and f, recovery of stresses, error
//! norms, closed forms. It knows no contact problem and no solver.

pub mod assembly;
pub mod body;
pub mod closed_forms;
pub mod element;
pub mod formulation;
pub(crate) mod geometry;
pub mod material;
pub mod mesh;
pub mod norms;
pub mod recovery;
