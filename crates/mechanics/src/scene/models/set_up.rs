//! Supports, springs and rigid faces of the body, node by node, for pictures; the mass and the forces of a model.

use super::model::{self, Model};
use super::resultants::force_of_faces;
use super::rigid_body_modes::RigidBodyModes;
use crate::error::Error;
use crate::fem::assembly::{free_mass, internal_force, nodal_mass};
use crate::fem::geometry::unit;
use crate::fem::recovery::state::DisplacedState;
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

/// Reactions below this times the largest nodal force of temperatures and initial stresses are rounding of the solve:
/// these forces cancel if the body is free.
const OWN_ROUNDING: f64 = 1e-10;

/// The forces on all nodes of a model, sorted by their source.
///
/// Each array has length `dim * n_nodes`, order `[f_x0, f_y0, f_x1, ...]`, in force, along the positive axes on the
/// body.
#[derive(Clone, Debug, PartialEq)]
pub struct Forces {
    /// Contact forces on the body, length `dim * n_nodes`, in force, as [`Model::contact_forces`].
    pub contact: Vec<f64>,
    /// Reactions of supports on the body, length `dim * n_nodes`, in force, as [`Model::reactions`].
    pub reactions: Vec<f64>,
    /// Forces of springs on the body, length `dim * n_nodes`, in force.
    pub springs: Vec<f64>,
    /// Forces of rigid faces on the body, length `dim * n_nodes`, in force.
    pub rigid_faces: Vec<f64>,
    /// Forces of ties on the body, length `dim * n_nodes`, in force.
    pub ties: Vec<f64>,
    /// The imbalance of loads, reactions, springs, rigid faces, ties and contact forces, relative, as
    /// [`Model::force_balance`].
    pub balance: f64,
}

pub(crate) fn held_nodes(model: &Model) -> Vec<HeldNode> {
    let parts = &model.parts;
    let mut nodes = Vec::new();
    let mut hold = |node: usize, hold: Hold, directions: Vec<[f64; 3]>| nodes.push(HeldNode { node, hold, directions });
    for (node, directions) in parts.conditions.held.directions() {
        let is_fixed = directions.len() >= model.mesh().dimension();
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

/// The mass of the nodes, in one of its forms; the lower triangle.
pub(crate) fn mass_of_nodes(model: &Model, form: MassForm) -> Result<SparseMatrix, Error> {
    let contact_nodes: Vec<usize> = model.rows().iter().flat_map(|row| row.ends.iter().map(|end| end.0)).collect();
    nodal_mass(model.body(), form, &contact_nodes).map_err(|error| match error {
        fem::Error::Mesh { message } => wrong("body", message),
        other => located(other, "material."),
    })
}

/// The mass of the unknowns, from that of the nodes.
pub(crate) fn mass_of_unknowns(model: &Model, nodal_mass: &SparseMatrix) -> Result<SymmetricMatrix, Error> {
    let parts = &model.parts;
    let of_body = free_mass(&parts.body, &parts.conditions.dofs, nodal_mass)?;
    let of_obstacle = |obstacle: usize| {
        parts.share_of(obstacle, parts.obstacles[obstacle].inertia().map_or(0.0, |inertia| inertia.mass))
    };
    parts.with_travels(&of_body, of_obstacle)
}

pub(crate) fn forces_at(model: &Model, displacement: &[f64], multiplier: &[f64]) -> Result<Forces, Error> {
    let (multiplier, of_ties) = model::split(model, multiplier)?;
    let displacement = model.nodal_displacement(displacement)?;
    forces(model, &displacement, &internal_force(model.body(), &displacement)?, multiplier, of_ties)
}

pub(crate) fn state(model: &Model, displacement: &[f64]) -> Result<DisplacedState, Error> {
    let nodes = model.mesh().nodes();
    let DisplacedState { stress, force, deformation } = DisplacedState::of(model.body(), displacement)?;
    let stress = stress.of_whole(model.body(), |node| model.parts.conditions.symmetry.axes_at(&nodes[node]));
    Ok(DisplacedState { stress, force, deformation })
}

/// The forces of a nodal displacement, which the forces `internal` hold.
pub(crate) fn forces(
    model: &Model,
    displacement: &[f64],
    internal: &[f64],
    multiplier: &[f64],
    of_ties: &[f64],
) -> Result<Forces, Error> {
    let contact = model.contact_forces(multiplier)?;
    let ties = model.parts.tie_forces(of_ties);
    let springs = model.parts.spring_forces(displacement);
    let mut forces = internal.to_vec();
    for acting in [model.nodal_load(), &contact, &springs, &ties] {
        forces.iter_mut().zip(acting).for_each(|(force, acting)| *force -= acting);
    }
    let mut reactions = model.dofs().supported_part(&forces)?;
    let rigid_faces = force_of_faces(model, &forces, |_| true)?;
    let motions = RigidBodyModes::of(model.body());
    let mut all = vec![model.nodal_load(), &contact, &springs, &rigid_faces, &ties];
    let own;
    if model.body().has_own_stress() {
        own = internal_force(model.body(), &vec![0.0; displacement.len()])?;
        // These forces balance each other: they are the scale of their rounding in a free body.
        all.push(&own);
        // Each body has its own scale.
        let dimension = model.body().dimension();
        for region in model.body().regions() {
            let dofs = dimension * region.nodes().start..dimension * region.nodes().end;
            let largest = own[dofs.clone()].iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
            let is_rounding = |force: &&mut f64| force.abs() <= OWN_ROUNDING * largest;
            reactions[dofs].iter_mut().filter(is_rounding).for_each(|force| *force = 0.0);
        }
    }
    all.push(&reactions);
    let balance = motions.imbalance(model.mesh().nodes(), &all);
    Ok(Forces { contact, reactions, springs, rigid_faces, ties, balance })
}
