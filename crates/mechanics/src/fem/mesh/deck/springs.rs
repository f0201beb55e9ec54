//! The spring elements of a deck: they join nodes and have no volume.

use super::card::Place;
use super::sets::{Numbered, Sets};

/// The kinds of spring elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpringType {
    /// Between two nodes, along the line through them.
    Along,
    /// Between a displacement of a node and the ground.
    ToGround,
    /// Between displacements of two nodes.
    Between,
}

impl SpringType {
    /// The kind of this name in capitals.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "SPRINGA" => Some(SpringType::Along),
            "SPRING1" => Some(SpringType::ToGround),
            "SPRING2" => Some(SpringType::Between),
            _ => None,
        }
    }

    /// Number of nodes of a spring element of this type: 1 or 2.
    pub fn nodes(self) -> usize {
        if self == SpringType::ToGround { 1 } else { 2 }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SpringElement {
    pub of_type: SpringType,
    /// Its nodes, by their places; one or two.
    pub nodes: Vec<usize>,
    pub place: Place,
}

/// All spring elements, with their numbers and sets.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SpringElements {
    pub numbers: Numbered,
    pub sets: Sets,
    pub all: Vec<SpringElement>,
}

impl SpringElements {
    pub fn new() -> Self {
        SpringElements { numbers: Numbered::default(), sets: Sets::new("element"), all: Vec::new() }
    }

    /// Returns `true` for the number of a spring, and for the name of a set of them.
    pub fn has(&self, target: &str) -> bool {
        match target.parse() {
            Ok(number) => self.numbers.place(number).is_some(),
            Err(_) => self.sets.named(target).is_some(),
        }
    }
}
