//! Rigid faces of a scene: u = t + omega x (x - c) at the nodes of a boundary; each component of t and omega is
//! prescribed or an unknown.

use std::collections::BTreeMap;

use super::held::Held;
use crate::error::Error;
use crate::fem::geometry::{COORDINATES, cross, distance, dot, minus, shifted};
use crate::fem::{ElasticBody, tributary_areas};
use crate::scene::input::entry::{boundary, finite, nodes_named_once, point, vector, wrong};
use crate::scene::input::schema::{RigidFaceSpec, Scene};

/// A part of a motion below this, relative to the size of the face, is rounding.
const NO_MOTION: f64 = 1e-12;

/// The names of the motions, in their order.
pub(super) const NAMES: [&str; 6] = ["x", "y", "z", "rotation.x", "rotation.y", "rotation.z"];

/// A boundary that moves as a rigid plate.
#[derive(Clone, Debug)]
pub struct RigidFace {
    /// The nodes that move with the face.
    pub nodes: Vec<usize>,
    pub centre: [f64; 3],
    /// The largest distance of a node from the centre: a rotation is measured by the displacement at that distance.
    reach: f64,
    /// The motions of the model: displacements along x, y, z, then rotations about them.
    pub motions: Vec<Motion>,
}

/// A displacement of the centre or a rotation about it.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// 0 to 2 along x, y, z; 3 to 5 about them.
    pub kind: usize,
    /// In length, or in radians; `None` if it is an unknown.
    pub prescribed: Option<f64>,
    /// The force along the displacement, or the moment about the axis of the rotation.
    pub force: f64,
}

impl Motion {
    /// The key of the motion in a scene, as `rotation.z`.
    pub fn name(&self) -> &'static str {
        NAMES[self.kind]
    }
}

/// The rigid faces. Other prescribed components of their nodes are removed if the faces move the nodes in the same
/// way.
pub(crate) fn rigid_faces(scene: &Scene, body: &ElasticBody, held: &mut Held) -> Result<Vec<RigidFace>, Error> {
    let mut owner: BTreeMap<usize, usize> = BTreeMap::new();
    let mut faces = Vec::with_capacity(scene.rigid_faces.len());
    for (index, spec) in scene.rigid_faces.iter().enumerate() {
        let path = format!("rigid-faces[{index}]");
        let face = RigidFace::of(spec, &path, body)?;
        for &node in &face.nodes {
            if let Some(other) = owner.insert(node, index) {
                let at = point(&body.mesh().nodes()[node][..body.dimension()]);
                let message = format!(
                    "node {node} at {at} belongs to rigid-faces[{other}] too; each node may move with one face only"
                );
                return Err(wrong(format!("{path}.boundary"), message));
            }
            face.release(node, body.mesh().nodes()[node], held, &path)?;
        }
        faces.push(face);
    }
    Ok(faces)
}

impl RigidFace {
    fn of(spec: &RigidFaceSpec, path: &str, body: &ElasticBody) -> Result<Self, Error> {
        let (mesh, dimension) = (body.mesh(), body.dimension());
        let areas = match &spec.boundary {
            Some(name) if spec.nodes.is_empty() => {
                tributary_areas(body, boundary(mesh, name, &format!("{path}.boundary"))?)
            }
            None if !spec.nodes.is_empty() => {
                let nodes = nodes_named_once(mesh, &spec.nodes, &format!("{path}.nodes"))?;
                nodes.into_iter().map(|node| (node, 1.0)).collect()
            }
            _ => return Err(wrong(path, "needs either a `boundary` or `nodes`; give one of them")),
        };
        let centre = match &spec.centre {
            Some(centre) => vector(&format!("{path}.centre"), centre, dimension)?,
            None => {
                let whole: f64 = areas.iter().map(|(_, area)| area).sum();
                let mean =
                    |axis: usize| areas.iter().map(|&(node, area)| area / whole * mesh.nodes()[node][axis]).sum();
                [0, 1, 2].map(mean)
            }
        };
        let nodes: Vec<usize> = areas.into_iter().map(|(node, _)| node).collect();
        let reach = nodes.iter().map(|&node| distance(mesh.nodes()[node], centre)).fold(0.0, f64::max);
        let turns = spec.rotation.clone().unwrap_or_default();
        let given = Given {
            motions: [spec.x, spec.y, spec.z, turns.x, turns.y, turns.z],
            force: spec.force.as_deref(),
            moment: spec.moment.as_deref(),
        };
        let motions = motions(&given, path, body)?;
        Ok(RigidFace { nodes, centre, reach: if reach > 0.0 { reach } else { 1.0 }, motions })
    }

