//! The files of a command in its folder: answers, fields, tables and pictures.

pub(crate) mod calculix;
mod fields;
// A motion needs only its fields and the scene of a picture.
pub(crate) mod gallery;
pub(crate) mod modes;
pub(crate) mod motion;
mod motion_table;
mod msh;
pub(crate) mod problem_sweep;
pub(crate) mod tables;
pub(crate) mod total_error;
pub(crate) mod vtu;
