//! Loads: the cards *CLOAD, *DLOAD and *DSLOAD. Loads of one step add up; those of a later step replace them.

use std::collections::BTreeMap;

use super::amplitudes::Amplitudes;
use super::bodies::{name_of_node, names_of_faces, names_of_nodes};
use super::keywords::{SceneEntry, object};
use super::references::References;
use super::transforms::Transforms;
use serde_json::{Value, json};
use signorini_fem::Error;
use signorini_fem::geometry::{dot, unit};
use signorini_fem::mesh::deck::{DataFields, Deck, DeckCard, DeckPlace, Overridden, cut, key};

/// A load on the volume: it acts on all bodies.
struct OnVolume {
    /// The step that gives it, and its elements, kind and direction: a later step replaces a load with the same.
    step: usize,
    name: (String, String, Vec<f64>),
    value: Value,
    place: DeckPlace,
    elements: Vec<bool>,
}

pub(super) struct Loads<'a, 'd> {
    deck: &'a Deck,
    /// Of a plane model; otherwise 1.
    thickness: f64,
    references: &'a mut References<'d>,
    transforms: &'a Transforms,
    /// The force that acts at each node in each direction, from 1.
    forces: Overridden<(usize, usize)>,
    loads: Vec<SceneEntry>,
    on_volume: Vec<OnVolume>,
    noted: &'a mut Vec<(DeckPlace, String)>,
}

impl<'a, 'd> Loads<'a, 'd> {
    pub fn of(
        deck: &'a Deck,
        thickness: f64,
        amplitudes: &Amplitudes,
        references: &'a mut References<'d>,
        transforms: &'a Transforms,
        noted: &'a mut Vec<(DeckPlace, String)>,
    ) -> Result<Vec<SceneEntry>, Error> {
        let forces = last_forces(deck);
        let (own, on_volume) = (Vec::new(), Vec::new());
        let mut loads = Loads { deck, thickness, references, transforms, forces, loads: own, on_volume, noted };
        for keyword in ["CLOAD", "DLOAD", "DSLOAD"] {
            // The step of the card before.
            let mut before = 0;
            for card in deck.source.cards_of(keyword) {
                if card.is_new() && before == card.step {
                    let message = format!("OP=NEW must stand on the first {} of the step", card.name);
                    return Err(card.fault(message));
                }
                if card.is_new() && keyword != "CLOAD" {
                    // All loads on bodies of the steps before go, whichever of the two cards says so.
                    loads.on_volume.retain(|load| load.step >= card.step);
                }
                before = card.step;
                let factor = amplitudes.factor(deck, card)?;
                match keyword {
                    "CLOAD" => loads.add_nodal(card, factor)?,
                    "DLOAD" => loads.add_distributed(card, factor)?,
                    _ => loads.add_on_surfaces(card, factor)?,
                }
            }
        }
        loads.end()
    }

    /// Forces on nodes: node, direction, force. A later step replaces them, node by node and direction by direction, or
    /// all by OP=NEW.
    fn add_nodal(&mut self, card: DeckCard, factor: f64) -> Result<(), Error> {
        let dimension = self.deck.dimension();
        let mut forces: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for mut fields in card.fields() {
            let (target, mut nodes) = self.deck.nodes.target(&mut fields)?;
            let repeated = self.deck.nodes.repetition(&target);
            self.noted.extend(repeated.map(|message| (fields.place, message)));
            let direction = fields.whole("the direction")?;
            let force = factor * fields.finite("the force")?;
            fields.pass_over();
            if !(1..=6).contains(&direction) {
                return Err(fields.fault(format!("{direction} is no direction; there are 1 to 6")));
            }
            let of_bodies =
                |nodes: &[usize]| nodes.iter().filter(|&&node| self.deck.body_of_node[node].is_some()).count();
            let all = of_bodies(&nodes);
            nodes.retain(|&node| self.forces.acts(&(node, direction), card.step));
            let mut on_bodies = Vec::with_capacity(nodes.len());
            for node in nodes {
                let pressed = self.references.press(node, direction, force, fields.place);
                if !pressed.map_err(|message| fields.fault(message))? {
                    on_bodies.push(node);
                }
            }
            if on_bodies.is_empty() {
                continue;
            }
            let mut is_part = on_bodies.len() < all;
            let nodes = on_bodies;
            if direction > dimension {
                let message = format!("{direction} is no direction of a force here; there are 1 to {dimension}");
                return Err(fields.fault(message));
            }
            let mut plain = Vec::with_capacity(nodes.len());
            for node in nodes {
                let axes = fields.placed(self.transforms.axes(self.deck, node))?;
                match (axes, name_of_node(self.deck, node)) {
                    (Some(axes), Some(name)) => {
                        let sum = forces.entry(name).or_insert_with(|| vec![0.0; dimension]);
                        sum.iter_mut().zip(axes[direction - 1]).for_each(|(sum, part)| *sum += force * part);
                        is_part = true;
                    }
                    _ => plain.push(node),
                }
            }
            let names = match is_part {
                true => plain.iter().filter_map(|&node| name_of_node(self.deck, node)).collect(),
                false => names_of_nodes(self.deck, &target, &plain),
            };
            for name in names {
                forces.entry(name).or_insert_with(|| vec![0.0; dimension])[direction - 1] += force;
            }
        }
        if !forces.is_empty() {
            self.loads.push(SceneEntry::new(object("nodal-forces", json!(forces)), card.place));
        }
        Ok(())
    }

