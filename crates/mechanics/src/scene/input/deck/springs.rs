//! Springs: the cards *SPRING with the elements SPRINGA, SPRING1, SPRING2, each as an elongation and a stiffness.

use super::equations::along;
use super::transforms::Transforms;
use crate::error::Error;
use crate::fem::geometry::{COORDINATES, minus, unit};
use crate::fem::mesh::deck::{Card, Deck, Place, SpringType};
use crate::scene::input::sum::Sum;

/// A spring: its energy is half the stiffness times the square of the elongation.
#[derive(Clone, Debug)]
pub(super) struct Spring {
    pub elongation: Sum,
    /// Positive, in force per length.
    pub stiffness: f64,
    pub place: Place,
}

pub(super) fn springs(deck: &Deck, transforms: &Transforms) -> Result<Vec<Spring>, Error> {
    let mut springs: Vec<Option<Spring>> = vec![None; deck.springs.all.len()];
    for card in deck.source.cards.iter().filter(|card| card.is("SPRING")) {
        let fault = |message: String| deck.source.fault(card.place, message);
        if deck.is_axisymmetric() {
            return Err(fault("springs are not read in an axisymmetric model".into()));
        }
        let set = card.value("ELSET").ok_or_else(|| fault("*SPRING names no elements; write ELSET=NAME".into()))?;
        let members = deck.springs.sets.members(set, &deck.springs.numbers).map_err(fault)?;
        let Some(of_type) = members.first().map(|&member| deck.springs.all[member].of_type) else { continue };
        if members.iter().any(|&member| deck.springs.all[member].of_type != of_type) {
            return Err(fault(format!("`{set}` has springs of several types; name a set of each")));
        }
        let (directions, stiffness) = values(deck, card, of_type)?;
        for member in members {
            let element = &deck.springs.all[member];
            let elongation = elongation(deck, transforms, member, directions)
                .map_err(|message| deck.source.fault(element.place, message))?;
            springs[member] = Some(Spring { elongation, stiffness, place: element.place });
        }
    }
    let without = || deck.springs.all.iter().zip(&springs).find(|(_, spring)| spring.is_none());
    if let Some((element, _)) = without() {
        return Err(deck.source.fault(element.place, "this spring has no stiffness; a card *SPRING must name its set"));
    }
    Ok(springs.into_iter().flatten().collect())
}

/// The directions, from 1, and the stiffness of a card.
fn values(deck: &Deck, card: &Card, of_type: SpringType) -> Result<([usize; 2], f64), Error> {
    let fault = |message: &str| Err(deck.source.fault(card.place, message));
    let mut directions = [1; 2];
    let line = match (of_type, &card.lines[..]) {
        (SpringType::Along, [line]) => line,
        (SpringType::Along, _) => return fault("*SPRING of SPRINGA has one line, with the stiffness"),
        (_, [first, line]) => {
            let mut fields = deck.source.fields(first);
            directions[0] = fields.whole("the direction at the first node")?;
            if of_type == SpringType::Between {
                directions[1] = fields.whole("the direction at the second node")?;
            }
            fields.end()?;
            if let Some(wrong) = directions.iter().find(|direction| !(1..=deck.dimension()).contains(direction)) {
                let message = format!("{wrong} is no displacement of a node here; there are 1 to {}", deck.dimension());
                return Err(fields.fault(message));
            }
            line
        }
        _ => return fault("*SPRING of SPRING1 and SPRING2 has two lines: the directions, then the stiffness"),
    };
    let mut fields = deck.source.fields(line);
    let stiffness = fields.finite("the stiffness of the spring")?;
    match stiffness > 0.0 {
        true => Ok((directions, stiffness)),
        false => Err(fields.fault("the stiffness of a spring must be positive")),
    }
}

fn elongation(deck: &Deck, transforms: &Transforms, element: usize, directions: [usize; 2]) -> Result<Sum, String> {
    let element = &deck.springs.all[element];
    let (mut sum, nodes) = (Sum::default(), &element.nodes[..]);
    let vectors = match (element.of_type, nodes) {
        (SpringType::Along, &[one, two]) => {
            let direction = unit(minus(deck.place_of_node(two), deck.place_of_node(one)));
            if direction == [0.0; 3] {
                return Err("the two nodes of this spring lie at one place, so that it has no direction".into());
            }
            [direction.map(|part| -part), direction]
        }
        _ => [COORDINATES[directions[0] - 1], COORDINATES[directions[1] - 1].map(|part| -part)],
    };
    for (&node, vector) in nodes.iter().zip(vectors) {
        sum.add_multiple(1.0, &along(deck, transforms, node, vector)?);
    }
    Ok(sum)
}
