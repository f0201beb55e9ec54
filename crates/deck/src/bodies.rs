//! The bodies of a deck, and the names of their nodes and surfaces in the scene.

use std::collections::BTreeSet;

use super::amplitudes::Temperatures;
use super::keywords::{SceneEntry, object};
use super::materials::{Section, Sections};
use serde_json::{Value, json};
use signorini_fem::Error;
use signorini_fem::mesh::deck::{Deck, DeckPlace, DeckSurface};

/// The name of a node set or a surface of a body: in a further body it begins with the name of the body.
fn name_in(body: usize, name: &str) -> String {
    if body == 0 { name.to_string() } else { format!("{}.{name}", Deck::body_name(body)) }
}

/// The names of the nodes of a set, or of the node of a number, in each body that has some of them.
pub(super) fn names_of_nodes(deck: &Deck, target: &str, nodes: &[usize]) -> Vec<String> {
    let name = match target.parse::<usize>() {
        Ok(number) => number.to_string(),
        Err(_) => deck.nodes.sets.named(target).map_or(target, |set| &set.name).to_string(),
    };
    let bodies: BTreeSet<usize> = nodes.iter().filter_map(|&node| deck.body_of_node[node]).collect();
    bodies.into_iter().map(|body| name_in(body, &name)).collect()
}

/// The name of a node, by its place; `None` for a node without elements.
pub(super) fn name_of_node(deck: &Deck, node: usize) -> Option<String> {
    deck.body_of_node[node].map(|body| name_in(body, &deck.nodes.numbers[node].to_string()))
}

/// The names of a surface in each body that has some of its faces, with the bodies.
pub(super) fn names_of_surface(deck: &Deck, surface: &DeckSurface) -> Vec<(usize, String)> {
    names_of_faces(deck, &surface.name, &surface.faces)
}

/// The names of a surface in each body that has some of these faces of it, with the bodies.
pub(super) fn names_of_faces(deck: &Deck, surface: &str, faces: &[(usize, usize)]) -> Vec<(usize, String)> {
    let bodies: BTreeSet<usize> = faces.iter().map(|&(element, _)| deck.body_of_element[element]).collect();
    bodies.into_iter().map(|body| (body, name_in(body, surface))).collect()
}

/// The body of a surface and its name in the scene.
///
/// # Errors
/// A sentence if it does not exist, consists of nodes that are no faces, or has faces of several bodies.
pub(super) fn side(deck: &Deck, name: &str) -> Result<(usize, String), String> {
    let surface = deck.surface_or(name)?;
    if let Some(&node) = surface.bare.first() {
        let number = deck.nodes.numbers[node];
        return Err(format!(
            "node {number} of the surface `{}` is on no face that has only nodes of it; name faces (TYPE=ELEMENT), or the nodes of \
             whole faces",
            surface.name
        ));
    }
    match &names_of_surface(deck, surface)[..] {
        [(body, name)] => Ok((*body, name.clone())),
        several => {
            let has = |face: &String| {
                let of_face = deck.surface_or(face).map_or_else(|_| Vec::new(), |face| names_of_surface(deck, face));
                of_face.iter().all(|(body, _)| several.iter().any(|one| one.0 == *body))
            };
            let why = match deck.cuts.iter().find(|cut| cut.iter().all(has)) {
                Some([cut, _]) => format!(", because *PRE-TENSION SECTION cuts their body at `{cut}`"),
                None => String::new(),
            };
            let message = format!("has faces of several bodies{why}; name a surface of each body");
            Err(format!("the surface `{}` {message}, of which there are {}", surface.name, several.len()))
        }
    }
}

/// A body of the scene: its keys, each with the place in the deck that it comes from.
pub(super) struct Body {
    pub name: String,
    pub place: DeckPlace,
    pub body: Value,
    pub material: Option<SceneEntry>,
    pub materials: Vec<SceneEntry>,
    pub temperature: Option<SceneEntry>,
}

impl Body {
    /// Body number `index` of a deck that the scene calls `named`.
    pub fn of(
        deck: &Deck,
        index: usize,
        named: &str,
        sections: &Sections,
        temperatures: &Temperatures,
    ) -> Result<Self, Error> {
        let name = Deck::body_name(index);
        let mut body = json!({"deck": {"file": named}});
        if deck.bodies > 1 {
            body["deck"]["group"] = name.as_str().into();
        }
        if deck.step < deck.steps {
            body["deck"]["step"] = deck.step.into();
        }
        let temperature = temperatures.of_body(deck, index)?;
        let mut is_used = vec![false; sections.all.len()];
        let own = (0..deck.elements.len()).filter(|&element| deck.body_of_element[element] == index);
        own.for_each(|element| is_used[sections.of_element[element]] = true);
        let used = || sections.all.iter().zip(&is_used).filter(|(_, used)| **used).map(|(section, _)| section);
        // A material without expansion does not feel a temperature.
        let warms = temperature.is_some() && used().any(|section| section.expands);
        let material = |section: &Section| {
            let mut material = section.material.clone();
            if warms && !section.expands {
                match material.get_mut("orthotropic") {
                    Some(orthotropic) => orthotropic["expansion"] = vec![0.0; 3].into(),
                    None => material["expansion"] = 0.0.into(),
                }
            }
            material
        };
        let first = used().next();
        let is_one = first.is_some_and(|first| used().all(|section| material(section) == material(first)));
        let materials = used().filter(|_| !is_one).map(|section| {
            SceneEntry::new(json!({"group": section.group, "material": material(section)}), section.place)
        });
        Ok(Body {
            place: deck.place_of_body(index),
            name,
            body,
            materials: materials.collect(),
            material: first.filter(|_| is_one).map(|section| SceneEntry::new(material(section), section.place)),
            temperature: temperature
                .filter(|_| warms)
                .map(|(value, place)| SceneEntry::new(object("value", value.into()), place)),
        })
    }

    /// The body as an entry of `further-bodies`, with the places of its keys.
    pub fn further(&self) -> (SceneEntry, Vec<(&'static str, DeckPlace)>) {
        let mut value = json!({"name": self.name, "body": self.body});
        let mut places = Vec::new();
        if let Some(material) = &self.material {
            value["material"] = material.value.clone();
            places.push(("material", material.place));
        }
        if let Some(first) = self.materials.first() {
            value["materials"] = self.materials.iter().map(|entry| entry.value.clone()).collect::<Vec<_>>().into();
            places.push(("materials", first.place));
        }
        if let Some(temperature) = &self.temperature {
            value["temperature"] = json!([temperature.value]);
            places.push(("temperature", temperature.place));
        }
        (SceneEntry::new(value, self.place), places)
    }
}
