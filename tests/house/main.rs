//! The rules of the project: the floors of its modules, its one error type, its examples, its documents.

#[path = "../support/bodies.rs"]
mod bodies;
#[path = "../support/oracles/mod.rs"]
mod oracles;

mod architecture;
mod dependencies;
mod documentation;
mod documents;
mod errors;
mod examples;
mod imports;
mod kinds;
mod public;
mod readme;
