//! The forces of several steps: a later step replaces forces on the same nodes in the same directions, or all by
//! OP=NEW.

use std::collections::HashMap;

use crate::fem::mesh::deck::Deck;

/// The step whose force acts at each node in each direction, from 1.
pub(super) struct LastForces {
    last: HashMap<(usize, usize), usize>,
    /// The step that removes all forces of those before it.
    first: usize,
}

impl LastForces {
    pub fn of(deck: &Deck) -> Self {
        let mut forces = LastForces { last: HashMap::new(), first: 0 };
        if deck.step < 2 {
            return forces;
        }
        for card in deck.source.cards.iter().filter(|card| card.is("CLOAD")) {
            if card.is_new() {
                forces.first = card.step;
            }
            for line in &card.lines {
                // A line that is wrong is refused where it is read.
                let mut fields = deck.source.fields(line);
                let nodes = fields.text().and_then(|target| deck.node_sets.members(&target, &deck.nodes).ok());
                let (Some(nodes), Ok(direction)) = (nodes, fields.whole("the direction")) else { continue };
                nodes.into_iter().for_each(|node| _ = forces.last.insert((node, direction), card.step));
            }
        }
        forces
    }

    /// Returns `true` if a force that a step gives to a node in a direction acts at the end.
    pub fn acts(&self, step: usize, at: (usize, usize)) -> bool {
        step >= self.first && self.last.get(&at).is_none_or(|last| *last == step)
    }
}
