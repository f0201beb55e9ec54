//! The faces of the surfaces of a deck, those that pressures act on, their nodes and areas.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::f64::consts::TAU;

use super::content::Deck;
use super::sets::{DeckSurface, FacePressure, Overridden};
use super::source::{DeckCard, DeckPlace, DeckSource, cut, key};
use crate::element::{Cell, Tabulated};
use crate::error::{Error, nearly};
use crate::geometry::{length, sorted};

/// An element and its face, from 0.
type Face = (usize, usize);

/// Faces under one pressure in a card *DLOAD.
struct PressedFaces {
    value: f64,
    place: DeckPlace,
    /// A name of their surface, if they are faces of one set.
    name: Option<String>,
    faces: Vec<Face>,
}

/// More different pressures than this would need as many boundaries.
const MOST_PRESSURES: usize = 1000;

impl Deck {
    pub(super) fn read_surface(&mut self, card: DeckCard) -> Result<(), Error> {
        let Some(name) = card.value("NAME").filter(|name| !name.is_empty()) else {
            return Err(card.fault("*SURFACE has no name; write NAME=NAME"));
        };
        if self.surfaces.named(name).is_some() {
            return Err(card.fault(format!("there are two surfaces `{name}`")));
        }
        let (mut faces, mut nodes) = (Vec::new(), Vec::new());
        let of_nodes = card.says("TYPE", "NODE");
        if !of_nodes && card.value("TYPE").is_some_and(|value| key(value) != "ELEMENT") {
            let message = "a surface consists of faces (TYPE=ELEMENT) or of nodes (TYPE=NODE)";
            return Err(card.fault(message));
        }
        for mut fields in card.fields() {
            if of_nodes {
                nodes.extend(self.nodes.target(&mut fields)?.1);
                continue;
            }
            let target = fields.first()?;
            let label = fields.text().unwrap_or_default();
            fields.end()?;
            faces.extend(fields.placed(self.faces(&target, &label, 'S'))?);
        }
        if of_nodes {
            faces = self.faces_on(&nodes);
        }
        faces.sort_unstable();
        faces.dedup();
        if faces.is_empty() && nodes.is_empty() {
            return Err(card.fault(format!("the surface `{name}` is empty")));
        }
        let covered: HashSet<usize> = faces.iter().flat_map(|&face| self.nodes_of_face(face)).collect();
        nodes.retain(|node| !covered.contains(node));
        let surface = DeckSurface { name: name.into(), place: card.place, faces, bare: nodes };
        self.surfaces.add(name, surface);
        Ok(())
    }

