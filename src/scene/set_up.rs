//! What stands around the body before anything is solved, node by node, for pictures.

use super::model::Model;

/// What holds a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hold {
    /// A support, the axis of revolution or a plane of symmetry, which prescribes the displacement along the direction.
    Support,
    /// A spring to the ground.
    Spring,
    /// A rigid face, with which the node moves.
    RigidFace,
}

/// A node that something holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeldNode {
    /// The node.
    pub node: usize,
    /// What holds it.
    pub hold: Hold,
    /// The directions [x, y, z] along which it does, of unit length; none of a rigid face.
    pub directions: Vec<[f64; 3]>,
}

impl Model {
    /// The nodes that something holds: supports first, then springs, then rigid faces.
    pub(crate) fn held_nodes(&self) -> Vec<HeldNode> {
        let parts = self.parts();
        let mut nodes = Vec::new();
        let mut hold =
            |node: usize, hold: Hold, directions: Vec<[f64; 3]>| nodes.push(HeldNode { node, hold, directions });
        for (node, directions) in parts.held.directions() {
            hold(node, Hold::Support, directions);
        }
        for springs in &parts.springs {
            for (node, direction) in springs.held() {
                hold(node, Hold::Spring, vec![direction]);
            }
        }
        for face in &parts.rigid_faces {
            face.nodes().iter().for_each(|&node| hold(node, Hold::RigidFace, Vec::new()));
        }
        nodes
    }
}
