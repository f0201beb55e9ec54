//! What the tests share with each other and with the programs that measure: scenes, closed forms, oracles, and the
//! built program.
#![expect(clippy::too_many_lines, clippy::missing_errors_doc, reason = "tables of cases, and errors that end a test")]
#![forbid(unsafe_code)]

pub mod axis_scenes;
pub mod bodies;
pub mod brackets;
pub mod clock;
pub mod closed_forms;
pub mod decks;
pub mod draws;
pub mod effort;
pub mod endings;
pub mod extremes;
pub mod floors;
pub mod fuzz;
pub mod gmsh_forms;
pub mod impact;
pub mod key_scenes;
pub mod manufactured;
pub mod modal;
pub mod norms;
pub mod oracles;
pub mod pair_scenes;
pub mod plane_scenes;
pub mod problems;
pub mod program;
pub mod random;
pub mod rollers;
pub mod scenes;
pub mod slopes;
pub mod space_scenes;
pub mod triangles;
pub mod verification;

use std::path::Path;

pub use effort::{cases, seed};

/// The folder of the workspace.
///
/// # Panics
/// Never: this crate is two folders below it.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap()
}
