//! Equations between components of nodes: the cards *EQUATION.

use super::coupling::Equation;
use super::transforms::Transforms;
use crate::error::Error;
use crate::fem::geometry::COORDINATES;
use crate::fem::mesh::deck::{Card, Deck};
use crate::scene::input::sum::Sum;

/// The component that a direction of a node names, from 1, as a sum: of a node of elements the displacement along its
/// local axis.
///
/// # Errors
/// A sentence for a direction that the node does not have, and for a node without local axes.
pub(super) fn component(deck: &Deck, transforms: &Transforms, node: usize, direction: usize) -> Result<Sum, String> {
    let (dimension, mut sum) = (deck.dimension(), Sum::default());
    let is_loose = deck.body_of_node[node].is_none();
    let turns = is_loose && ((dimension == 3 && (4..=6).contains(&direction)) || direction == 6);
    if !(1..=dimension).contains(&direction) && !turns {
        return Err(format!("{direction} is no displacement of a node here; there are 1 to {dimension}"));
    }
    match is_loose {
        true => sum.add((node, direction - 1), 1.0),
        false => sum.add_along(node, transforms.axes(deck, node)?.unwrap_or(COORDINATES)[direction - 1]),
    }
    Ok(sum)
}

/// The displacement of a node along a vector of the model.
///
/// # Errors
/// A sentence for a node without elements that has local axes.
pub(super) fn along(deck: &Deck, transforms: &Transforms, node: usize, vector: [f64; 3]) -> Result<Sum, String> {
    let mut sum = Sum::default();
    if deck.body_of_node[node].is_none() && transforms.axes(deck, node)?.is_some() {
        let number = deck.nodes.numbers[node];
        return Err(format!("node {number} belongs to no element, and is read here without *TRANSFORM only"));
    }
    sum.add_along(node, vector);
    Ok(sum)
}

pub(super) fn equations(deck: &Deck, transforms: &Transforms) -> Result<Vec<Equation>, Error> {
    let mut equations = Vec::new();
    for card in deck.source.cards.iter().filter(|card| card.is("EQUATION")) {
        add_equations(deck, card, transforms, &mut equations)?;
    }
    Ok(equations)
}

/// The equations of a card: their number of terms, then all terms, each a node, a direction and a coefficient.
fn add_equations(
    deck: &Deck,
    card: &Card,
    transforms: &Transforms,
    equations: &mut Vec<Equation>,
) -> Result<(), Error> {
    let mut lines = card.lines.iter();
    while let Some(first) = lines.next() {
        let mut fields = deck.source.fields(first);
        let count = fields.whole("the number of terms of the equation")?;
        fields.end()?;
        let (mut sum, mut terms) = (Sum::default(), 0);
        while terms < count {
            let Some(line) = lines.next() else {
                let message = format!("the equation has {terms} terms, not {count}");
                return Err(deck.source.fault(first.place, message));
            };
            let mut fields = deck.source.fields(line);
            while terms < count && fields.clone().text().is_some() {
                let number = fields.whole("the node of a term")?;
                let direction = fields.whole(format_args!("the direction of node {number}"))?;
                let coefficient = fields.finite(format_args!("the coefficient of node {number}"))?;
                let node =
                    deck.nodes.place(number).ok_or_else(|| fields.fault(format!("the deck has no node {number}")))?;
                let term = component(deck, transforms, node, direction).map_err(|message| fields.fault(message))?;
                sum.add_multiple(coefficient, &term);
                terms += 1;
            }
            fields.end()?;
        }
        if sum.terms.is_empty() {
            return Err(deck.source.fault(first.place, "the equation has no term"));
        }
        equations.push(Equation { sum, place: first.place });
    }
    Ok(())
}
