//! The files of a command in its folder: answers, fields, tables and pictures.

#[cfg(feature = "cli")]
pub(crate) mod estimated_error;
mod fields;
// A motion needs only its fields and the scene of a picture.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod gallery;
pub(crate) mod motion;
mod motion_table;
#[cfg(feature = "cli")]
mod msh;
#[cfg(feature = "cli")]
pub(crate) mod problem_sweep;
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) mod tables;
#[cfg(feature = "cli")]
pub(crate) mod total_error;
pub(crate) mod vtu;
