//! Linear elastic bodies by finite elements: meshes, elements, materials, assembly of K and f, recovery of stresses.
//! It depends on no contact problem, no quadratic program and no scene.
//!
//! ```
//! use signorini_fem::{DofMap, ElasticBody, ElementKind, Formulation, Material, Mesh, stiffness};
//! // A rod of two elements, E A / L = 100 x 1 / 2 each, held at its left end.
//! let mesh = Mesh::new([0.0, 2.0, 4.0].map(|x| [x, 0.0, 0.0]).to_vec(), ElementKind::Line2, vec![0, 1, 1, 2], vec![])?;
//! let body = ElasticBody::new(mesh, Material::new(100.0, 0.0)?, Formulation::Bar { area: 1.0 })?;
//! let k = stiffness(&body, &DofMap::new(vec![Some(0.0), None, None])?)?;
//! assert_eq!(k.mul(&[1.0, 1.0]), [50.0, 0.0]);
//! # Ok::<(), signorini_fem::Error>(())
//! ```
//!
//! The hidden modules are for the crates of this workspace. The sentence of an [`Error`] names the value that is wrong
//! and what is allowed: functions list only the errors by which a caller may decide.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(clippy::missing_errors_doc, reason = "see above: the sentence of an error says what is wrong")]

#[doc(hidden)]
pub mod assembly;
#[doc(hidden)]
pub mod body;
#[doc(hidden)]
pub mod dense;
#[doc(hidden)]
pub mod element;
mod error;
#[doc(hidden)]
pub mod formulation;
#[doc(hidden)]
pub mod geometry;
#[doc(hidden)]
pub mod material;
#[doc(hidden)]
pub mod mesh;
#[doc(hidden)]
pub mod mortar;
#[doc(hidden)]
pub mod recovery;
#[doc(hidden)]
pub mod sum;
#[doc(hidden)]
pub mod surface;
#[doc(hidden)]
pub mod threads;

pub use assembly::{
    DofMap, Frame, MassForm, add_body_force, add_body_force_field, add_pressure, add_traction, add_traction_field,
    free_load, internal_force, mass, stiffness, tributary_areas,
};
pub use body::{ElasticBody, Integration, Region};
pub use element::{ElementKind, FacetKind, QuadraturePoint};
pub use error::Error;
#[doc(hidden)]
pub use error::{nearest, nearly, number};
pub use formulation::Formulation;
pub use material::Material;
pub use mesh::gmsh::GmshFile;
pub use mesh::{Axis, Boundary, Mesh, Zone};
pub use mortar::{Mortar, MortarRows};
pub use recovery::along::{PathPiece, PathPoint};
pub use recovery::{Stress, StressField, discretisation_error, stress};
pub use surface::ClosedSurface;
pub use threads::limit_threads;