    /// The unit of a motion: one in length, or the rotation with a displacement of one at the farthest node.
    pub fn unit(&self, motion: &Motion) -> f64 {
        if motion.kind < 3 { 1.0 } else { 1.0 / self.reach }
    }

    /// The displacement of a place by a motion of one, in length or in radians.
    pub fn displacement(&self, motion: &Motion, at: [f64; 3]) -> [f64; 3] {
        let axis = COORDINATES[motion.kind % 3];
        if motion.kind < 3 { axis } else { cross(axis, minus(at, self.centre)) }
    }

    /// The displacement of a place by the prescribed motions.
    pub fn prescribed(&self, at: [f64; 3]) -> [f64; 3] {
        self.motions.iter().fold([0.0; 3], |sum, motion| {
            let by_one = self.displacement(motion, at);
            let amount = motion.prescribed.unwrap_or(0.0);
            shifted(sum, amount, by_one)
        })
    }

    /// Removes the prescribed components of a node if the face moves it in the same way.
    fn release(&self, node: usize, at: [f64; 3], held: &mut Held, path: &str) -> Result<(), Error> {
        for component in held.release(node) {
            let moves = |motion: &&Motion| {
                let along = dot(self.displacement(motion, at), component.direction) * self.unit(motion);
                motion.prescribed.is_none() && along.abs() > NO_MOTION
            };
            let given = dot(self.prescribed(at), component.direction);
            let free = self.motions.iter().find(moves);
            if free.is_none() && (given - component.value).abs() <= NO_MOTION * self.reach.max(given.abs()) {
                continue;
            }
            let by = component.by.name();
            let message = match free {
                Some(motion) => format!(
                    "node {node} at {} is held by {by}, and moves with the face; prescribe `{}` too",
                    point(&at),
                    motion.name()
                ),
                None => {
                    format!("node {node} at {} is held by {by} in another direction than the face moves it", point(&at))
                }
            };
            return Err(wrong(path, message));
        }
        Ok(())
    }
}

/// What a scene gives of the motions of a rigid face or a reference point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Given<'a> {
    /// Prescribed displacements along x, y, z and rotations about them.
    pub motions: [Option<f64>; 6],
    pub force: Option<&'a [f64]>,
    pub moment: Option<&'a [f64]>,
}

/// The motions of the model, with their prescribed values and forces.
pub(super) fn motions(given: &Given, path: &str, body: &ElasticBody) -> Result<Vec<Motion>, Error> {
    let (dimension, turns) = (body.dimension(), body.turns());
    let revolved = body.formulation().is_axisymmetric();
    let force = given.force.map(|force| vector(&format!("{path}.force"), force, dimension)).transpose()?;
    let moment = given.moment.unwrap_or_default();
    if given.moment.is_some() && moment.len() != turns.len() {
        let message = format!(
            "the array has {} entries; faces and points of this model turn about {} axes",
            moment.len(),
            turns.len()
        );
        return Err(wrong(format!("{path}.moment"), message));
    }
    let mut motions = Vec::new();
    for (kind, prescribed) in given.motions.into_iter().enumerate() {
        let field = format!("{path}.{}", NAMES[kind]);
        let turn = turns.iter().position(|&turn| 3 + turn == kind);
        if kind >= dimension && turn.is_none() {
            if prescribed.is_some() {
                return Err(wrong(field, "faces and points of this model have no such motion"));
            }
            continue;
        }
        finite(field.as_str(), prescribed.unwrap_or(0.0))?;
        let along = match turn {
            Some(place) => moment.get(place).copied().unwrap_or(0.0),
            None => force.map_or(0.0, |force| force[kind]),
        };
        finite(format!("{path}.{}", if kind < 3 { "force" } else { "moment" }), along)?;
        if prescribed.is_some() && along != 0.0 {
            return Err(wrong(field, "is prescribed, so that a force along it does nothing; give only one"));
        }
        // As a rigid body, a ring about its axis does not widen.
        let prescribed = if revolved && kind == 0 { Some(prescribed.unwrap_or(0.0)) } else { prescribed };
        motions.push(Motion { kind, prescribed, force: along });
    }
    Ok(motions)
}
