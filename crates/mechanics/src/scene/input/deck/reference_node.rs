//! What an answer says of reference nodes, which are no nodes of its mesh: displacements and forces as sums of its
//! parts.

use std::collections::HashMap;

/// The displacement along x, y, z, in length, and the rotation about them, in radians, of nodes, by their numbers.
pub(crate) type Displacements = HashMap<usize, [f64; 6]>;

/// A part of the answer to the scene of a deck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    /// The displacement of the node of this number along x, y or z, from 0.
    Displacement(usize, usize),
    /// The multiplier of the equation of a tie.
    Multiplier(usize),
    /// A motion of a rigid face: displacements from 0, rotations from 3.
    Motion(usize, usize),
    /// The force of a rigid face along x, y or z, or from 3 its moment about its centre, which is given.
    Force(usize, usize, [f64; 3]),
    /// The shortening of the bolt of a tie.
    Shortening(usize),
    /// The tension of the bolt of a tie.
    Tension(usize),
}

/// A constant and multiples of parts of an answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Amount {
    pub constant: f64,
    pub parts: Vec<(f64, Part)>,
}

impl Amount {
    pub fn one(part: Part) -> Self {
        Amount { constant: 0.0, parts: vec![(1.0, part)] }
    }
}

/// A reference node. The force on it comes from outside: loads, and what holds a prescribed displacement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ReferenceNode {
    pub number: usize,
    /// Along x, y, z, or its local axes, then rotations about x, y, z.
    pub displacement: [Amount; 6],
    /// The force along these directions, then the moments about them.
    pub force: [Amount; 6],
}

impl ReferenceNode {
    /// A node without displacements and forces.
    pub fn new(number: usize) -> Self {
        ReferenceNode { number, displacement: Default::default(), force: Default::default() }
    }
}
