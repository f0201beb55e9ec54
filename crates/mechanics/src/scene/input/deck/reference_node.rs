//! What an answer says of reference nodes, which are no nodes of its mesh.

use std::collections::HashMap;

/// The displacement along x, y, z, in length, and the rotation about them, in radians, of nodes, by their numbers.
pub(crate) type Displacements = HashMap<usize, [f64; 6]>;

/// A reference node that is no reference point of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ReferenceNode {
    pub number: usize,
    pub of: Of,
}

/// The entry of the scene that a reference node moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Of {
    /// A rigid face about a centre. The directions of the node name its motions from this one: 0 for displacements, 3
    /// for rotations.
    Face { face: usize, first: usize, centre: [f64; 3] },
    /// The rotations of the reference point of this number.
    Turns { point: usize },
}
