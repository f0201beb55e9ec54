//! The mesh of a body: elements of groups, their nodes, their sets, its surfaces as boundaries.

use super::content::Deck;
use super::source::{DeckPlace, key};
use crate::element::ElementKind;
use crate::error::{Error, nearly};
use crate::formulation::positive;
use crate::mesh::file::{FileBody, Misfit, Numbers, boundary};
use crate::mesh::{Boundary, ElementGroup, Mesh, NodeNames, fail};

impl Deck {
    /// The mesh of the elements in the groups of these names, element sets or bodies, or, without a name, of all
    /// elements. Coordinates are multiplied by `scale`.
    ///
    /// Nodes of other elements are left out; the others keep the order of the deck. Boundaries are the surfaces, with
    /// the facets that are on the mesh; nodes have the names of their sets and their numbers.
    pub fn mesh(&self, groups: &[&str], scale: f64) -> Result<Mesh, Error> {
        positive("scale", scale)?;
        let elements = self.elements_of(groups)?;
        let connectivity = elements.iter().flat_map(|&element| self.nodes_of(element)).copied().collect();
        let (kind, groups) = (self.kind(&elements)?, self.groups(&elements));
        let body = FileBody { kind, places: &self.at, connectivity, groups, turns: false };
        let (mesh, numbers) = body.into_mesh(scale, |misfit| match misfit {
            Misfit::OffPlane([_, place], _) => {
                let (number, z) = (self.nodes.numbers[place], self.at[place][2]);
                let message = format!(
                    "node {number} has z = {z}, but the first node of the body has another; a plane body lies in z = const"
                );
                self.fault(self.node_places[place], message)
            }
            Misfit::Element(element, reason) => {
                let number = self.elements.numbers[elements[element]];
                self.fault(self.element_list[elements[element]].place, format!("element {number}: {reason}"))
            }
        })?;
        let mesh = mesh
            .with_node_names(self.names(&numbers))
            .with_element_numbers(elements.iter().map(|&element| self.elements.numbers[element]).collect());
        self.with_boundaries(mesh, &elements)
    }

    /// The elements of groups, each once, in the order of the deck.
    fn elements_of(&self, groups: &[&str]) -> Result<Vec<usize>, Error> {
        if groups.is_empty() {
            return Ok((0..self.elements.len()).collect());
        }
        let mut elements = Vec::new();
        for name in groups {
            let body = (0..self.bodies).find(|&body| Deck::body_name(body) == *name);
            match (body, self.elements.sets.named(name)) {
                (Some(body), _) => {
                    elements.extend((0..self.elements.len()).filter(|&element| self.body_of_element[element] == body));
                }
                (None, Some(set)) => elements.extend(&set.members),
                (None, None) => {
                    let sets = self.elements.sets.all.iter().map(|set| set.name.clone());
                    let names: Vec<String> = sets.chain((0..self.bodies).map(Deck::body_name)).collect();
                    let meant = nearly(name, names.iter().map(String::as_str));
                    return fail(format!(
                        "there is no element set or body `{name}`; there are {}{meant}",
                        names.join(", ")
                    ));
                }
            }
        }
        elements.sort_unstable();
        elements.dedup();
        match elements.is_empty() {
            true => fail("the groups have no elements; a body needs at least one".into()),
            false => Ok(elements),
        }
    }

    /// The one kind of these elements, of which there is at least one.
    fn kind(&self, elements: &[usize]) -> Result<ElementKind, Error> {
        let first = self.element_list[elements[0]];
        match elements.iter().find(|&&element| self.element_list[element].kind != first.kind) {
            None => Ok(first.kind),
            Some(&other) => {
                let other = self.element_list[other];
                let [one, two] = [first, other].map(|element| element.of_type.name);
                let message = format!("the body mixes {one} and {two}; it must have one kind of element");
                Err(self.fault(other.place, message))
            }
        }
    }

