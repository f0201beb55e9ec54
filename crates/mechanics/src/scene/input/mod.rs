//! A scene as it is written: its JSON, its schema, and the kinds of bodies and obstacles.

pub(crate) mod absent;
pub(crate) mod body;
pub(crate) mod deck;
pub(crate) mod entry;
mod json;
pub(crate) mod names;
pub(crate) mod obstacle;
pub(crate) mod parse;
pub(crate) mod profile;
pub(crate) mod roles;
pub(crate) mod schema;
pub(crate) mod size;
pub(crate) mod warning;
