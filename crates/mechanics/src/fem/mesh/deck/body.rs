//! The mesh of a body: elements of groups, their nodes, their sets.

use super::card::Place;
use super::content::Deck;
use crate::error::{Error, nearly};
use crate::fem::element::{Cell, ElementKind, MAX_NODES, Rule, Tabulated};
use crate::fem::formulation::positive;
use crate::fem::mesh::{ElementGroup, Mesh, NodeNames, fail};

/// A node of a deck is outside the plane if it is farther from it than this times the size of the body: far above the
/// rounding of a mesh generator and far below the size of any cell.
const FLAT: f64 = 1e-9;

impl Deck {
    /// The mesh of the elements in the groups of these names, element sets or bodies, or, without a name, of all
    /// elements. Coordinates are multiplied by `scale`.
    ///
    /// Nodes of other elements are left out; the others keep the order of the deck. Boundaries are the surfaces, with
    /// the facets that are on the mesh; nodes have the names of their sets and their numbers.
    pub fn mesh(&self, groups: &[&str], scale: f64) -> Result<Mesh, Error> {
        positive("scale", scale)?;
        let elements = self.elements_of(groups)?;
        let kind = self.kind(&elements)?;
        let mut numbers: Vec<Option<usize>> = vec![None; self.nodes.len()];
        for &element in &elements {
            self.nodes_of(element).iter().for_each(|&node| numbers[node] = Some(0));
        }
        let mut nodes = Vec::new();
        let used = numbers.iter_mut().enumerate().filter_map(|(place, number)| Some((place, number.as_mut()?)));
        let mut places = Vec::new();
        for (place, number) in used {
            *number = nodes.len();
            nodes.push(self.at[place].map(|value| value * scale));
            places.push(place);
        }
        if kind.dimension() < 3 {
            self.flatten(&places, &mut nodes)?;
        }
        let mut connectivity = Vec::with_capacity(elements.len() * kind.nodes());
        for &element in &elements {
            connectivity.extend(self.nodes_of(element).iter().filter_map(|&node| numbers[node]));
        }
        self.check(kind, &elements, &nodes, &connectivity)?;
        let mesh = Mesh::new(nodes, kind, connectivity, Vec::new())?
            .with_groups(self.groups(&elements))
            .with_node_names(self.names(&places, &numbers))
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
            match (body, self.element_sets.named(name)) {
                (Some(body), _) => {
                    elements.extend((0..self.elements.len()).filter(|&element| self.body_of_element[element] == body));
                }
                (None, Some(set)) => elements.extend(&set.members),
                (None, None) => {
                    let sets = self.element_sets.all.iter().map(|set| set.name.clone());
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
                Err(self.source.fault(other.place, message))
            }
        }
    }

    /// Checks that the nodes lie in a plane z = const, and puts them at 0 there.
    fn flatten(&self, places: &[usize], nodes: &mut [[f64; 3]]) -> Result<(), Error> {
        let Some(&first) = nodes.first() else { return Ok(()) };
        let away = |at: &[f64; 3], axis: usize| (at[axis] - first[axis]).abs();
        let size = nodes.iter().flat_map(|at| [0, 1, 2].map(|axis| away(at, axis))).fold(0.0, f64::max);
        for (at, &place) in nodes.iter_mut().zip(places) {
            if away(at, 2) > FLAT * size {
                let (number, z) = (self.nodes.numbers[place], self.at[place][2]);
                let message = format!(
                    "node {number} has z = {z}, but the first node of the body has another; a plane body lies in z = const"
                );
                return Err(self.source.fault(self.node_places[place], message));
            }
            at[2] = 0.0;
        }
        Ok(())
    }

    /// Checks that no element of a body of the deck is inverted or without volume.
    fn check(
        &self,
        kind: ElementKind,
        elements: &[usize],
        nodes: &[[f64; 3]],
        connectivity: &[usize],
    ) -> Result<(), Error> {
        let table = Tabulated::new(kind.reference(), Rule::Straight);
        for (&element, own) in elements.iter().zip(connectivity.chunks_exact(kind.nodes())) {
            let mut coordinates = [[0.0; 3]; MAX_NODES];
            for (at, &node) in coordinates.iter_mut().zip(own) {
                *at = nodes[node];
            }
            if let Err(reason) = Cell::new(kind.reference(), &coordinates).check(&table) {
                let number = self.elements.numbers[element];
                return Err(self.source.fault(self.element_list[element].place, format!("element {number}: {reason}")));
            }
        }
        Ok(())
    }

    /// The element sets that have some of these elements, given in increasing order.
    fn groups(&self, elements: &[usize]) -> Vec<ElementGroup> {
        let own = |members: &[usize]| members.iter().filter_map(|member| elements.binary_search(member).ok()).collect();
        let groups = self.element_sets.all.iter();
        let groups = groups.map(|set| ElementGroup { name: set.name.clone(), elements: own(&set.members) });
        groups.filter(|group| !group.elements.is_empty()).collect()
    }

    /// The names of the nodes: sets and numbers.
    fn names(&self, places: &[usize], numbers: &[Option<usize>]) -> NodeNames {
        let of_set = |members: &[usize]| members.iter().filter_map(|&place| numbers[place]).collect::<Vec<usize>>();
        let sets = self.node_sets.all.iter().map(|set| (set.name.clone(), of_set(&set.members)));
        NodeNames::new(
            sets.filter(|(_, nodes)| !nodes.is_empty()),
            places.iter().map(|&place| self.nodes.numbers[place]).collect(),
        )
    }

    /// The coordinates of a node, by its place.
    pub fn place_of_node(&self, node: usize) -> [f64; 3] {
        self.at[node]
    }

    /// The place of the first element of a body, numbered from 0.
    pub fn place_of_body(&self, body: usize) -> Place {
        let first = self.body_of_element.iter().position(|&own| own == body);
        first.map_or(Place::default(), |element| self.element_list[element].place)
    }
}
