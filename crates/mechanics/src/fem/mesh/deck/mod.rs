//! Input decks of CalculiX, a dialect of those of Abaqus: `.inp` files with nodes, elements, sets and surfaces, and with all other cards for
//! those who understand them.
//!
//! A body is all elements that are joined by common nodes; the bodies are called `body-1`, `body-2`, ... in the order of their first
//! elements. An element set is a group of elements as well. Surfaces of faces are boundaries, and the faces that *DLOAD presses too.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.20, chapter "Input deck format".

mod body;
mod boundaries;
mod card;
mod content;
mod faces;
mod kinds;
mod sets;
mod source;

pub(crate) use card::{Card, Fields, Place, key};
pub(crate) use content::{Deck, DeckElement};
pub(crate) use kinds::Space;
