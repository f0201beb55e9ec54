//! Motion with contact, integrated in time: every step is a contact problem with one prepared matrix.
//!
//! ```text
//! K_eff w = r + B' lambda,   B w <= g - B u^,   K_eff = M/(beta dt^2) + C gamma/(beta dt) + K,   u = u^ + w
//! ```
//!
//! The unknown of a step is the change w against a prediction u^, so that no digits are lost after a large motion.
//!
//! ```
//! use signorini_motion::{DynamicProblem, Integrator, Scheme};
//! use signorini_qp::{ContactProblem, Settings, SparseMatrix, SymmetricMatrix};
//!
//! // A mass of 1 on a spring of 1 lets go at u = 1; after half a period, pi, it stands at u = -1.
//! let one = || SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?);
//! let no_rows = SparseMatrix::from_triplets(0, 1, &[])?;
//! let contact = ContactProblem::new(one()?, vec![0.0], no_rows, vec![])?;
//! let problem = DynamicProblem::new(contact, one()?)?.starting_from(vec![1.0], vec![0.0])?;
//! let step = std::f64::consts::PI / 1000.0;
//! let mut integrator = Integrator::new(problem, Scheme::Midpoint, step, &Settings::default())?;
//! for _ in 0..1000 {
//!     integrator.advance()?;
//! }
//! assert!((integrator.state().displacement[0] + 1.0).abs() < 1e-5);
//! # Ok::<(), signorini_qp::Error>(())
//! ```

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(clippy::missing_errors_doc, reason = "the sentence of an error says what is wrong")]

mod integrator;
mod problem;
mod scheme;
mod step;

pub use integrator::Integrator;
#[doc(hidden)]
pub use integrator::bytes_of_motion;
pub use problem::{DynamicProblem, TimeFunction};
#[doc(hidden)]
pub use scheme::{MOST_IN_CONTACT, frequency_bound};
pub use scheme::{Scheme, SchemeSpec};
#[doc(hidden)]
pub use step::Balance;
pub use step::{Observation, Parameter, State};
