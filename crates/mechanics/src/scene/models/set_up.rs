//! Supports, springs, rigid faces and loads of the body, node by node, for pictures; the mass of a model.

use super::model::Model;
use crate::error::Error;
use crate::fem::assembly::{free_mass, nodal_mass};
use crate::fem::geometry::unit;
use crate::fem::{self, MassForm};
use crate::scene::input::entry::{located, wrong};
use signorini_qp::{SparseMatrix, SymmetricMatrix};

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
        for (node, directions) in parts.conditions.held.directions() {
            let is_fixed = directions.len() >= self.mesh().dimension();
            hold(node, if is_fixed { Hold::Fixed } else { Hold::Guided }, directions);
        }
        for springs in &parts.conditions.springs {
            for (node, direction) in springs.resisted().into_iter().flatten() {
                hold(node, Hold::Spring, vec![unit(direction)]);
            }
        }
        for face in &parts.conditions.rigid_faces {
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

impl Model {
    /// The mass of the nodes, in one of its forms; the lower triangle.
    pub(crate) fn nodal_mass(&self, form: MassForm) -> Result<SparseMatrix, Error> {
        let contact_nodes: Vec<usize> = self.rows().iter().flat_map(|row| row.ends.iter().map(|end| end.0)).collect();
        nodal_mass(self.body(), form, &contact_nodes).map_err(|error| match error {
            fem::Error::Mesh { message } => wrong("body", message),
            other => located(other, "material."),
        })
    }

    /// The mass of the unknowns, from that of the nodes.
    pub(crate) fn mass_of(&self, nodal_mass: &SparseMatrix) -> Result<SymmetricMatrix, Error> {
        let parts = &self.parts;
        let of_body = parts.unknowns.congruent(free_mass(&parts.body, &parts.conditions.dofs, nodal_mass)?)?;
        let of_obstacle = |obstacle: usize| {
            parts.share_of(obstacle, parts.obstacles[obstacle].inertia().map_or(0.0, |inertia| inertia.mass))
        };
        parts.unknowns.with_travels(&of_body, of_obstacle)
    }

    /// The mass M (n x n) of the unknowns of the [problem](Model::problem), in one of its forms, in mass.
    ///
    /// # Errors
    /// [`Error::Scene`] for a material without density, and for a mesh too coarse to redistribute its mass.
    pub fn mass(&self, form: MassForm) -> Result<SymmetricMatrix, Error> {
        self.mass_of(&self.nodal_mass(form)?)
    }
}
