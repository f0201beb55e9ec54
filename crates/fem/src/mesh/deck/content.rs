//! The content of a deck: nodes, elements, sets, surfaces.

use std::collections::{BTreeSet, HashSet};
use std::path::Path;

use super::kinds::{DeckElementType, Space, SpringElement, SpringType, element_type, refusal};
use super::sets::{ByName, DeckSurface, FacePressure, Numbered};
use super::source::{Card, DeckCard, DeckPlace, DeckSource, key};
use crate::element::ElementKind;
use crate::error::Error;
use crate::geometry::{length, minus};
use crate::mesh::MAX_NODES;
use signorini_linear::Forest;

/// An input deck, read with the files that it includes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deck {
    pub source: DeckSource,
    /// What is read, but may not be meant: a sentence with its place.
    pub noted: Vec<(DeckPlace, String)>,
    pub nodes: Numbered,
    pub(super) at: Vec<[f64; 3]>,
    pub(super) node_places: Vec<DeckPlace>,
    pub elements: Numbered,
    pub element_list: Vec<DeckElement>,
    /// The nodes of all elements, by their places from 0.
    pub(super) connectivity: Vec<usize>,
    /// The nodes that cuts have doubled, each with its double.
    pub doubled: Vec<(usize, usize)>,
    /// The surfaces on both sides of each cut.
    pub cuts: Vec<[String; 2]>,
    pub surfaces: ByName<DeckSurface>,
    pub springs: Vec<SpringElement>,
    pub spring_numbers: Numbered,
    /// The faces that the cards *DLOAD press.
    pub pressures: Vec<FacePressure>,
    /// The lines of *DSLOAD whose faces a later step presses anew, or frees.
    pub replaced: HashSet<DeckPlace>,
    /// The step whose loads act, from 1, and the number of steps.
    pub step: usize,
    pub steps: usize,
    /// The cards of later steps.
    pub later: Vec<Card>,
    /// The body of each element and of each node, from 0; `None` for a node without elements.
    pub body_of_element: Vec<usize>,
    pub body_of_node: Vec<Option<usize>>,
    pub bodies: usize,
}

/// An element of a deck, with its type and its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeckElement {
    pub of_type: &'static DeckElementType,
    /// The element of this library for it; any for one that is left out.
    pub kind: ElementKind,
    pub place: DeckPlace,
    /// Index of the first node of the element in the connectivity of the deck.
    pub(super) start: usize,
}

impl Deck {
    /// Reads a deck up to the end of a step, from 1, or of the last one. The files that it includes must lie in the
    /// folder `within` or below it; anywhere without one.
    pub fn read(path: &Path, within: Option<&Path>, step: Option<usize>) -> Result<Self, Error> {
        let mut source = DeckSource::read(path, within)?;
        let steps = source.cards.last().map_or(0, |last| last.step);
        let mut deck = Deck {
            nodes: Numbered::new("node"),
            elements: Numbered::new("element"),
            spring_numbers: Numbered::new("element"),
            noted: std::mem::take(&mut source.noted),
            step: step.unwrap_or(steps),
            steps,
            ..Deck::default()
        };
        if step.is_some_and(|step| !(1..=steps).contains(&step)) {
            let message = format!("the deck has no step {}; its steps are 1 to {steps}", deck.step);
            return Err(source.fault(DeckPlace { file: 0, line: 1 }, message));
        }
        deck.later = source.cards.split_off(source.cards.partition_point(|card| card.step <= deck.step));
        for card in source.cards() {
            if card.is("NODE") {
                deck.read_nodes(card)?;
            } else if card.is("ELEMENT") {
                deck.read_elements(card)?;
            }
        }
        deck.replace_numbers(&source)?;
        source.cards_of("ELEMENT").try_for_each(|card| deck.read_springs(card))?;
        for card in source.cards() {
            if card.is("NSET") {
                deck.add_nodes_of_elements(card)?;
                deck.nodes.read(card)?;
            } else if card.is("ELSET") {
                // A set that begins with a spring, or with a set of them, has springs alone.
                let first = card.fields().next().and_then(|mut fields| fields.text());
                match first.is_some_and(|target| deck.spring_numbers.has(&target)) {
                    true => deck.spring_numbers.read(card)?,
                    false => deck.elements.read(card)?,
                }
            }
        }
        deck.leave_out(&source)?;
        source.cards_of("SURFACE").try_for_each(|card| deck.read_surface(card))?;
        source.cards_of("DLOAD").try_for_each(|card| deck.read_pressures(card))?;
        if deck.step > 1 {
            deck.replace_pressures(&source)?;
        }
        source.cards_of("PRE-TENSIONSECTION").try_for_each(|card| deck.cut(card))?;
        deck.find_bodies();
        deck.source = source;
        Ok(deck)
    }