    /// The nodes of a face, by their places.
    pub(super) fn nodes_of_face(&self, (element, face): (usize, usize)) -> impl Iterator<Item = usize> + '_ {
        let nodes = self.nodes_of(element);
        self.element_list[element].kind.reference().faces[face].iter().map(move |&local| nodes[local])
    }

    /// The faces that have only these nodes and belong to one element.
    fn faces_on(&self, nodes: &[usize]) -> Vec<(usize, usize)> {
        let mut marked = vec![false; self.nodes.len()];
        nodes.iter().for_each(|&node| marked[node] = true);
        let mut found: HashMap<Vec<usize>, Option<(usize, usize)>> = HashMap::new();
        for element in 0..self.elements.len() {
            for face in 0..self.element_list[element].kind.reference().faces.len() {
                if self.nodes_of_face((element, face)).all(|node| marked[node]) {
                    let nodes = sorted(self.nodes_of_face((element, face)));
                    found.entry(nodes).and_modify(|face| *face = None).or_insert(Some((element, face)));
                }
            }
        }
        found.into_values().flatten().collect()
    }

    /// The faces of an element, or of the elements of a set: `S1` or `P1` and so on.
    fn faces(&self, target: &str, label: &str, letter: char) -> Result<Vec<(usize, usize)>, String> {
        let elements = self.elements.members(target)?;
        if elements.is_empty() {
            return Err(format!(
                "the set `{target}` has no elements of a body; name faces of the elements of the body"
            ));
        }
        let number = key(label).strip_prefix(letter).and_then(|number| number.parse::<usize>().ok());
        let mut faces = Vec::with_capacity(elements.len());
        for element in elements {
            let count = self.element_list[element].kind.reference().faces.len();
            match number.filter(|number| (1..=count).contains(number)) {
                Some(number) => faces.push((element, number - 1)),
                None => {
                    let (name, number) = (self.element_list[element].of_type.name, self.elements.numbers[element]);
                    let shown = cut(label, 40);
                    return Err(format!(
                        "`{shown}` is no face of element {number}; {name} has {letter}1 to {letter}{count}"
                    ));
                }
            }
        }
        Ok(faces)
    }

    /// The faces of a surface on the outside of the bodies, and those that two elements share.
    pub fn outside_and_inside(&self, surface: &DeckSurface) -> (Vec<Face>, Vec<Face>) {
        let nodes: Vec<usize> = surface.faces.iter().flat_map(|&face| self.nodes_of_face(face)).collect();
        let outside: HashSet<Face> = self.faces_on(&nodes).into_iter().collect();
        surface.faces.iter().partition(|face| outside.contains(face))
    }

    /// Makes a surface of the faces of each value of a card *DLOAD. A face that occurs again is in a second surface:
    /// pressures add up.
    pub(super) fn read_pressures(&mut self, card: DeckCard) -> Result<(), Error> {
        let mut groups: Vec<PressedFaces> = Vec::new();
        for mut fields in card.fields() {
            let target = fields.first()?;
            let label = key(&fields.text().unwrap_or_default());
            if label.strip_prefix('P').is_none_or(|rest| rest.parse::<usize>().is_err()) {
                continue;
            }
            let value = fields.finite("the pressure")?;
            fields.end()?;
            let faces = fields.placed(self.faces(&target, &label, 'P'))?;
            let repeated = self.elements.repetition(&target);
            self.noted.extend(repeated.map(|message| (fields.place, message)));
            match groups.last_mut().filter(|group| group.value == value) {
                Some(group) => {
                    group.name = None;
                    group.faces.extend(faces);
                }
                None => {
                    let name = self.elements.sets.named(&target).map(|set| format!("{}-{label}", set.name));
                    groups.push(PressedFaces { value, place: fields.place, name, faces });
                }
            }
        }
        groups.into_iter().try_for_each(|group| self.add_pressed(card, group))
    }

    /// Adds the surfaces of some pressed faces.
    fn add_pressed(&mut self, card: DeckCard, group: PressedFaces) -> Result<(), Error> {
        let PressedFaces { value, place, name, mut faces } = group;
        faces.sort_unstable();
        while !faces.is_empty() {
            if self.pressures.len() >= MOST_PRESSURES {
                let message =
                    format!("the deck has more than the {MOST_PRESSURES} different pressures that are allowed");
                return Err(card.source.fault(place, message));
            }
            // The further occurrences of a face.
            let mut again = Vec::new();
            let mut last = None;
            faces.retain(|&face| {
                let is_new = last != Some(face);
                last = Some(face);
                if !is_new {
                    again.push(face);
                }
                is_new
            });
            let numbered = (self.pressures.len() + 1..).map(|number| format!("dload-{number}"));
            let mut names = name.iter().cloned().chain(numbered).filter(|name| self.surfaces.named(name).is_none());
            let surface = names.next().unwrap_or_default();
            drop(names);
            let own = std::mem::replace(&mut faces, again);
            self.surfaces.add(&surface, DeckSurface { name: surface.clone(), place, faces: own, bare: Vec::new() });
            self.pressures.push(FacePressure { card: card.place, step: card.step, surface, place, value });
        }
        Ok(())
    }

    /// Takes the faces of pressures away that a later step presses anew, or frees by OP=NEW.
    pub(super) fn replace_pressures(&mut self, source: &DeckSource) -> Result<(), Error> {
        let mut pressures = Overridden::default();
        let emptying = source.cards().filter(|card| card.is_any(&["DLOAD", "DSLOAD"]) && card.is_new());
        emptying.for_each(|card| pressures.clear(card.step));
        let of_surfaces: Vec<(usize, DeckPlace, String)> = source
            .cards_of("DSLOAD")
            .flat_map(|card| card.fields().map(move |fields| (card.step, fields)))
            .filter_map(|(step, mut fields)| Some((step, fields.place, fields.text()?)))
            .collect();
        let of_faces = self.pressures.iter().map(|one| (one.step, one.place, one.surface.clone()));
        let pressed: Vec<(usize, DeckPlace, String)> = of_faces.chain(of_surfaces).collect();
        for (step, _, name) in &pressed {
            let surface = self.surfaces.named(name).into_iter();
            surface.flat_map(|surface| &surface.faces).for_each(|&face| pressures.give(face, *step));
        }
        for (index, (step, place, name)) in pressed.iter().enumerate() {
            let Some(surface) = self.surfaces.named_mut(name) else { continue };
            let acts = |face: &Face| pressures.acts(face, *step);
            if index < self.pressures.len() {
                surface.faces.retain(acts);
                continue;
            }
            match surface.faces.iter().filter(|face| acts(face)).count() {
                0 => _ = self.replaced.insert(*place),
                count if count < surface.faces.len() => {
                    let message = format!(
                        "a later step presses a part of `{name}` anew; press the whole surface, or its parts in both steps"
                    );
                    return Err(source.fault(*place, message));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The surface of this name, or a sentence without one.
    pub fn surface_or(&self, name: &str) -> Result<&DeckSurface, String> {
        self.surfaces.named(name).ok_or_else(|| {
            let meant = nearly(name, self.surfaces.all.iter().map(|surface| surface.name.as_str()));
            format!("there is no surface `{}`{meant}", cut(name, 80))
        })
    }
}

impl Deck {
    /// The nodes of a surface, by their places, increasing.
    pub fn nodes_of_surface(&self, surface: &DeckSurface) -> Vec<usize> {
        let of_faces = surface.faces.iter().flat_map(|&face| self.nodes_of_face(face));
        of_faces.chain(surface.bare.iter().copied()).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// The nodes of faces, each with the integrals of its shape function and of that times the outward normal: an area,
    /// a length in the plane, that of the full circle in an axisymmetric model. At a corner of a quadratic face it may
    /// be zero or negative.
    pub fn areas(&self, faces: &[(usize, usize)]) -> BTreeMap<usize, (f64, [f64; 3])> {
        let mut areas: BTreeMap<usize, (f64, [f64; 3])> = BTreeMap::new();
        for &face in faces {
            let reference = self.element_list[face.0].kind.facet().reference();
            let nodes: Vec<usize> = self.nodes_of_face(face).collect();
            let cell = Cell::at(reference, |local| self.at[nodes[local]]);
            let unit = cell.unit().powi(reference.dimension as i32);
            let revolved = self.is_axisymmetric();
            let rule = if revolved { reference.quadrature_revolved } else { reference.quadrature };
            for point in &Tabulated::with_rule(reference, rule.to_vec()).points {
                let radius: f64 = nodes.iter().zip(point.shape).map(|(&node, share)| share * self.at[node][0]).sum();
                let around = if revolved { TAU * radius } else { 1.0 };
                let vector = cell.area_vector(&point.derivative).map(|part| around * part * point.weight * unit);
                for (&node, share) in nodes.iter().zip(point.shape) {
                    let (area, outward) = areas.entry(node).or_default();
                    *area += share * length(vector);
                    outward.iter_mut().zip(vector).for_each(|(sum, part)| *sum += share * part);
                }
            }
        }
        areas
    }
}
