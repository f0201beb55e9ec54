//! Local axes of nodes: the cards *TRANSFORM.

use std::collections::HashMap;

use super::contacts::Bolt;
use super::coupling::Coupling;
use super::materials::two_points;
use signorini_fem::Error;
use signorini_fem::geometry::{cross, length, minus, unit};
use signorini_fem::material::Cylinder;
use signorini_fem::mesh::deck::{Deck, DeckCard};

/// Sines below this are rounding of written coordinates: two vectors along one line.
const ALONG: f64 = 1e-9;

/// The local axes of a node, each of unit length.
pub(super) type Axes = [[f64; 3]; 3];

/// How the axes of a node are found.
enum Transform {
    /// The same axes at all nodes.
    Rectangular(Axes),
    Cylindrical(Cylinder),
}

/// The local axes of the nodes of a deck.
pub(super) struct Transforms {
    all: Vec<Transform>,
    of_node: HashMap<usize, usize>,
}

impl Transforms {
    /// The transforms of nodes that are no references of couplings and bolts.
    pub fn of(deck: &Deck, couplings: &[Coupling], bolts: &[Bolt]) -> Result<Self, Error> {
        let references = couplings.iter().flat_map(Coupling::references).chain(bolts.iter().map(|bolt| bolt.reference));
        let references: Vec<usize> = references.collect();
        let mut transforms = Transforms { all: Vec::new(), of_node: HashMap::new() };
        for card in deck.source.cards_of("TRANSFORM") {
            let name = card.value("NSET").ok_or_else(|| card.fault("*TRANSFORM names no set; write NSET=NAME"))?;
            let nodes = card.placed(deck.nodes.members(name))?;
            if let Some(&reference) = nodes.iter().find(|node| references.contains(node)) {
                let number = deck.nodes.numbers[reference];
                return Err(card.fault(format!(
                    "node {number} is the reference of a rigid body, a coupling or a bolt, which is read along x, y and z"
                )));
            }
            let transform = transform(card)?;
            nodes.into_iter().for_each(|node| _ = transforms.of_node.insert(node, transforms.all.len()));
            transforms.all.push(transform);
        }
        Ok(transforms)
    }

    /// The local axes of all nodes that have some, by their numbers.
    pub fn by_number(&self, deck: &Deck) -> HashMap<usize, Axes> {
        let axes = |&node: &usize| Some((deck.nodes.numbers[node], self.axes(deck, node).ok()??));
        self.of_node.keys().filter_map(axes).collect()
    }

    /// The local axes of a node, each of unit length; `None` without a transform.
    ///
    /// # Errors
    /// A sentence for a node on the axis of a cylinder.
    pub fn axes(&self, deck: &Deck, node: usize) -> Result<Option<Axes>, String> {
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

fn transform(card: DeckCard) -> Result<Transform, Error> {
    let fault = |message: &str| Err(card.fault(message));
    let mut lines = card.fields();
    let (Some(fields), None) = (lines.next(), lines.next()) else {
        return fault("*TRANSFORM has one line, with six numbers");
    };
    let [a, b] = two_points(fields)?;
    match card.value("TYPE").unwrap_or("R") {
        "R" | "r" => {
            let third = cross(unit(a), unit(b));
            if length(third) <= ALONG {
                return fault("the two vectors give no axes: they must have a length and different directions");
            }
            let (first, third) = (unit(a), unit(third));
            Ok(Transform::Rectangular([first, cross(third, first), third]))
        }
        "C" | "c" => match Cylinder::new(a, minus(b, a)) {
            Some(line) => Ok(Transform::Cylindrical(line)),
            None => fault("the two points of the axis are one"),
        },
        other => fault(&format!("TYPE={other} is not read; there are R and C")),
    }
}

/// The displacement along x, y, z, in length, and the rotation about them, in radians, of nodes, by their numbers.
pub type Displacements = HashMap<usize, [f64; 6]>;
