//! Rigid bodies: the cards *RIGID BODY, and *KINEMATIC of all displacements, with the displacements, rotations, forces
//! and moments of their reference nodes.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::bodies::{name_of_node, names_of_nodes, names_of_surface};
use super::bolts::Bolts;
use super::coupling::{Coupling, couplings};
use super::scene_text::Entry;
use crate::error::Error;
use crate::fem::mesh::deck::{Card, Deck, Place};

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
    /// # Errors
    /// An error with the line for a rigid body without a set of nodes of one body, or without a reference node of its
    /// own, and for a coupling that is not read.
    pub fn of(deck: &Deck) -> Result<Self, Error> {
        let dimension = deck.dimension();
        let (couplings, bolts) = (couplings(deck)?, Bolts::of(deck)?);
        let mut bodies = RigidBodies { all: Vec::new(), by_node: HashMap::new(), bolts, couplings, dimension };
        for card in deck.source.cards.iter().filter(|card| card.is("RIGIDBODY")) {
            bodies.add(deck, card).map_err(|message| deck.source.fault(card.place, message))?;
        }
        Ok(bodies)
    }

    fn add(&mut self, deck: &Deck, card: &Card) -> Result<(), String> {
        let Some(set) = card.value("NSET") else {
            return Err("*RIGID BODY is read with a set of nodes; write NSET=NAME".into());
        };
        let members = deck.node_sets.members(set, &deck.nodes)?;
        let mut names = names_of_nodes(deck, set, &members);
        if names.len() != 1 {
            let message = format!("`{set}` has nodes of {} bodies; a rigid body is read in one body", names.len());
            return Err(message);
        }
        let reference = |parameter: &str| match card.value(parameter) {
            None => Ok(None),
            Some(value) => {
                let number = value.parse().map_err(|_| format!("{parameter}={value} is not the number of a node"))?;
                let missing = || format!("the deck has no node {number}");
                deck.nodes.place(number).map(Some).ok_or_else(missing)
            }
        };
        let (centre, rotation) = (reference("REFNODE")?, reference("ROTNODE")?);
        let Some(centre) = centre else {
            return Err("*RIGID BODY has no reference node; write REF NODE=NUMBER".into());
        };
        let on = ("nodes", Value::from(names.remove(0)));
        self.add_body(deck, on, [Some(centre), rotation], card.place)
    }

    /// Makes a coupling a rigid body, if the nodes of its surface belong to one body and all follow in all directions;
    /// `false` for another.
    ///
    /// # Errors
    /// An error with the line for a reference node of two rigid bodies.
    pub fn takes(&mut self, deck: &Deck, coupling: &Coupling) -> Result<bool, Error> {
        let fault = |message: String| deck.source.fault(coupling.place, message);
        let surface = deck.surface_or(&coupling.surface).map_err(fault)?;
        let on = match (&names_of_surface(deck, surface)[..], &surface.bare[..]) {
            ([(_, name)], []) => ("boundary", Value::from(name.as_str())),
            (faces, [_, ..]) => {
                let nodes = deck.nodes_of_surface(surface);
                let bodies = nodes.iter().map(|&node| deck.body_of_node[node]);
                let names: Vec<String> = nodes.iter().filter_map(|&node| name_of_node(deck, node)).collect();
                let is_one =
                    faces.len() < 2 && bodies.clone().all(|body| body.is_some() && bodies.clone().next() == Some(body));
                match is_one {
                    true => ("nodes", names.into()),
                    false => return Ok(false),
                }
            }
            _ => return Ok(false),
        };
        let is_rigid = coupling.is_rigid(deck);
        if is_rigid {
            self.add_body(deck, on, [Some(coupling.reference), None], coupling.place).map_err(fault)?;
        }
        Ok(is_rigid)
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
        let is_coupled = || self.couplings.iter().any(|coupling| coupling.reference == node);
        self.by_node.contains_key(&node) || self.bolts.is_reference(node) || is_coupled()
    }

    /// The motion that a direction of a node, from 1, names; `None` for a node that is no reference.
    ///
    /// # Errors
    /// A sentence for a direction that the rigid bodies of this model do not have.
    fn motion(&mut self, node: usize, direction: usize) -> Result<Option<(&mut RigidBody, usize)>, String> {
        let Some(&(body, first)) = self.by_node.get(&node) else { return Ok(None) };
        let kind = first + direction - 1;
        let exists = kind < self.dimension || kind == 5 || (self.dimension == 3 && kind < 6);
        match exists {
            true => Ok(Some((&mut self.all[body], kind))),
            false => Err(format!("a rigid body of this model has no motion in direction {direction} of this node")),
        }
    }

    /// Prescribes a direction of a node; `false` for a node that is no reference. What a plane model does not have may
    /// be prescribed as 0.
    pub fn prescribe(&mut self, node: usize, direction: usize, value: f64) -> Result<bool, String> {
        if self.bolts.prescribe(node, direction, value)? {
            return Ok(true);
        }
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
        if self.bolts.press(node, direction, force)? {
            return Ok(true);
        }
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
