//! Rigid bodies: couplings whose nodes belong to one body and follow in all displacements, with the displacements,
//! rotations, forces and moments of their reference nodes.

use std::collections::HashMap;

use super::bodies::{name_of_node, names_of_nodes, names_of_surface};
use super::contacts::Bolts;
use super::coupling::{Coupling, Joined, couplings};
use super::keywords::Entry;
use serde_json::{Value, json};
use signorini_fem::Error;
use signorini_fem::geometry::{cross, length, minus, unit};
use signorini_fem::material::Cylinder;
use signorini_fem::mesh::deck::{Card, Deck, Place};

/// The motions of a rigid body: displacements along x, y and z, then rotations about them.
const MOTIONS: [&str; 6] = ["x", "y", "z", "x", "y", "z"];

/// Nodes that move with a reference node.
struct RigidBody {
    /// `nodes` or `boundary` of the scene, with the name.
    on: (&'static str, Value),
    centre: [f64; 3],
    prescribed: [Option<f64>; 6],
    /// Force and moment.
    load: [f64; 6],
    place: Place,
}

/// The rigid bodies of a deck, by their reference nodes and the nodes of their rotations.
pub(super) struct RigidBodies {
    all: Vec<RigidBody>,
    /// The body of a node, and the first of its motions that the directions 1, 2, ... of the node name.
    by_node: HashMap<usize, (usize, usize)>,
    pub bolts: Bolts,
    /// The couplings that are no rigid bodies yet.
    pub couplings: Vec<Coupling>,
    dimension: usize,
}

impl RigidBodies {
    pub fn of(deck: &Deck) -> Result<Self, Error> {
        let dimension = deck.dimension();
        let (couplings, bolts) = (couplings(deck)?, Bolts::of(deck)?);
        Ok(RigidBodies { all: Vec::new(), by_node: HashMap::new(), bolts, couplings, dimension })
    }

    /// Makes a coupling a rigid body, if its nodes belong to one body and all follow in all directions; `false` for
    /// another.
    pub fn takes(&mut self, deck: &Deck, coupling: &Coupling) -> Result<bool, Error> {
        let fault = |message: String| deck.source.fault(coupling.place, message);
        let mut nodes = coupling.nodes(deck).map_err(fault)?;
        nodes.retain(|&node| node != coupling.reference || deck.body_of_node[node].is_some());
        let body = nodes.first().and_then(|&node| deck.body_of_node[node]);
        if body.is_none() || nodes.iter().any(|&node| deck.body_of_node[node] != body) || !coupling.is_rigid(deck) {
            return Ok(false);
        }
        let by_number = || nodes.iter().filter_map(|&node| name_of_node(deck, node)).collect::<Vec<String>>();
        let on = match &coupling.nodes {
            Joined::Surface(name) => {
                let surface = deck.surface_or(name).map_err(fault)?;
                // A boundary has the faces on the outside alone.
                match surface.bare.is_empty() && deck.outside_and_inside(surface).1.is_empty() {
                    true => ("boundary", names_of_surface(deck, surface).remove(0).1.into()),
                    false => ("nodes", by_number().into()),
                }
            }
            Joined::Nodes(set, _) if deck.node_sets.named(set).is_some() => {
                ("nodes", names_of_nodes(deck, set, &nodes).remove(0).into())
            }
            Joined::Nodes(..) => ("nodes", by_number().into()),
        };
        self.add_body(deck, on, [Some(coupling.reference), coupling.rotation], coupling.place).map_err(fault)?;
        Ok(true)
    }

    /// The reference nodes of rigid bodies, with what an answer says of them.
    pub fn reference_nodes(&self, deck: &Deck) -> Vec<ReferenceNode> {
        let of_body = |(&node, &(face, first)): (&usize, &(usize, usize))| {
            let of = Of::Face { face, first, centre: self.all[face].centre };
            ReferenceNode { number: deck.nodes.numbers[node], of }
        };
        self.by_node.iter().map(of_body).collect()
    }

    /// Returns `true` for a motion that the rigid bodies of this model have.
    fn exists(&self, kind: usize) -> bool {
        kind < self.dimension || kind == 5 || (self.dimension == 3 && kind < 6)
    }

