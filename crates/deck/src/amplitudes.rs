//! The factors of loads at the end of a step, and the temperatures of a deck.

use std::collections::HashMap;

use signorini_fem::Error;
use signorini_fem::geometry::between;
use signorini_fem::mesh::deck::{Deck, DeckCard, DeckPlace, key};

/// An amplitude: its points, each a time with a factor, and whether the times count from the start of the first step.
struct Amplitude {
    points: Vec<(f64, f64)>,
    is_total: bool,
}

/// The amplitudes by their names, and the periods of the steps.
pub(super) struct Amplitudes {
    all: HashMap<String, Amplitude>,
    periods: Vec<f64>,
}

impl Amplitudes {
    pub fn of(deck: &Deck) -> Result<Self, Error> {
        let periods = periods(deck)?;
        let mut all = HashMap::new();
        for card in deck.source.cards_of("AMPLITUDE") {
            let name = card.named()?;
            let mut points: Vec<(f64, f64)> = Vec::new();
            for mut fields in card.fields() {
                while fields.clone().text().is_some() {
                    let point = (fields.finite("a time")?, fields.finite("the factor of a time")?);
                    if points.last().is_some_and(|last| last.0 >= point.0) {
                        return Err(fields.fault(format!("the time {} does not lie beyond the one before", point.0)));
                    }
                    points.push(point);
                }
            }
            if points.is_empty() {
                return Err(card.fault(format!("the amplitude `{name}` has no values")));
            }
            all.insert(key(name), Amplitude { points, is_total: card.says("TIME", "TOTALTIME") });
        }
        Ok(Amplitudes { all, periods })
    }

    /// The factor of a card: 1 without an amplitude. In a later step a load keeps the factor of the end of its own
    /// step, unless the times of the amplitude go on; temperatures follow the last step.
    pub fn factor(&self, deck: &Deck, card: DeckCard) -> Result<f64, Error> {
        let Some(name) = card.value("AMPLITUDE") else { return Ok(1.0) };
        let missing = || card.fault(format!("there is no amplitude `{name}`"));
        let amplitude = self.all.get(&key(name)).ok_or_else(missing)?;
        let step = if card.is("TEMPERATURE") { deck.step } else { card.step };
        let time = match amplitude.is_total {
            true => self.periods.iter().sum(),
            false => step.checked_sub(1).and_then(|step| self.periods.get(step)).copied().unwrap_or(1.0),
        };
        Ok(between(&amplitude.points, time))
    }
}

/// The time that each step takes, up to the last one that counts: the second value of *STATIC, 1 if it is left out.
pub(super) fn periods(deck: &Deck) -> Result<Vec<f64>, Error> {
    let mut periods = vec![1.0; deck.step];
    for card in deck.source.cards_of("STATIC") {
        let Some(mut fields) = card.fields().next() else { continue };
        fields.finite_or_zero("the first increment")?;
        let period = fields.finite_or_zero("the period of the step")?;
        if period < 0.0 {
            return Err(fields.fault(format!("the period of the step is {period}; it must be positive")));
        }
        if let Some(own) = card.step.checked_sub(1).and_then(|step| periods.get_mut(step)).filter(|_| period > 0.0) {
            *own = period;
        }
    }
    Ok(periods)
}

/// The difference of temperature of each node of the deck.
pub(super) struct Temperatures {
    differences: Vec<f64>,
    /// The temperature of each node at the end of the step.
    pub end: Vec<f64>,
    /// The last line with a temperature; without one all differences are zero.
    last: Option<DeckPlace>,
}

impl Temperatures {
    pub fn of(deck: &Deck, amplitudes: &Amplitudes) -> Result<Self, Error> {
        let mut start = vec![0.0; deck.nodes.len()];
        for card in deck.source.cards_of("INITIALCONDITIONS") {
            if card.value("TYPE").map(key).as_deref() != Some("TEMPERATURE") {
                let message = "only *INITIAL CONDITIONS with TYPE=TEMPERATURE is read; in a scene an `initial-stress` may be given";
                return Err(card.fault(message));
            }
            set(deck, card, 1.0, &mut start)?;
        }
        let (mut end, mut last) = (start.clone(), None);
        for card in deck.source.cards_of("TEMPERATURE") {
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
    pub fn of_body(&self, deck: &Deck, body: usize) -> Result<Option<(f64, DeckPlace)>, Error> {
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
                Err(deck.fault(place, message))
            }
        }
    }
}

/// Sets the temperatures that a card gives.
fn set(deck: &Deck, card: DeckCard, factor: f64, temperatures: &mut [f64]) -> Result<(), Error> {
    for mut fields in card.fields() {
        let target = fields.first()?;
        let value = factor * fields.finite("the temperature")?;
        fields.end()?;
        let nodes = fields.placed(deck.nodes.members(&target))?;
        nodes.into_iter().for_each(|node| temperatures[node] = value);
    }
    deck.doubled.iter().for_each(|&(node, double)| temperatures[double] = temperatures[node]);
    Ok(())
}
