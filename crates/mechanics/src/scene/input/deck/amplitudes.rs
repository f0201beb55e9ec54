//! The factors of loads at the end of the step.

use std::collections::HashMap;

use crate::error::Error;
use crate::fem::mesh::deck::{Card, Deck, key};

/// The factor of each amplitude at the end of the step, by its name.
pub(super) struct Amplitudes(HashMap<String, f64>);

impl Amplitudes {
    /// # Errors
    /// An error with the line for an amplitude without a name or without values, and for times that do not increase.
    pub fn of(deck: &Deck) -> Result<Self, Error> {
        let [end, total] = times(deck)?;
        let mut factors = HashMap::new();
        for card in deck.source.cards.iter().filter(|card| card.is("AMPLITUDE")) {
            let Some(name) = card.value("NAME") else {
                return Err(deck.source.fault(card.place, "*AMPLITUDE has no name; write NAME=NAME"));
            };
            let mut points: Vec<[f64; 2]> = Vec::new();
            for line in &card.lines {
                let mut fields = deck.source.fields(line);
                while fields.clone().text().is_some() {
                    let point = [fields.finite("a time")?, fields.finite("the factor of a time")?];
                    if points.last().is_some_and(|last| last[0] >= point[0]) {
                        return Err(fields.fault(format!("the time {} does not lie beyond the one before", point[0])));
                    }
                    points.push(point);
                }
            }
            if points.is_empty() {
                return Err(deck.source.fault(card.place, format!("the amplitude `{name}` has no values")));
            }
            let time = if card.says("TIME", "TOTALTIME") { total } else { end };
            factors.insert(key(name), at(&points, time));
        }
        Ok(Amplitudes(factors))
    }

    /// The factor of a card: 1 without an amplitude.
    ///
    /// # Errors
    /// An error with the line of the card for an amplitude that does not exist.
    pub fn factor(&self, deck: &Deck, card: &Card) -> Result<f64, Error> {
        let Some(name) = card.value("AMPLITUDE") else { return Ok(1.0) };
        let missing = || deck.source.fault(card.place, format!("there is no amplitude `{name}`"));
        self.0.get(&key(name)).copied().ok_or_else(missing)
    }
}

/// The time at the end of the step, since its start and since that of the first step: the period of a step is the second value of
/// *STATIC, 1 if it is left out.
pub(super) fn times(deck: &Deck) -> Result<[f64; 2], Error> {
    let (mut last, mut total) = (1.0, 0.0);
    for card in deck.source.cards.iter().filter(|card| card.is("STATIC")) {
        last = match card.lines.first() {
            None => 1.0,
            Some(line) => {
                let mut fields = deck.source.fields(line);
                fields.finite_or_zero("the first increment")?;
                match fields.finite_or_zero("the period of the step")? {
                    period if period < 0.0 => {
                        let message = format!("the period of the step is {period}; it must be positive");
                        return Err(fields.fault(message));
                    }
                    0.0 => 1.0,
                    period => period,
                }
            }
        };
        total += last;
    }
    Ok([last, total])
}

/// The value at a time: linear between the points, constant beyond them.
fn at(points: &[[f64; 2]], time: f64) -> f64 {
    let after = points.partition_point(|point| point[0] <= time);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(&[from, value]), Some(&[to, next])) => value + (next - value) * (time - from) / (to - from),
        (Some(point), None) | (None, Some(point)) => point[1],
        (None, None) => 1.0,
    }
}
