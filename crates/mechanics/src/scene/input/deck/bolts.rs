//! Preloads of bolts: the cards *PRE-TENSION SECTION. Their reference nodes are points of the scene, which have the
//! tension or the shortening. Ties: the cards *TIE.

use super::bodies::side;
use super::keywords::{Entry, object};
use crate::error::Error;
use crate::fem::mesh::deck::{Card, Deck, Place};
use serde_json::json;

/// A cut through a bolt.
struct Bolt {
    /// The node whose direction 1 is the shortening.
    reference: usize,
    /// The names of the two faces in the scene.
    faces: [String; 2],
    direction: Option<[f64; 3]>,
    place: Place,
}

pub(super) struct Bolts {
    all: Vec<Bolt>,
    dimension: usize,
}

impl Bolts {
    pub fn of(deck: &Deck) -> Result<Self, Error> {
        let dimension = deck.dimension();
        let mut bolts = Bolts { all: Vec::new(), dimension };
        let cards = deck.source.cards.iter().filter(|card| card.is("PRE-TENSIONSECTION"));
        for (card, names) in cards.zip(&deck.cuts) {
            let reference = reference(deck, card).map_err(|message| deck.source.fault(card.place, message))?;
            if bolts.is_reference(reference) {
                let number = deck.nodes.numbers[reference];
                return Err(deck.source.fault(card.place, format!("node {number} is the reference of two bolts")));
            }
            let [one, other] = names.each_ref().map(|name| side(deck, name));
            let fault = |message: String| deck.source.fault(card.place, message);
            let faces = [one.map_err(fault)?.1, other.map_err(fault)?.1];
            let direction = direction(deck, card)?;
            bolts.all.push(Bolt { reference, faces, direction, place: card.place });
        }
        Ok(bolts)
    }

    /// The nodes whose direction 1 is the shortening of a bolt, with the places of their cards.
    pub fn references(&self) -> impl Iterator<Item = (usize, Place)> + '_ {
        self.all.iter().map(|bolt| (bolt.reference, bolt.place))
    }

    /// Returns `true` for a node whose direction 1 is the shortening of a bolt.
    pub fn is_reference(&self, node: usize) -> bool {
        self.all.iter().any(|bolt| bolt.reference == node)
    }

    /// The preloads of the scene.
    pub fn entries(&self, deck: &Deck) -> Vec<Entry> {
        let entry = |bolt: &Bolt| {
            let [boundary, to] = &bolt.faces;
            let point = deck.nodes.numbers[bolt.reference].to_string();
            let mut preload = json!({"boundary": boundary, "to": to, "point": point});
            if let Some(direction) = bolt.direction {
                preload["direction"] = direction[..self.dimension].into();
            }
            Entry::new(object("preload", preload), bolt.place)
        };
        self.all.iter().map(entry).collect()
    }
}

/// The node of a card, which belongs to no element.
fn reference(deck: &Deck, card: &Card) -> Result<usize, String> {
    let Some(value) = card.value("NODE") else {
        return Err("*PRE-TENSION SECTION has no reference node; write NODE=NUMBER".into());
    };
    let number = value.parse().map_err(|_| format!("NODE={value} is not the number of a node"))?;
    let node = deck.nodes.place(number).ok_or_else(|| format!("the deck has no node {number}"))?;
    match deck.body_of_node[node] {
        None => Ok(node),
        Some(_) => Err(format!("node {number} belongs to an element; the reference node of a bolt belongs to none")),
    }
}

/// The direction of a card, from the elements of its surface to those behind.
fn direction(deck: &Deck, card: &Card) -> Result<Option<[f64; 3]>, Error> {
    let Some(line) = card.lines.first() else { return Ok(None) };
    let mut fields = deck.source.fields(line);
    let mut direction = [0.0; 3];
    for (part, what) in direction.iter_mut().zip(["x", "y", "z"]) {
        *part = fields.finite_or_zero(format_args!("the {what} of the direction"))?;
    }
    fields.end()?;
    match (direction == [0.0; 3], card.lines.get(1)) {
        (false, None) => Ok(Some(direction)),
        (true, _) => Err(fields.fault("the direction of the bolt has no length")),
        (_, Some(line)) => Err(deck.source.fault(line.place, "*PRE-TENSION SECTION has one line, with the direction")),
    }
}

/// The tied surfaces of a scene.
pub(super) fn ties(deck: &Deck) -> Result<Vec<Entry>, Error> {
    let mut ties = Vec::new();
    for card in deck.source.cards.iter().filter(|card| card.is("TIE")) {
        let reach = tolerance(deck, card)?;
        for line in &card.lines {
            let mut fields = deck.source.fields(line);
            let pair = [fields.text().unwrap_or_default(), fields.text().unwrap_or_default()];
            fields.end()?;
            ties.push(surfaces(deck, &pair, reach, line.place)?);
        }
    }
    Ok(ties)
}

/// Two tied surfaces, slave and master, within a distance.
pub(super) fn surfaces(deck: &Deck, pair: &[String; 2], reach: Option<f64>, place: Place) -> Result<Entry, Error> {
    let [slave, master] = pair.each_ref().map(|name| side(deck, name));
    let fault = |message: String| deck.source.fault(place, message);
    let (slave, master) = (slave.map_err(fault)?, master.map_err(fault)?);
    let mut tied = json!({"boundary": slave.1, "to": master.1});
    if let Some(reach) = reach {
        tied["reach"] = reach.into();
    }
    Ok(Entry::new(json!({"surfaces": tied}), place))
}

/// The distance within which *TIE ties.
fn tolerance(deck: &Deck, card: &Card) -> Result<Option<f64>, Error> {
    let Some(value) = card.value("POSITIONTOLERANCE") else { return Ok(None) };
    match value.parse::<f64>() {
        Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(Some(distance)),
        _ => {
            let message = format!("POSITION TOLERANCE={value} is not read; it must be a positive distance");
            Err(deck.source.fault(card.place, message))
        }
    }
}
