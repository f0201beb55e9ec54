//! Temperatures of a deck: those of the step above those at the start.

use super::amplitudes::Amplitudes;
use crate::error::Error;
use crate::fem::mesh::deck::{Card, Deck, Place, key};

/// The difference of temperature of each node of the deck.
pub(super) struct Temperatures {
    differences: Vec<f64>,
    /// The temperature of each node at the end of the step.
    pub end: Vec<f64>,
    /// The last line with a temperature; without one all differences are zero.
    last: Option<Place>,
}

impl Temperatures {
    pub fn of(deck: &Deck, amplitudes: &Amplitudes) -> Result<Self, Error> {
        let mut start = vec![0.0; deck.nodes.len()];
        for card in deck.source.cards.iter().filter(|card| card.is("INITIALCONDITIONS")) {
            if card.value("TYPE").map(key).as_deref() != Some("TEMPERATURE") {
                let message = "only *INITIAL CONDITIONS with TYPE=TEMPERATURE is read; in a scene an `initial-stress` may be given";
                return Err(deck.source.fault(card.place, message));
            }
            set(deck, card, 1.0, &mut start)?;
        }
        let (mut end, mut last) = (start.clone(), None);
        for card in deck.source.cards.iter().filter(|card| card.is("TEMPERATURE")) {
            if card.is_new() {
                end.clone_from(&start);
            }
            set(deck, card, amplitudes.factor(deck, card)?, &mut end)?;
            last = card.lines.last().map(|line| line.place).or(last);
        }
        let differences = end.iter().zip(&start).map(|(end, start)| end - start).collect();
        Ok(Temperatures { differences, end, last })
    }

    /// The one difference of a body, with the line that gives it; `None` if it is zero.
    pub fn of_body(&self, deck: &Deck, body: usize) -> Result<Option<(f64, Place)>, Error> {
        let Some(place) = self.last else { return Ok(None) };
        let mut own = (0..deck.nodes.len()).filter(|&node| deck.body_of_node[node] == Some(body));
        let Some(first) = own.next() else { return Ok(None) };
        let value = self.differences[first];
        match own.find(|&node| self.differences[node] != value) {
            None => Ok((value != 0.0).then_some((value, place))),
            Some(other) => {
                let [one, two] = [first, other].map(|node| deck.nodes.numbers[node]);
                let message = format!(
                    "nodes {one} and {two} of one body differ by {value} and {} from their temperature at the start; a temperature that \
                     changes within a body is not read: in a scene it may have a `gradient`",
                    self.differences[other]
                );
                Err(deck.source.fault(place, message))
            }
        }
    }
}

/// Sets the temperatures that a card gives.
fn set(deck: &Deck, card: &Card, factor: f64, temperatures: &mut [f64]) -> Result<(), Error> {
    for line in &card.lines {
        let mut fields = deck.source.fields(line);
        let target = fields.text().ok_or_else(|| fields.fault("a set or a number must begin this line"))?;
        let value = factor * fields.finite("the temperature")?;
        fields.end()?;
        let nodes = deck.node_sets.members(&target, &deck.nodes).map_err(|message| fields.fault(message))?;
        nodes.into_iter().for_each(|node| temperatures[node] = value);
    }
    deck.doubled.iter().for_each(|&(node, double)| temperatures[double] = temperatures[node]);
    Ok(())
}
