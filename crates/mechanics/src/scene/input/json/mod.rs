//! JSON as scenes have it: a text becomes a tree with places, and the tree a typed value; every fault has its path and
//! its place.

mod fault;
mod text;
mod typed;

pub(crate) use fault::{line_and_column, start_of};
pub(crate) use text::{parsed, plain};
pub(crate) use typed::Typed;
