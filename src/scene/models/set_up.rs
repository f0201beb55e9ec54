//! Supports, springs, rigid faces and loads of the body, node by node, for pictures.

use super::model::Model;

/// The kind of a hold of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hold {
    /// Supports, the axis of revolution and planes of symmetry that prescribe the whole displacement.
    Fixed,
    /// The same if they prescribe the displacement along some directions.
    Guided,
    /// A spring to the ground.
    Spring,
    /// A rigid face; the node moves with it.
    RigidFace,
}

/// A held node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeldNode {
    /// The node.
    pub node: usize,
    /// The kind of its hold.
    pub hold: Hold,
    /// The directions [x, y, z] of the hold, of unit length; empty for a rigid face.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub directions: Vec<[f64; 3]>,
}

impl Model {
    /// The held nodes: supports first, then springs, then rigid faces.
    pub(crate) fn held_nodes(&self) -> Vec<HeldNode> {
        let parts = &self.parts;
        let mut nodes = Vec::new();
        let mut hold =
            |node: usize, hold: Hold, directions: Vec<[f64; 3]>| nodes.push(HeldNode { node, hold, directions });
        for (node, directions) in parts.held.directions() {
            let is_fixed = directions.len() >= self.mesh().dimension();
            hold(node, if is_fixed { Hold::Fixed } else { Hold::Guided }, directions);
        }
        for springs in &parts.springs {
            for (node, direction) in springs.held() {
                hold(node, Hold::Spring, vec![direction]);
            }
        }
        for face in &parts.rigid_faces {
            face.nodes.iter().for_each(|&node| hold(node, Hold::RigidFace, Vec::new()));
        }
        nodes
    }

    /// The loaded nodes, each with its force: a component for each coordinate.
    pub(crate) fn loaded_nodes(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let nodal = self.nodal_load().chunks_exact(self.mesh().dimension()).enumerate();
        nodal.filter(|(_, force)| force.iter().any(|&part| part != 0.0))
    }
}
