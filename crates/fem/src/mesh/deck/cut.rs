//! Cuts through bodies: the card *PRE-TENSION SECTION doubles the nodes of a surface.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::content::Deck;
use super::sets::DeckSurface;
use super::source::DeckCard;
use crate::error::Error;
use crate::geometry::sorted;
use crate::mesh::MAX_NODES;

impl Deck {
    /// Cuts a body along the surface of a card: the elements with its faces get nodes of their own, which have numbers
    /// after all others, and the elements behind the cut keep the nodes of the deck. The faces behind it are a surface
    /// as well.
    pub(super) fn cut(&mut self, card: DeckCard) -> Result<(), Error> {
        let fault = |message: String| Err(card.fault(message));
        let Some(name) = card.value("SURFACE") else {
            return fault("*PRE-TENSION SECTION is read with a surface of faces; write SURFACE=NAME".into());
        };
        let DeckSurface { name, faces, .. } = match self.surface_or(name) {
            Ok(surface) => surface.clone(),
            Err(message) => return fault(message),
        };
        if faces.is_empty() {
            return fault(format!("the surface `{name}` has no faces; name faces of elements (TYPE=ELEMENT)"));
        }
        let is_cut: HashSet<usize> = faces.iter().flat_map(|&face| self.nodes_of_face(face)).collect();
        let around: Vec<usize> = (0..self.elements.len())
            .filter(|&one| self.nodes_of(one).iter().any(|node| is_cut.contains(node)))
            .collect();
        // The faces of the elements around the cut, each with its nodes in increasing order and the one or two elements
        // that it belongs to.
        let mut sharing: HashMap<Vec<usize>, Vec<(usize, usize)>> = HashMap::new();
        let mut faces_of: HashMap<usize, Vec<Vec<usize>>> = HashMap::new();
        for &element in &around {
            for face in 0..self.element_list[element].kind.reference().faces.len() {
                let nodes = sorted(self.nodes_of_face((element, face)));
                sharing.entry(nodes.clone()).or_default().push((element, face));
                faces_of.entry(element).or_default().push(nodes);
            }
        }
        let mut behind = Vec::with_capacity(faces.len());
        let mut edge: HashSet<Vec<usize>> = HashSet::with_capacity(faces.len());
        for &(element, face) in &faces {
            let nodes = sorted(self.nodes_of_face((element, face)));
            let Some(&other) = sharing[&nodes].iter().find(|other| other.0 != element) else {
                let number = self.elements.numbers[element];
                let message = format!(
                    "face {} of element {number} in the surface `{name}` lies on the outside: a cut leads through a body",
                    face + 1
                );
                return fault(message);
            };
            behind.push(other);
            edge.insert(nodes);
        }
        // Before the cut are the elements that lead to one another without crossing it.
        let mut before: BTreeSet<usize> = faces.iter().map(|face| face.0).collect();
        let mut next: Vec<usize> = before.iter().copied().collect();
        while let Some(element) = next.pop() {
            let inner = faces_of[&element].iter().filter(|nodes| !edge.contains(*nodes));
            for &(other, _) in inner.flat_map(|nodes| &sharing[nodes]) {
                if before.insert(other) {
                    next.push(other);
                }
            }
        }
        if let Some(&(element, _)) = behind.iter().find(|face| before.contains(&face.0)) {
            let number = self.elements.numbers[element];
            let message = format!(
                "the surface `{name}` does not cut through its body: a way around it leads to element {number} on its other side"
            );
            return fault(message);
        }
        self.double(&faces, &before, card)?;
        behind.sort_unstable();
        let mut across = format!("{name}-across");
        while self.surfaces.named(&across).is_some() {
            across.push('-');
        }
        let surface = DeckSurface { name: across.clone(), place: card.place, faces: behind, bare: Vec::new() };
        self.surfaces.add(&across, surface);
        self.cuts.push([name, across]);
        Ok(())
    }

    /// Gives elements nodes of their own on some faces.
    fn double(&mut self, faces: &[(usize, usize)], elements: &BTreeSet<usize>, card: DeckCard) -> Result<(), Error> {
        let mut double_of: HashMap<usize, usize> = HashMap::new();
        let last = self.nodes.numbers.iter().copied().max().unwrap_or(0);
        for node in faces.iter().flat_map(|&face| self.nodes_of_face(face)).collect::<Vec<_>>() {
            if double_of.contains_key(&node) {
                continue;
            }
            let Some(number) = last.checked_add(double_of.len() + 1).filter(|_| self.nodes.len() < MAX_NODES) else {
                let message = format!(
                    "the nodes of a cut have no numbers after {last}, or exceed the {MAX_NODES} nodes that are allowed"
                );
                return Err(card.fault(message));
            };
            double_of.insert(node, self.nodes.len());
            self.doubled.push((node, self.nodes.len()));
            self.nodes.add(number);
            self.at.push(self.at[node]);
            self.node_places.push(card.place);
        }
        for &element in elements {
            let (start, count) = (self.element_list[element].start, self.element_list[element].of_type.nodes);
            for node in &mut self.connectivity[start..start + count] {
                *node = double_of.get(node).copied().unwrap_or(*node);
            }
        }
        Ok(())
    }
}
