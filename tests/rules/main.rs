//! The rules of the project: the order of its modules, its one error type, its examples, its documents.

mod architecture;
mod commands;
mod dependencies;
mod documentation;
mod documents;
mod effort;
mod errors;
mod examples;
mod figures;
mod public;
mod readme;
mod sources;
