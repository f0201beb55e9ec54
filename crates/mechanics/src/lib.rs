//! Elastic bodies in frictionless unilateral contact.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod bytes;
mod continuum;
mod error;
pub mod fem;
pub mod motion;
pub mod scene;
pub mod study;

pub use error::{Error, nearest};
pub use scene::{Model, Scene};