    /// Adds a body with its reference node and the node of its rotations.
    fn add_body(
        &mut self,
        deck: &Deck,
        on: (&'static str, Value),
        [centre, rotation]: [Option<usize>; 2],
        place: Place,
    ) -> Result<(), String> {
        for (node, first) in [(centre, 0), (rotation, 3)] {
            let Some(node) = node else { continue };
            if self.bolts.is_reference(node) || self.by_node.insert(node, (self.all.len(), first)).is_some() {
                let number = deck.nodes.numbers[node];
                return Err(format!("node {number} is the reference of two rigid bodies, or of a bolt too"));
            }
        }
        let centre = centre.map_or([0.0; 3], |centre| deck.place_of_node(centre));
        self.all.push(RigidBody { on, centre, prescribed: [None; 6], load: [0.0; 6], place });
        Ok(())
    }

    /// Returns `true` for a node that moves a rigid body or a coupling.
    pub fn is_reference(&self, node: usize) -> bool {
        let is_coupled =
            || self.couplings.iter().any(|coupling| coupling.reference == node || coupling.rotation == Some(node));
        self.by_node.contains_key(&node) || self.bolts.is_reference(node) || is_coupled()
    }

    /// The motion that a direction of a node, from 1, names; `None` for a node that is no reference.
    ///
    /// # Errors
    /// A sentence for a direction that the rigid bodies of this model do not have.
    fn motion(&mut self, node: usize, direction: usize) -> Result<Option<(&mut RigidBody, usize)>, String> {
        let Some(&(body, first)) = self.by_node.get(&node) else { return Ok(None) };
        let kind = first + direction - 1;
        match self.exists(kind) {
            true => Ok(Some((&mut self.all[body], kind))),
            false => Err(format!("a rigid body of this model has no motion in direction {direction} of this node")),
        }
    }

    /// Prescribes a direction of a node; `false` for a node that is no reference. What a plane model does not have may
    /// be prescribed as 0.
    pub fn prescribe(&mut self, node: usize, direction: usize, value: f64) -> Result<bool, String> {
        match self.motion(node, direction) {
            Ok(Some((body, kind))) => body.prescribed[kind] = Some(value),
            Ok(None) => return Ok(false),
            Err(_) if value == 0.0 => {}
            Err(message) => return Err(message),
        }
        Ok(true)
    }

    /// Adds a force or a moment at a direction of a node; `false` for a node that is no reference.
    pub fn press(&mut self, node: usize, direction: usize, force: f64) -> Result<bool, String> {
        let Some((body, kind)) = self.motion(node, direction)? else { return Ok(false) };
        body.load[kind] += force;
        Ok(true)
    }

    /// The rigid faces of the scene. A force along a prescribed motion does nothing.
    pub fn entries(&self) -> Vec<Entry> {
        self.all.iter().map(|body| Entry::new(self.face(body), body.place)).collect()
    }

    fn face(&self, body: &RigidBody) -> Value {
        let mut face = json!({body.on.0: body.on.1, "centre": body.centre[..self.dimension]});
        for (kind, value) in body.prescribed.iter().enumerate() {
            let Some(value) = value else { continue };
            match kind {
                0..3 => face[MOTIONS[kind]] = (*value).into(),
                _ => face["rotation"][MOTIONS[kind]] = (*value).into(),
            }
        }
        let acting = |kind: usize| if body.prescribed[kind].is_some() { 0.0 } else { body.load[kind] };
        let turns = if self.dimension == 3 { 3..6 } else { 5..6 };
        let loads: [(&str, Vec<f64>); 2] =
            [("force", (0..self.dimension).map(acting).collect()), ("moment", turns.map(acting).collect())];
        for (name, parts) in loads {
            if parts.iter().any(|&part| part != 0.0) {
                face[name] = parts.into();
            }
        }
        face
    }
}

/// Sines below this are rounding of written coordinates: two vectors along one line.
const ALONG: f64 = 1e-9;

/// How the axes of a node are found.
enum Transform {
    /// The same axes at all nodes.
    Rectangular([[f64; 3]; 3]),
    Cylindrical(Cylinder),
}

/// The local axes of the nodes of a deck.
pub(super) struct Transforms {
    all: Vec<Transform>,
    of_node: HashMap<usize, usize>,
}

impl Transforms {
    pub fn of(deck: &Deck, rigid_bodies: &RigidBodies) -> Result<Self, Error> {
        let mut transforms = Transforms { all: Vec::new(), of_node: HashMap::new() };
        for card in deck.source.cards.iter().filter(|card| card.is("TRANSFORM")) {
            let fault = |message: String| deck.source.fault(card.place, message);
            let name = card.value("NSET").ok_or_else(|| fault("*TRANSFORM names no set; write NSET=NAME".into()))?;
            let nodes = deck.node_sets.members(name, &deck.nodes).map_err(fault)?;
            if let Some(&reference) = nodes.iter().find(|&&node| rigid_bodies.is_reference(node)) {
                let number = deck.nodes.numbers[reference];
                return Err(fault(format!(
                    "node {number} is the reference of a rigid body, a coupling or a bolt, which is read along x, y and z"
                )));
            }
            let transform = transform(deck, card)?;
            nodes.into_iter().for_each(|node| _ = transforms.of_node.insert(node, transforms.all.len()));
            transforms.all.push(transform);
        }
        Ok(transforms)
    }

