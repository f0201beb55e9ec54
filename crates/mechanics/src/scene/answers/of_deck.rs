//! Values of the nodes of a deck that are no nodes of the mesh, and displacements of all nodes by their numbers.

use std::collections::HashMap;

use super::answer::Answer;
use crate::error::Error;
use crate::fem::geometry::cross;
use crate::scene::input::deck::reference_node::{Amount, Part};
use crate::scene::input::deck::requests::Requests;
use crate::scene::models::resultants::Resultant;

impl Answer {
    /// The displacement and the force of each reference node of the deck that this is an answer to, by its number:
    /// along x, y and z, in length and in force, then the rotation about them, in radians, and the moment, in force
    /// times length. The force comes from outside: from loads, and from what holds prescribed displacements.
    ///
    /// # Errors
    /// As [`Answer::forces`].
    pub fn of_references(&self, requests: &Requests) -> Result<HashMap<usize, [[f64; 6]; 2]>, Error> {
        if requests.references.is_empty() {
            return Ok(HashMap::new());
        }
        let numbers = self.model().mesh().node_numbers().unwrap_or_default();
        let places: HashMap<usize, usize> = numbers.into_iter().zip(0..).collect();
        let resultants = self.resultants()?;
        let values = |node: usize, amounts: &[Amount; 6]| {
            let values = amounts.each_ref().map(|amount| self.amount(amount, &places, resultants));
            // Components of a node with local axes are along these.
            let Some(axes) = requests.axes.get(&node) else { return values };
            let along = |axis: usize| (0..3).map(|own| values[own] * axes[own][axis]).sum();
            [along(0), along(1), along(2), values[3], values[4], values[5]]
        };
        let of_node = requests
            .references
            .iter()
            .map(|node| (node.number, [&node.displacement, &node.force].map(|amounts| values(node.number, amounts))));
        Ok(of_node.collect())
    }

    /// The displacement of each node of the deck that this is an answer to, in length, and the rotation of its
    /// reference nodes, in radians, by their numbers: `[x, y, z, about x, about y, about z]`.
    ///
    /// # Errors
    /// As [`Answer::of_references`].
    pub fn displacements_of_deck(&self, requests: &Requests) -> Result<HashMap<usize, [f64; 6]>, Error> {
        let numbers = self.model().mesh().node_numbers().unwrap_or_default();
        let of_node = |(node, number): (usize, usize)| {
            let [x, y, z] = self.model().at_node(self.displacement(), node);
            (number, [x, y, z, 0.0, 0.0, 0.0])
        };
        let of_mesh = numbers.into_iter().enumerate().map(of_node);
        let references = self.of_references(requests)?;
        Ok(references.into_iter().map(|(number, [displacement, _])| (number, displacement)).chain(of_mesh).collect())
    }

    fn amount(&self, amount: &Amount, places: &HashMap<usize, usize>, resultants: &[Resultant]) -> f64 {
        let named = |of: String| resultants.iter().find(|one| one.of == of);
        let face = |face: usize| named(format!("rigid-faces[{face}]"));
        let tie = |tie: usize| named(format!("ties[{tie}]"));
        // The node of a bolt moves along the direction of the deck.
        let bolts = &self.model().parts.ties.shortenings;
        let sense = |tie: usize| bolts.iter().find(|bolt| bolt.tie == tie).map_or(1.0, |bolt| bolt.sense);
        let value = |part: Part| match part {
            Part::Displacement(number, axis) => {
                places.get(&number).map(|&node| self.model().at_node(self.displacement(), node)[axis])
            }
            Part::Multiplier(tie) => self.multiplier_of_tie(tie),
            Part::Motion(number, kind) => {
                let motion = face(number).and_then(|face| face.motion.as_ref());
                motion.and_then(|motion| match kind {
                    0..3 => motion.displacement.get(kind).copied(),
                    _ => motion.rotation.get(if motion.rotation.len() == 1 { 0 } else { kind - 3 }).copied(),
                })
            }
            Part::Force(number, kind, centre) => face(number).map(|face| {
                let force = [0, 1, 2].map(|axis| face.force.get(axis).copied().unwrap_or(0.0));
                let moment = match face.moment[..] {
                    [z] => [0.0, 0.0, z],
                    [x, y, z] => [x, y, z],
                    _ => return if kind < 3 { force[kind] } else { 0.0 },
                };
                if kind < 3 { force[kind] } else { moment[kind - 3] - cross(centre, force)[kind - 3] }
            }),
            Part::Shortening(number) => tie(number).and_then(|tie| Some(sense(number) * tie.shortening?)),
            Part::Tension(number) => tie(number).and_then(|tie| Some(sense(number) * tie.tension?)),
        };
        amount.parts.iter().fold(amount.constant, |sum, &(factor, part)| sum + factor * value(part).unwrap_or(0.0))
    }
}