    /// Pressures on faces, and loads on the volume.
    fn add_distributed(&mut self, card: DeckCard, factor: f64) -> Result<(), Error> {
        for pressure in self.deck.pressures.iter().filter(|pressure| pressure.card == card.place) {
            self.add_pressure(&pressure.surface, factor * pressure.value, pressure.place)?;
        }
        for mut fields in card.fields() {
            let target = fields.text().unwrap_or_default();
            let label = fields.text().map(|label| key(&label)).unwrap_or_default();
            let along = along(fields.clone());
            let value = match label.as_str() {
                "GRAV" => self.gravity(&mut fields, factor)?,
                "CENTRIF" => self.centrifugal(&mut fields, factor)?,
                _ if label.strip_prefix('P').is_some_and(|rest| rest.parse::<usize>().is_ok()) => continue,
                _ => {
                    let shown = cut(&label, 40);
                    let message = format!("the load `{shown}` is not read; there are P1 to P6, GRAV and CENTRIF");
                    return Err(fields.fault(message));
                }
            };
            fields.pass_over();
            let deck = self.deck;
            let name = (key(&target), label, along);
            self.on_volume.retain(|other| other.step == card.step || other.name != name);
            let members = fields.placed(deck.elements.members(&target))?;
            let mut elements = vec![false; deck.elements.len()];
            members.into_iter().for_each(|element| elements[element] = true);
            // Lines for disjoint sets are one load on all of them.
            let is_apart = |other: &[bool]| other.iter().zip(&elements).all(|(other, own)| !(*other && *own));
            match self
                .on_volume
                .iter_mut()
                .find(|other| other.step == card.step && other.value == value && is_apart(&other.elements))
            {
                Some(other) => other.elements.iter_mut().zip(elements).for_each(|(other, own)| *other |= own),
                None => self.on_volume.push(OnVolume { step: card.step, name, value, place: fields.place, elements }),
            }
        }
        Ok(())
    }

    fn gravity(&self, fields: &mut DataFields, factor: f64) -> Result<Value, Error> {
        let acceleration = factor * fields.finite("the acceleration of gravity")?;
        let direction = unit(fields.vector("the direction of gravity")?);
        if direction == [0.0; 3] {
            return Err(fields.fault("the direction of gravity has no length"));
        }
        if self.deck.dimension() == 2 && direction[2] != 0.0 {
            return Err(fields.fault("gravity must lie in the plane of a plane model"));
        }
        let vector = direction.map(|part| acceleration * part);
        Ok(object("gravity", json!(vector[..self.deck.dimension()])))
    }

    fn centrifugal(&self, fields: &mut DataFields, factor: f64) -> Result<Value, Error> {
        let square = factor * fields.finite("the square of the angular velocity")?;
        let point = fields.vector("a point on the axis")?;
        let axis = unit(fields.vector("the direction of the axis")?);
        if square < 0.0 || axis == [0.0; 3] {
            return Err(
                fields.fault("the square of the angular velocity must not be negative, and the axis needs a length")
            );
        }
        let omega = square.sqrt();
        let is_axisymmetric = self.deck.is_axisymmetric();
        match self.deck.dimension() {
            3 => Ok(object("centrifugal", json!({"omega": omega, "axis": axis, "point": point}))),
            _ if is_axisymmetric && dot(axis, [0.0, 1.0, 0.0]).abs() == 1.0 && point[0] == 0.0 && point[2] == 0.0 => {
                Ok(object("centrifugal", json!({"omega": omega})))
            }
            _ if !is_axisymmetric && dot(axis, [0.0, 0.0, 1.0]).abs() == 1.0 => {
                Ok(object("centrifugal", json!({"omega": omega, "point": point[..2]})))
            }
            _ => Err(fields.fault("a plane model turns about an axis across the plane, an axisymmetric one about y")),
        }
    }

