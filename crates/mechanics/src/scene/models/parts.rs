//! The components of a model before its contact rows.

use super::held::Held;
use super::points::ReferencePoints;
use super::rigid_face::RigidFace;
use super::symmetry::Symmetry;
use super::ties::Ties;
use crate::error::Error;
use crate::fem::assembly::{DofMap, NodalForces, Springs};
use crate::fem::body::ElasticBody;
use crate::scene::Warning;
use crate::scene::input::obstacle::PlacedObstacle;
use crate::scene::input::schema::{ContactSpec, Scene};
use signorini_qp::ContactProblem;

/// The data that do not depend on the gap.
#[derive(Debug)]
pub struct Parts {
    /// With the contacts that were found.
    pub scene: Scene,
    pub body: ElasticBody,
    pub conditions: Conditions,
    pub obstacles: Vec<PlacedObstacle>,
    /// The obstacles with a travel, in the order of their unknowns, which come last.
    pub pressed: Vec<usize>,
    pub ties: Ties,
    pub warnings: Vec<Warning>,
}

/// What a scene asks of its body.
#[derive(Debug)]
pub struct Conditions {
    /// The unknowns.
    pub dofs: DofMap,
    /// The prescribed components of the nodes.
    pub held: Held,
    /// External load at all nodes, length `dim * n_nodes`.
    pub load: Vec<f64>,
    /// Springs, in the order of the scene.
    pub springs: Vec<Springs>,
    pub symmetry: Symmetry,
    /// Boundaries that move as rigid plates, in the order of the scene.
    pub rigid_faces: Vec<RigidFace>,
    pub points: ReferencePoints,
}

/// Where a model comes from: what sentences may advise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    Deck,
    /// A scene with `"contact": "auto"`.
    WithAuto,
    Scene,
}

impl Parts {
    /// Returns `true` if inertia resists motions that no support holds: in a motion.
    pub fn moves(&self) -> bool {
        self.scene.dynamic().is_some()
    }

    pub fn origin(&self) -> Origin {
        match self.scene.contact {
            _ if !self.scene.lines.is_empty() => Origin::Deck,
            Some(ContactSpec::Auto) => Origin::WithAuto,
            None => Origin::Scene,
        }
    }

    /// The external load with the tensions of bolts, and the forces of springs on nodes with prescribed displacements.
    pub fn acting_load(&self) -> Result<Vec<f64>, Error> {
        let mut load = self.conditions.load.clone();
        if !self.ties.shortenings.is_empty() {
            let tensions = self.tie_forces(&vec![0.0; self.ties.rows.len()]);
            load.iter_mut().zip(tensions).for_each(|(load, force)| *load += force);
        }
        if !self.conditions.springs.is_empty() {
            let lifted = self.conditions.dofs.expand(&vec![0.0; self.conditions.dofs.count()])?;
            load.iter_mut().zip(self.spring_forces(&lifted)).for_each(|(load, force)| *load += force);
        }
        Ok(load)
    }

    /// A problem of the unknowns with the equations of the ties.
    pub fn tied(&self, problem: ContactProblem) -> Result<ContactProblem, Error> {
        match self.ties.rows.is_empty() {
            true => Ok(problem),
            false => Ok(problem.with_equalities(&self.ties.matrix, self.ties.values.clone())?),
        }
    }

    /// The forces of all ties on both sides: on the nodes, length `dim * n_nodes`, in force, from the multipliers of
    /// all equations.
    pub fn tie_forces(&self, of_ties: &[f64]) -> Vec<f64> {
        self.on_all_nodes([self.forces_of_ties(of_ties, None)])
    }

    /// The forces of one tie on its first side, or of all ties on both sides.
    pub fn forces_of_ties(&self, of_ties: &[f64], one: Option<usize>) -> NodalForces {
        let ties = &self.ties;
        let rows = one.map_or(0..ties.rows.len(), |tie| ties.of_tie[tie].clone());
        let of_rows = rows.map(|row| (&ties.rows[row].form, of_ties[row]));
        let tensions = ties.shortenings.iter().filter(|of| one.is_none_or(|tie| tie == of.tie));
        let mut forces = NodalForces::new();
        for (form, size) in of_rows.chain(tensions.filter_map(|of| Some((&of.form, of.force?)))) {
            for (node, vector) in if one.is_some() { form.sides()[0] } else { &form.terms } {
                for (of, share) in self.conditions.dofs.basis.shares(*node) {
                    let force = forces.entry(of).or_default();
                    force.iter_mut().zip(vector).for_each(|(entry, part)| *entry += share * size * part);
                }
            }
        }
        forces
    }

    /// The forces of all springs on the nodes in a nodal displacement.
    pub fn spring_forces(&self, displacement: &[f64]) -> Vec<f64> {
        self.on_all_nodes(
            self.conditions.springs.iter().map(|springs| springs.forces(displacement, self.body.dimension())),
        )
    }

    fn on_all_nodes(&self, all: impl IntoIterator<Item = NodalForces>) -> Vec<f64> {
        let (mut forces, dimension) = (vec![0.0; self.conditions.dofs.nodal_count()], self.body.dimension());
        for (node, force) in all.into_iter().flatten() {
            let entries = &mut forces[dimension * node..dimension * (node + 1)];
            entries.iter_mut().zip(force).for_each(|(entry, part)| *entry += part);
        }
        forces
    }

    /// The share of the modelled part of the body in a force that presses an obstacle.
    pub fn share_of(&self, obstacle: usize, force: f64) -> f64 {
        force / self.parts_of_obstacle(obstacle)
    }

    /// Number of copies of the modelled part that one copy of an obstacle presses.
    pub fn parts_of_obstacle(&self, obstacle: usize) -> f64 {
        self.conditions.symmetry.parts_of_obstacle(self.obstacles[obstacle].approach())
    }
}
