//! Elastic bodies in frictionless unilateral contact: meshes, scenes, motions and studies on the quadratic program of
//! `signorini_qp`.
//!
//! ```
//! use signorini_mechanics::{Scene, scene::Answer};
//! use signorini_qp::solve_qp;
//! use std::sync::Arc;
//!
//! // A rod of stiffness E A / L = 100 x 1 / 2, pulled with force 3 towards a wall at distance 0.04.
//! let text = r#"{
//!     "model": "bar",
//!     "body": {"bar": {"x": {"points": [0, 2], "divisions": [4]}}},
//!     "material": {"young": 100, "poisson": 0},
//!     "supports": [{"on": {"boundary": "left"}, "x": 0}],
//!     "loads": [{"force": {"boundary": "right", "value": [3]}}],
//!     "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2.04], "normal": [1]}}}]
//! }"#;
//! let model = Arc::new(Scene::from_json(text, "rod")?.build()?);
//! let answer = Answer::of(model.clone(), &solve_qp(model.problem())?)?;
//! assert!((answer.pressure()[0] - (3.0 - 50.0 * 0.04)).abs() < 1e-12);
//! # Ok::<(), signorini_mechanics::Error>(())
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`fem`] | elastic bodies: meshes, elements, assembly, recovery of stresses; it names no contact problem |
//! | [`motion`] | contact in time: mass, schemes, the loop over steps |
//! | [`scene`] | scenes in JSON, their models, and the answers to them |
//!
//! `signorini` re-exports these modules. The sentence of an [`Error`] names the value that is wrong and what is
//! allowed: functions list only the errors by which a caller may decide.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(clippy::missing_errors_doc, reason = "see above: the sentence of an error says what is wrong")]

#[doc(hidden)]
pub mod bytes;
mod error;
pub mod scene;

pub use error::{Error, nearest};
pub use scene::{Model, Scene};
pub use signorini_fem as fem;
pub use signorini_motion as motion;