    /// The local axes of all nodes that have some, by their numbers.
    pub fn by_number(&self, deck: &Deck) -> HashMap<usize, [[f64; 3]; 3]> {
        let axes = |&node: &usize| Some((deck.nodes.numbers[node], self.axes(deck, node).ok()??));
        self.of_node.keys().filter_map(axes).collect()
    }

    /// The local axes of a node, each of unit length; `None` without a transform.
    ///
    /// # Errors
    /// A sentence for a node on the axis of a cylinder.
    pub fn axes(&self, deck: &Deck, node: usize) -> Result<Option<[[f64; 3]; 3]>, String> {
        let Some(&number) = self.of_node.get(&node) else { return Ok(None) };
        match &self.all[number] {
            Transform::Rectangular(axes) => Ok(Some(*axes)),
            Transform::Cylindrical(line) => line.axes(deck.place_of_node(node)).map(Some).ok_or_else(|| {
                let number = deck.nodes.numbers[node];
                format!("node {number} lies on the axis of its *TRANSFORM, where no direction leads away from it")
            }),
        }
    }
}

fn transform(deck: &Deck, card: &Card) -> Result<Transform, Error> {
    let fault = |message: String| Err(deck.source.fault(card.place, message));
    let [line] = &card.lines[..] else { return fault("*TRANSFORM has one line, with six numbers".into()) };
    let mut fields = deck.source.fields(line);
    let mut given = [[0.0; 3]; 2];
    for (part, what) in given.as_flattened_mut().iter_mut().zip(["Xa", "Ya", "Za", "Xb", "Yb", "Zb"]) {
        *part = fields.finite_or_zero(what)?;
    }
    fields.end()?;
    let [a, b] = given;
    match card.value("TYPE").unwrap_or("R") {
        "R" | "r" => {
            let third = cross(unit(a), unit(b));
            if length(third) <= ALONG {
                return fault("the two vectors give no axes: they must have a length and different directions".into());
            }
            let (first, third) = (unit(a), unit(third));
            Ok(Transform::Rectangular([first, cross(third, first), third]))
        }
        "C" | "c" => match Cylinder::new(a, minus(b, a)) {
            Some(line) => Ok(Transform::Cylindrical(line)),
            None => fault("the two points of the axis are one".into()),
        },
        other => fault(format!("TYPE={other} is not read; there are R and C")),
    }
}

/// The displacement along x, y, z, in length, and the rotation about them, in radians, of nodes, by their numbers.
pub type Displacements = HashMap<usize, [f64; 6]>;

/// A reference node that is no reference point of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceNode {
    pub number: usize,
    pub of: Of,
}

/// The entry of the scene that a reference node moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Of {
    /// A rigid face about a centre. The directions of the node name its motions from this one: 0 for displacements, 3
    /// for rotations.
    Face { face: usize, first: usize, centre: [f64; 3] },
    /// The rotations of the reference point of this number.
    Turns { point: usize },
}
