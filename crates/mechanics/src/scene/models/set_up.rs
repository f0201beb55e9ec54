//! Supports, springs, rigid faces and loads of the body, node by node, for pictures.

use super::model::Model;
use crate::fem::geometry::unit;

/// The way in which a support, a spring or a symmetry keeps a node in its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Supports, the axis of revolution and planes of symmetry that prescribe the whole displacement.
    Fixed,
    /// The same if they prescribe the displacement along some directions.
    Guided,
    /// An elastic spring from the node to the ground.
    Spring,
    /// A rigid face; the node moves with it.
    RigidFace,
}

/// A node that something keeps in its place along at least one direction, for the picture of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldNode {
    /// Index of the held node in the mesh, from 0.
    pub node: usize,
    /// Support, spring or symmetry.
    pub hold: Hold,
    /// The directions [x, y, z] of the hold, of unit length; empty for a rigid face.
    pub directions: Vec<[f64; 3]>,
}

impl Model {
    /// The held nodes: supports first, then springs, then rigid faces.
    pub fn held_nodes(&self) -> Vec<HeldNode> {
        let parts = &self.parts;
        let mut nodes = Vec::new();
        let mut hold =
            |node: usize, hold: Hold, directions: Vec<[f64; 3]>| nodes.push(HeldNode { node, hold, directions });
        for (node, directions) in parts.held.directions() {
            let is_fixed = directions.len() >= self.mesh().dimension();
            hold(node, if is_fixed { Hold::Fixed } else { Hold::Guided }, directions);
        }
        for springs in &parts.springs {
            for (node, direction) in springs.resisted().into_iter().flatten() {
                hold(node, Hold::Spring, vec![unit(direction)]);
            }
        }
        for face in &parts.rigid_faces {
            face.nodes.iter().for_each(|&node| hold(node, Hold::RigidFace, Vec::new()));
        }
        nodes
    }

    /// The loaded nodes, each with its force, in force: a component for each coordinate, in their order.
    pub fn loaded_nodes(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let nodal = self.nodal_load().chunks_exact(self.mesh().dimension()).enumerate();
        nodal.filter(|(_, force)| force.iter().any(|&part| part != 0.0))
    }
}
