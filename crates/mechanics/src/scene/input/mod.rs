//! A scene as it is written: its JSON, its schema, and the kinds of bodies and obstacles, a file each.

pub(crate) mod absent;
pub(crate) mod body;
pub(crate) mod deck;
pub(crate) mod entry;
pub(crate) mod files;
mod json;
mod json_schema;
mod locate;
pub(crate) mod names;
pub(crate) mod obstacle;
mod parse;
pub(crate) mod profile;
mod refine;
pub(crate) mod roles;
pub(crate) mod schema;
pub(crate) mod size;
pub(crate) mod sum;
pub(crate) mod warning;
