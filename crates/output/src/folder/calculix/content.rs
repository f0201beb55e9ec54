//! What the files have in common: the numbers of the deck, and values in the order of the mesh.

use std::collections::HashMap;

use signorini_mechanics::Error;
use signorini_mechanics::fem::{self, Formulation};
use signorini_mechanics::scene::{Answer, ContactRow, Requests};

/// CalculiX computes a wedge of two degrees of a body of revolution, and prints its forces and volumes in tables.
const WEDGES: f64 = 180.0;

/// An answer to a deck, and what the deck asks for.
pub(super) struct Content<'a> {
    pub answer: &'a Answer,
    pub requests: &'a Requests,
    /// The number in the deck of each node of the mesh.
    pub numbers: Vec<usize>,
    /// The number in the deck of each node, and its place in the mesh, by increasing number.
    pub nodes: Vec<(usize, usize)>,
    /// The same of each element.
    pub elements: Vec<(usize, usize)>,
    /// The displacement and the force of each node that moves or is moved, but is no node of the mesh, by its number.
    pub references: HashMap<usize, [[f64; 6]; 2]>,
}

impl<'a> Content<'a> {
    pub fn new(answer: &'a Answer, requests: &'a Requests) -> Result<Self, Error> {
        let mesh = answer.model().mesh();
        let (Some(numbers), Some(elements)) = (mesh.node_numbers(), mesh.element_numbers()) else {
            let message = "the nodes and elements have no numbers: the mesh does not come from a deck of CalculiX";
            return fem::mesh::fail(message.into());
        };
        let (nodes, elements) = (increasing(&numbers), increasing(elements));
        let references = answer.of_references(requests)?;
        Ok(Content { answer, requests, numbers, nodes, elements, references })
    }

    /// The displacement of each node of the mesh, in length, zero beyond the dimension.
    pub fn displacements(&self) -> Vec<[f64; 3]> {
        self.in_space(self.answer.displacement())
    }

    /// The force on each node of the mesh except from contacts: loads, reactions, ties and rigid bodies.
    pub fn forces(&self) -> Result<Vec<[f64; 3]>, Error> {
        let forces = self.answer.forces()?;
        let mut sum = self.answer.model().nodal_load().to_vec();
        for part in [&forces.reactions, &forces.ties, &forces.rigid_faces] {
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        Ok(self.in_space(&sum))
    }

    /// Nodal values with three components each.
    fn in_space(&self, nodal: &[f64]) -> Vec<[f64; 3]> {
        let dimension = self.answer.model().mesh().dimension();
        let in_space = |own: &[f64]| [0, 1, 2].map(|axis| own.get(axis).copied().unwrap_or(0.0));
        nodal.chunks_exact(dimension).map(in_space).collect()
    }

    /// Each contact row with its remaining gap (length) and its pressure (force per area).
    pub fn contacts(&self) -> impl Iterator<Item = (&ContactRow, f64, f64)> {
        let gaps = self.answer.remaining_gaps();
        let pressures = self.answer.pressure().iter().copied();
        self.answer.model().rows().iter().zip(gaps).zip(pressures).map(|((row, gap), pressure)| (row, gap, pressure))
    }

    /// The temperature of each node of the mesh.
    pub fn temperatures(&self) -> Vec<[f64; 1]> {
        let mut values = vec![[0.0]; self.nodes.len()];
        for &(number, temperature) in &self.requests.temperatures {
            if let Some(node) = self.node(number) {
                values[node] = [temperature];
            }
        }
        values
    }

    /// The place of a node in the mesh.
    pub fn node(&self, number: usize) -> Option<usize> {
        let place = self.nodes.binary_search_by_key(&number, |node| node.0).ok()?;
        Some(self.nodes[place].1)
    }

    /// The values of a node of the deck among those of all nodes of the mesh, or those of a reference node. Nothing
    /// moves or loads another node without elements.
    pub fn of_node<const N: usize>(
        &self,
        number: usize,
        of_mesh: &[[f64; N]],
        of_reference: impl Fn(&[[f64; 6]; 2]) -> [f64; N],
    ) -> [f64; N] {
        let reference = || self.references.get(&number).map(&of_reference);
        self.node(number).map(|node| of_mesh[node]).or_else(reference).unwrap_or([0.0; N])
    }

    /// The share of forces and volumes in tables: that of a wedge of a body of revolution.
    pub fn share(&self) -> f64 {
        if *self.answer.model().body().formulation() == Formulation::Axisymmetric { 1.0 / WEDGES } else { 1.0 }
    }
}

/// Numbers with their places, by increasing number.
fn increasing(numbers: &[usize]) -> Vec<(usize, usize)> {
    let mut all: Vec<(usize, usize)> = numbers.iter().copied().zip(0..).collect();
    all.sort_unstable();
    all
}
