//! Surfaces of a deck: faces of elements.

use std::collections::HashMap;

use super::card::{Place, key};

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Surface {
    pub name: String,
    pub place: Place,
    /// Elements and their faces, from 0; for a surface of nodes the faces that have only nodes of it.
    pub faces: Vec<(usize, usize)>,
    /// The nodes of a surface of nodes that are on none of these faces, by their places.
    pub bare: Vec<usize>,
}

/// All surfaces; names that differ only in case or blanks are one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Surfaces {
    pub all: Vec<Surface>,
    places: HashMap<String, usize>,
}

impl Surfaces {
    pub fn named(&self, name: &str) -> Option<&Surface> {
        self.places.get(&key(name)).map(|&place| &self.all[place])
    }

    pub fn named_mut(&mut self, name: &str) -> Option<&mut Surface> {
        self.places.get(&key(name)).map(|&place| &mut self.all[place])
    }

    pub fn add(&mut self, surface: Surface) {
        self.places.insert(key(&surface.name), self.all.len());
        self.all.push(surface);
    }
}

/// Faces that a card *DLOAD presses with one value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FacePressure {
    /// The number of the card among all cards.
    pub card: usize,
    /// The name of the surface of these faces.
    pub surface: String,
    pub place: Place,
    pub value: f64,
}
