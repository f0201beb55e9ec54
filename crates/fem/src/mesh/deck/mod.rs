//! Input decks of CalculiX, a dialect of those of Abaqus: `.inp` files with nodes, elements, sets and surfaces. All
//! other cards are kept as they are written.
//!
//! A body is all elements that are joined by common nodes; the bodies are called `body-1`, `body-2`, ... in the order
//! of their first elements. An element set is a group of elements as well. Surfaces of faces are boundaries, and the
//! faces that *DLOAD presses too.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.20, chapter "Input deck format".

mod body;
mod content;
mod cut;
mod faces;
mod kinds;
mod sets;
mod source;

pub use content::{Deck, DeckElement};
pub use kinds::{Space, SpringType};
pub use sets::{DeckSurface, Overridden};
pub use source::{DataFields, DeckCard, DeckPlace, cut, key};
