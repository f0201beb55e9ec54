//! Ties: the cards *TIE and *EQUATION.

use serde_json::{Value, json};

use super::bodies::{name_of_node, side};
use super::scene_text::Entry;
use super::transforms::{AXES, Transforms};
use crate::error::Error;
use crate::fem::mesh::deck::{Card, Deck, Place};

/// The ties of a scene.
///
/// # Errors
/// An error with the line for a surface or a node that cannot be tied.
pub(super) fn ties(deck: &Deck, transforms: &Transforms) -> Result<Vec<Entry>, Error> {
    let mut ties = Vec::new();
    for card in &deck.source.cards {
        if card.is("TIE") {
            let reach = tolerance(deck, card)?;
            for line in &card.lines {
                let mut fields = deck.source.fields(line);
                let pair = [fields.text().unwrap_or_default(), fields.text().unwrap_or_default()];
                fields.end()?;
                ties.push(surfaces(deck, &pair, reach, line.place)?);
            }
        } else if card.is("EQUATION") {
            add_equations(deck, card, transforms, &mut ties)?;
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

/// Equations: their number of terms, then all terms, each a node, a direction and a coefficient.
fn add_equations(deck: &Deck, card: &Card, transforms: &Transforms, ties: &mut Vec<Entry>) -> Result<(), Error> {
    let dimension = deck.element_list.first().map_or(3, |element| element.kind.dimension());
    let mut lines = card.lines.iter();
    while let Some(first) = lines.next() {
        let mut fields = deck.source.fields(first);
        let count = fields.whole("the number of terms of the equation")?;
        fields.end()?;
        let mut terms: Vec<Value> = Vec::new();
        while terms.len() < count {
            let Some(line) = lines.next() else {
                let message = format!("the equation has {} terms, not {count}", terms.len());
                return Err(deck.source.fault(first.place, message));
            };
            let mut fields = deck.source.fields(line);
            while terms.len() < count && fields.clone().text().is_some() {
                let number = fields.whole("the node of a term")?;
                let direction = fields.whole(format_args!("the direction of node {number}"))?;
                let coefficient = fields.finite(format_args!("the coefficient of node {number}"))?;
                let node =
                    deck.nodes.place(number).ok_or_else(|| fields.fault(format!("the deck has no node {number}")))?;
                let name = name_of_node(deck, node).ok_or_else(|| {
                    fields.fault(format!("node {number} belongs to no element; an equation joins nodes of elements"))
                })?;
                if !(1..=dimension).contains(&direction) {
                    let message = format!("{direction} is no displacement of a node here; there are 1 to {dimension}");
                    return Err(fields.fault(message));
                }
                let axes = transforms.axes(deck, node).map_err(|message| fields.fault(message))?;
                let along = axes.unwrap_or(AXES)[direction - 1];
                if coefficient != 0.0 {
                    let mut term = json!({"on": {"nodes": name}});
                    for (axis, part) in ["x", "y", "z"].into_iter().zip(along).filter(|(_, part)| *part != 0.0) {
                        term[axis] = (coefficient * part).into();
                    }
                    terms.push(term);
                }
            }
            fields.end()?;
        }
        if terms.is_empty() {
            return Err(deck.source.fault(first.place, "the equation has no term"));
        }
        ties.push(Entry::new(json!({"equation": {"terms": terms}}), first.place));
    }
    Ok(())
}
