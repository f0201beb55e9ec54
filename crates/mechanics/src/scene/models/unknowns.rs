//! The unknowns of a contact problem: the free dofs except those of rigid faces, the motions of rigid faces, and the
//! travels of obstacles that a force presses.
//!
//! A pressed obstacle, and one with a mass in a motion, moves along its approach direction `a` alone, by the travel `d`
//! against it: one more unknown without stiffness, with the force F as its load. Each of its rows holds
//! `n . u + (n . a) d <= gap`, so that the forces of its rows along `a` add up to F.

use super::parts::Parts;
use super::rigid_face::RigidFace;
use crate::error::Error;
use crate::fem::assembly::{DofMap, Followers, NodeMotion};
use crate::fem::body::ElasticBody;
use signorini_qp::{SparseMatrix, SymmetricMatrix};

/// The quantity that an unknown of the problem stands for, and the place of the body that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// The displacement of a node along a unit vector, or the coefficient of a mid-side node.
    Node {
        /// Index of the moved node in the mesh, from 0.
        node: usize,
        /// The unit vector [x, y, z].
        direction: [f64; 3],
        /// The word for it in a table, as `displacement`.
        quantity: &'static str,
    },
    /// A motion of a rigid face.
    Face {
        /// Its number among the rigid faces of the scene, from 0.
        face: usize,
        /// As `rotation.z`; a rotation is measured in `unit` radians.
        motion: &'static str,
        /// In length, or in radians.
        unit: f64,
    },
    /// The travel of an obstacle that a force presses.
    Travel {
        /// Its number in the list of the scene, from 0.
        obstacle: usize,
    },
}

/// The same dofs with the nodes of rigid faces following the motions of these, but for the prescribed ones.
pub(crate) fn following(dofs: DofMap, body: &ElasticBody, faces: &[RigidFace]) -> DofMap {
    if faces.is_empty() {
        return dofs;
    }
    let followers = |face: &RigidFace| {
        let free = || face.motions.iter().filter(|motion| motion.prescribed.is_none());
        let in_model =
            |vector: [f64; 3]| [0, 1, 2].map(|axis| if axis < body.dimension() { vector[axis] } else { 0.0 });
        let moved = |node: usize| {
            let at = dofs.basis.place(body.mesh().nodes(), node);
            let by_one = free().map(|motion| face.displacement(motion, at).map(|part| part * face.unit(motion)));
            NodeMotion { offset: in_model(face.prescribed(at)), by_unknown: by_one.map(in_model).enumerate().collect() }
        };
        Followers { motions: free().count(), nodes: face.nodes.iter().map(|&node| (node, moved(node))).collect() }
    };
    let groups = faces.iter().map(followers).collect();
    dofs.with_followers(body.dimension(), groups)
}

impl Parts {
    /// Number of unknowns of the bodies: all but the travels.
    fn of_bodies(&self) -> usize {
        self.conditions.dofs.count() - self.pressed.len()
    }

    /// The unknown that is the travel of an obstacle; `None` for an obstacle at rest.
    pub fn travel(&self, obstacle: usize) -> Option<usize> {
        self.pressed.iter().position(|&pressed| pressed == obstacle).map(|place| self.of_bodies() + place)
    }

    /// The unknowns next to a motion of each node, or of its coefficient, with a value for each obstacle with a travel.
    pub fn nearest(&self, at: impl Fn(usize) -> [f64; 3], of_travel: impl Fn(usize) -> f64) -> Vec<f64> {
        self.pressed_by(self.conditions.dofs.nearest(at), of_travel)
    }

    /// The load of the unknowns from that of the bodies, with the forces and moments on rigid faces, and the force on
    /// each pressed obstacle.
    pub fn load(&self, mut of_bodies: Vec<f64>) -> Vec<f64> {
        for (index, face) in self.conditions.rigid_faces.iter().enumerate() {
            let free = face.motions.iter().filter(|motion| motion.prescribed.is_none());
            for (unknown, motion) in self.conditions.dofs.motions(index).zip(free) {
                of_bodies[unknown] += motion.force * face.unit(motion);
            }
        }
        self.pressed_by(of_bodies, |obstacle| self.share_of(obstacle, self.obstacles[obstacle].force().unwrap_or(0.0)))
    }

    /// The same values with others for the travels of pressed obstacles.
    pub fn pressed_by(&self, mut values: Vec<f64>, of_obstacle: impl Fn(usize) -> f64) -> Vec<f64> {
        values.truncate(self.of_bodies());
        values.extend(self.pressed.iter().map(|&obstacle| of_obstacle(obstacle)));
        values
    }

    /// The meaning of each unknown.
    pub fn meanings(&self) -> impl Iterator<Item = Meaning> + '_ {
        let (dofs, dimension) = (&self.conditions.dofs, self.body.dimension());
        let of_node = move |&dof: &usize| {
            let (node, axis) = (dof / dimension, dof % dimension);
            let quantity = if dofs.basis.ends(node).is_some() { "coefficient" } else { "displacement" };
            Meaning::Node { node, direction: dofs.axes(node)[axis], quantity }
        };
        let of_faces = self.conditions.rigid_faces.iter().enumerate().flat_map(|(index, face)| {
            let free = face.motions.iter().filter(|motion| motion.prescribed.is_none());
            free.map(move |motion| Meaning::Face { face: index, motion: motion.name(), unit: face.unit(motion) })
        });
        let travels = self.pressed.iter().map(|&obstacle| Meaning::Travel { obstacle });
        dofs.free().iter().map(of_node).chain(of_faces).chain(travels)
    }

    /// The stiffness of the unknowns with a spring on each pressed obstacle, as stiff as the stiffest dof.
    pub fn on_springs(&self, stiffness: &SymmetricMatrix) -> Result<SymmetricMatrix, Error> {
        let spring = stiffness.diagonal().into_iter().fold(0.0, f64::max);
        self.with_travels(stiffness, |_| spring)
    }

    /// A matrix of the unknowns with a diagonal entry for the travel of each obstacle.
    pub fn with_travels(
        &self,
        matrix: &SymmetricMatrix,
        of_obstacle: impl Fn(usize) -> f64,
    ) -> Result<SymmetricMatrix, Error> {
        if self.pressed.is_empty() {
            return Ok(matrix.clone());
        }
        let travels = (self.of_bodies()..).zip(&self.pressed);
        let own = travels.map(|(unknown, &obstacle)| (unknown, unknown, of_obstacle(obstacle)));
        let entries: Vec<_> = matrix.lower().triplets().chain(own).collect();
        let count = self.conditions.dofs.count();
        Ok(SymmetricMatrix::from_lower(SparseMatrix::from_triplets(count, count, &entries)?)?)
    }
}