    fn read_nodes(&mut self, card: DeckCard) -> Result<(), Error> {
        let mut members = Vec::with_capacity(card.lines.len());
        // The first such line is named.
        let mut again = None;
        for mut fields in card.fields() {
            let number = fields.whole("the number of a node")?;
            let at = fields.vector(format_args!("node {number}"))?;
            fields.pass_over();
            let place = match self.nodes.place(number) {
                Some(place) => place,
                None if self.nodes.len() == MAX_NODES => {
                    return Err(fields.fault(format!("the deck has more than the {MAX_NODES} nodes that are allowed")));
                }
                None => {
                    self.nodes.add(number);
                    self.at.push(at);
                    self.node_places.push(fields.place);
                    self.nodes.len() - 1
                }
            };
            let moved = length(minus(at, self.at[place]));
            if moved > 0.0 && again.is_none() {
                let message =
                    format!("node {number} is given twice, {moved:.6e} apart; the last place counts, as in CalculiX");
                again = Some((fields.place, message));
            }
            (self.at[place], self.node_places[place]) = (at, fields.place);
            members.push(place);
        }
        self.noted.extend(again);
        if let Some(set) = self.nodes.name_in(card)? {
            members.sort_unstable();
            members.dedup();
            self.nodes.extend(set, members);
        }
        Ok(())
    }

    /// Adds the nodes of a set of elements to the set of nodes that a card makes of them.
    fn add_nodes_of_elements(&mut self, card: DeckCard) -> Result<(), Error> {
        let (Some(elements), Some(name)) = (card.value("ELSET"), self.nodes.name_in(card)?) else { return Ok(()) };
        let members = card.placed(self.elements.members(elements))?;
        let nodes: BTreeSet<usize> = members.iter().flat_map(|&element| self.nodes_of(element)).copied().collect();
        self.nodes.extend(name, nodes);
        Ok(())
    }

    /// Leaves out lines and sheets that no section names and that lie on elements of more dimensions, as mesh
    /// generators write them beside a body. Their sets lose them; sets of their nodes stay.
    fn leave_out(&mut self, source: &DeckSource) -> Result<(), Error> {
        let dimension = |element: usize| self.element_list[element].of_type.dimension();
        let most = (0..self.elements.len()).map(dimension).max().unwrap_or_default();
        let mut named = vec![false; self.elements.len()];
        for card in source.cards_of("SOLIDSECTION") {
            let set = card.value("ELSET").and_then(|name| self.elements.sets.named(name));
            set.into_iter().flat_map(|set| &set.members).for_each(|&element| named[element] = true);
        }
        let is_beside = |element: usize| dimension(element) < most && !named[element];
        let mut of_body = vec![false; self.nodes.len()];
        for element in (0..self.elements.len()).filter(|&element| !is_beside(element)) {
            self.nodes_of(element).iter().for_each(|&node| of_body[node] = true);
        }
        let is_left_out =
            |element: usize| is_beside(element) && self.nodes_of(element).iter().all(|&node| of_body[node]);
        let (out, kept): (Vec<usize>, Vec<usize>) = (0..self.elements.len()).partition(|&element| is_left_out(element));
        if let Some(wrong) =
            kept.iter().map(|&element| self.element_list[element]).find(|one| one.of_type.kind().is_none())
        {
            let mut own = source.cards_of("ELEMENT").filter(|card| card.says("TYPE", wrong.of_type.name));
            let place = own.next().map_or(wrong.place, |card| card.place);
            let message = format!(
                "{}; such elements are left out if no section names them and all their nodes belong to the body",
                refusal(wrong.of_type.name)
            );
            return Err(source.fault(place, message));
        }
        let Some(&first) = out.first() else { return Ok(()) };
        let types: BTreeSet<&str> = out.iter().map(|&element| self.element_list[element].of_type.name).collect();
        let types = types.into_iter().collect::<Vec<_>>().join(", ");
        let message =
            format!("{} elements of {types} lie on the body, no section names them: they are left out", out.len());
        self.noted.push((self.element_list[first].place, message));
        let (list, connectivity) = (std::mem::take(&mut self.element_list), std::mem::take(&mut self.connectivity));
        let mut places = vec![None; list.len()];
        for (place, &element) in kept.iter().enumerate() {
            let DeckElement { start, of_type, .. } = list[element];
            places[element] = Some(place);
            self.element_list.push(DeckElement { start: self.connectivity.len(), ..list[element] });
            self.connectivity.extend(&connectivity[start..start + of_type.nodes]);
        }
        self.elements.renumber(&places);
        Ok(())
    }