    /// The element sets that have some of these elements, given in increasing order.
    fn groups(&self, elements: &[usize]) -> Vec<ElementGroup> {
        let own = |members: &[usize]| members.iter().filter_map(|member| elements.binary_search(member).ok()).collect();
        let groups = self.elements.sets.all.iter();
        let groups = groups.map(|set| ElementGroup { name: set.name.clone(), elements: own(&set.members) });
        groups.filter(|group| !group.elements.is_empty()).collect()
    }

    /// The names of the nodes: sets and numbers.
    fn names(&self, numbers: &Numbers) -> NodeNames {
        let of_set = |members: &[usize]| members.iter().filter_map(|&place| numbers[place]).collect::<Vec<usize>>();
        let sets = self.nodes.sets.all.iter().map(|set| (set.name.clone(), of_set(&set.members)));
        let own = self.nodes.numbers.iter().zip(numbers).filter(|(_, number)| number.is_some());
        NodeNames::new(sets.filter(|(_, nodes)| !nodes.is_empty()), own.map(|(&own, _)| own).collect())
    }

    /// The coordinates of a node, by its place.
    pub fn place_of_node(&self, node: usize) -> [f64; 3] {
        self.at[node]
    }

    /// The place of the first element of a body, numbered from 0.
    pub fn place_of_body(&self, body: usize) -> DeckPlace {
        let first = self.body_of_element.iter().position(|&own| own == body);
        first.map_or(DeckPlace::default(), |element| self.element_list[element].place)
    }
}

impl Deck {
    /// Returns `true` if a line of one of these cards names a surface.
    fn is_in(&self, keywords: &[&str], surface: &str) -> bool {
        let cards = self.source.cards().filter(|card| card.is_any(keywords));
        let mut fields = cards.flat_map(|card| card.fields()).flatten();
        fields.any(|field| key(&String::from_utf8_lossy(field)) == key(surface))
    }

    /// The mesh with the surfaces that have facets on it; `elements` are its elements in the deck, increasing. Of a
    /// surface under a pressure only the faces on the outside are kept.
    pub(super) fn with_boundaries(&self, mut mesh: Mesh, elements: &[usize]) -> Result<Mesh, Error> {
        let (facet, faces) = (mesh.kind_of(0).facet(), mesh.kind_of(0).reference().faces);
        let mut boundaries = Vec::new();
        for surface in &self.surfaces.all {
            let boundary_of = |all: &[(usize, usize)]| {
                let own =
                    all.iter().filter_map(|&(element, face)| Some((elements.binary_search(&element).ok()?, face)));
                let nodes = own.flat_map(|(element, face)| faces[face].iter().map(move |&local| (element, local)));
                let connectivity: Vec<usize> = nodes.map(|(element, local)| mesh.element(element)[local]).collect();
                Boundary::new(surface.name.as_str(), facet, connectivity)
            };
            let mut found = boundary_of(&surface.faces);
            if let Some(within) = mesh.inner_facet(&found) {
                let is_pressed = self.pressures.iter().any(|pressure| pressure.surface == surface.name);
                if self.is_in(&["CONTACTPAIR", "TIE"], &surface.name) {
                    let mut own = surface.faces.iter().filter(|face| elements.binary_search(&face.0).is_ok());
                    let &(element, face) = own.nth(within).unwrap_or(&surface.faces[0]);
                    let message = format!(
                        "face {} of element {} in the surface `{}` lies within the body: two elements share it",
                        face + 1,
                        self.elements.numbers[element],
                        surface.name
                    );
                    return Err(self.fault(surface.place, message));
                } else if !is_pressed && !self.is_in(&["DSLOAD"], &surface.name) {
                    continue;
                }
                found = boundary_of(&self.outside_and_inside(surface).0);
            }
            boundaries.extend(boundary(&mesh, &surface.name, found.connectivity));
        }
        mesh.boundaries = boundaries;
        Ok(mesh)
    }
}
