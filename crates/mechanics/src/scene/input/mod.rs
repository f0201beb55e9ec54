//! A scene as it is written: its JSON, its schema, and the kinds of bodies and obstacles.

#[macro_use]
mod spec;

pub mod absent;
pub mod body;
pub mod entry;
mod json;
pub mod names;
pub mod obstacle;
pub mod parse;
pub mod profile;
pub mod roles;
pub mod schema;
pub mod size;
pub mod warning;