    fn read_elements(&mut self, card: DeckCard) -> Result<(), Error> {
        let Some(name) = card.value("TYPE") else {
            return Err(card.fault("*ELEMENT has no type; write TYPE=C3D10 or another"));
        };
        if SpringType::named(&key(name)).is_some() {
            return Ok(());
        }
        let of_type = card.placed(element_type(&key(name)))?;
        let kind = of_type.kind().unwrap_or(ElementKind::ALL[0]);
        let first = self.elements.len();
        // An element may go on in the next lines.
        let mut open: Option<(usize, DeckPlace)> = None;
        for mut fields in card.fields() {
            let (number, place) = match open {
                Some(open) => open,
                None => {
                    let number = fields.whole("the number of an element")?;
                    if !self.elements.add(number) {
                        return Err(fields.fault(format!("element {number} is given twice")));
                    }
                    let start = self.connectivity.len();
                    self.element_list.push(DeckElement { of_type, kind, place: fields.place, start });
                    (number, fields.place)
                }
            };
            let wanted = (self.element_list.len() - first) * of_type.nodes + self.element_list[first].start;
            while self.connectivity.len() < wanted && fields.clone().next().is_some() {
                let node = fields.whole(format_args!("a node of element {number}"))?;
                self.connectivity.push(node);
            }
            fields.pass_over();
            open = (self.connectivity.len() < wanted).then_some((number, place));
        }
        if let Some((number, place)) = open {
            let found = self.connectivity.len() - self.element_list.last().map_or(0, |element| element.start);
            let message = format!("element {number} has {found} nodes, but {} has {}", of_type.name, of_type.nodes);
            return Err(card.source.fault(place, message));
        }
        if let Some(set) = self.elements.name_in(card)? {
            self.elements.extend(set, first..self.elements.len());
        }
        Ok(())
    }

    /// Reads a card *ELEMENT of springs; all nodes are read before.
    fn read_springs(&mut self, card: DeckCard) -> Result<(), Error> {
        let Some(of_type) = card.value("TYPE").and_then(|name| SpringType::named(&key(name))) else { return Ok(()) };
        let first = self.springs.len();
        for mut fields in card.fields() {
            let number = fields.whole("the number of an element")?;
            let mut nodes = Vec::with_capacity(of_type.nodes());
            for _ in 0..of_type.nodes() {
                let node = fields.whole(format_args!("a node of element {number}"))?;
                let missing = || fields.fault(format!("element {number} names node {node}, which does not exist"));
                nodes.push(self.nodes.place(node).ok_or_else(missing)?);
            }
            fields.end()?;
            if self.elements.place(number).is_some() || !self.spring_numbers.add(number) {
                return Err(fields.fault(format!("element {number} is given twice")));
            }
            self.springs.push(SpringElement { of_type, nodes, place: fields.place });
        }
        if let Some(set) = self.spring_numbers.name_in(card)? {
            self.spring_numbers.extend(set, first..self.springs.len());
        }
        Ok(())
    }

    /// Replaces the numbers of nodes in elements by their places.
    fn replace_numbers(&mut self, source: &DeckSource) -> Result<(), Error> {
        if self.elements.len() == 0 {
            let message = "the deck has no elements; a body needs at least one";
            return Err(source.fault(DeckPlace { file: 0, line: 1 }, message));
        }
        for (index, element) in self.element_list.iter().enumerate() {
            let number = self.elements.numbers[index];
            for node in &mut self.connectivity[element.start..element.start + element.of_type.nodes] {
                *node = self.nodes.place(*node).ok_or_else(|| {
                    let message = format!("element {number} names node {node}, which does not exist");
                    source.fault(element.place, message)
                })?;
            }
        }
        Ok(())
    }

    /// Finds the elements that are joined by common nodes.
    fn find_bodies(&mut self) {
        let elements = self.elements.len();
        let mut forest = Forest::new(elements);
        let mut first_at: Vec<Option<usize>> = vec![None; self.nodes.len()];
        for element in 0..elements {
            for &node in self.nodes_of(element) {
                match first_at[node] {
                    Some(first) => forest.join(first, element),
                    None => first_at[node] = Some(element),
                }
            }
        }
        let (bodies, count) = forest.into_trees();
        self.body_of_node = first_at.into_iter().map(|first| first.map(|element| bodies[element])).collect();
        (self.body_of_element, self.bodies) = (bodies, count);
    }

    /// An error at a place of the deck.
    pub fn fault(&self, place: DeckPlace, message: impl Into<String>) -> Error {
        self.source.fault(place, message)
    }

    /// Number of coordinates of the elements.
    pub fn dimension(&self) -> usize {
        self.element_list.first().map_or(3, |element| element.kind.dimension())
    }

    /// Returns `true` if the elements of the deck are those of a body of revolution.
    pub fn is_axisymmetric(&self) -> bool {
        self.element_list.first().is_some_and(|element| element.of_type.space == Space::Axisymmetric)
    }

    /// The nodes of an element, by their places.
    pub fn nodes_of(&self, element: usize) -> &[usize] {
        let DeckElement { start, of_type, .. } = self.element_list[element];
        &self.connectivity[start..start + of_type.nodes]
    }

    /// The name of a body, numbered from 0.
    pub fn body_name(body: usize) -> String {
        format!("body-{}", body + 1)
    }
}
