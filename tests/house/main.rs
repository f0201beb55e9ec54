//! The rules of the project: the floors of its modules, its one error type, its examples, its documents.

mod architecture;
mod circles;
mod commands;
mod dependencies;
mod documentation;
mod documents;
mod effort;
mod errors;
mod examples;
mod figures;
mod imports;
mod kinds;
mod public;
mod readme;