    /// Pressures on surfaces: surface, P, pressure.
    fn add_on_surfaces(&mut self, card: DeckCard, factor: f64) -> Result<(), Error> {
        let deck = self.deck;
        for mut fields in card.fields().filter(|fields| !deck.replaced.contains(&fields.place)) {
            let surface = fields.text().unwrap_or_default();
            let label = fields.text().map(|label| key(&label)).unwrap_or_default();
            if label != "P" {
                return Err(fields.fault("only pressures, with the label P, are read as loads of surfaces"));
            }
            let value = factor * fields.finite("the pressure")?;
            fields.pass_over();
            self.deck.surface_or(&surface).map_err(|message| fields.fault(message))?;
            self.add_pressure(&surface, value, fields.place)?;
        }
        Ok(())
    }

    /// A pressure on a surface, in each body that has some of its faces.
    fn add_pressure(&mut self, surface: &str, value: f64, place: DeckPlace) -> Result<(), Error> {
        let surface = self.deck.surface_or(surface).map_err(|message| self.deck.fault(place, message))?;
        if !surface.bare.is_empty() {
            let message = format!("the surface `{}` consists of nodes, on which no pressure acts", surface.name);
            return Err(self.deck.fault(place, message));
        }
        let (outside, inside) = self.deck.outside_and_inside(surface);
        for (_, boundary) in names_of_faces(self.deck, &surface.name, &outside) {
            self.loads.push(SceneEntry::new(json!({"pressure": {"boundary": boundary, "value": value}}), place));
        }
        if inside.is_empty() {
            return Ok(());
        }
        // The boundaries of a scene are on the outside: a face within the body is pressed at its nodes.
        let forces = self.deck.areas(&inside).into_iter().filter_map(|(node, (_, outward))| {
            let force = outward[..self.deck.dimension()].iter().map(|part| -value * self.thickness * part).collect();
            Some((name_of_node(self.deck, node)?, force))
        });
        let forces: BTreeMap<String, Vec<f64>> = forces.collect();
        self.loads.push(SceneEntry::new(object("nodal-forces", json!(forces)), place));
        Ok(())
    }

    /// All loads; those on the volume must act on all elements.
    fn end(mut self) -> Result<Vec<SceneEntry>, Error> {
        for OnVolume { value, place, elements, .. } in self.on_volume {
            if let Some(element) = elements.iter().position(|is_in| !is_in) {
                let number = self.deck.elements.numbers[element];
                let message = format!(
                    "this load acts on a part of the elements, not on element {number}; a load on the volume is read for all elements only"
                );
                return Err(self.deck.fault(place, message));
            }
            self.loads.push(SceneEntry::new(value, place));
        }
        Ok(self.loads)
    }
}

/// The direction of a load on the volume, and before it its point if it has one: all numbers behind its size.
fn along(mut fields: DataFields) -> Vec<f64> {
    fields.next();
    let number = |fields: &mut DataFields| {
        fields.clone().next()?;
        Some(fields.finite_or_zero("a component").unwrap_or(0.0))
    };
    let mut all: Vec<f64> = std::iter::from_fn(|| number(&mut fields)).collect();
    let start = all.len().saturating_sub(3);
    let direction = [0, 1, 2].map(|axis| all.get(start + axis).copied().unwrap_or(0.0));
    all.truncate(start);
    all.extend(unit(direction));
    all
}

/// The forces that later steps replace.
fn last_forces(deck: &Deck) -> Overridden<(usize, usize)> {
    let mut forces = Overridden::default();
    for card in deck.source.cards_of("CLOAD") {
        if card.is_new() {
            forces.clear(card.step);
        }
        for mut fields in card.fields() {
            // A line that is wrong is refused where it is read.
            let (Ok((_, nodes)), Ok(direction)) = (deck.nodes.target(&mut fields), fields.whole("the direction"))
            else {
                continue;
            };
            nodes.into_iter().for_each(|node| forces.give((node, direction), card.step));
        }
    }
    forces
}
