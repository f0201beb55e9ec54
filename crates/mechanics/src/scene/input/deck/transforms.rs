//! Local axes of nodes: the cards *TRANSFORM. Supports and forces of such nodes are along these axes.

use std::collections::HashMap;

use super::rigid::RigidBodies;
use crate::error::Error;
use crate::fem::geometry::{cross, length, minus, unit};
use crate::fem::material::Cylinder;
use crate::fem::mesh::deck::{Card, Deck};

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
