//! Ties: the cards *TIE.

use serde_json::json;

use super::bodies::side;
use super::scene_text::Entry;
use crate::error::Error;
use crate::fem::mesh::deck::{Card, Deck, Place};

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
