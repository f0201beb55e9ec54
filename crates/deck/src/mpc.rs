//! Constraints of the cards *MPC as linear equations, for small displacements: nodes that stay in a plane, on a line,
//! or at a distance.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.20, keyword *MPC.

use super::coupling::Equation;
use super::transforms::Transforms;
use signorini_fem::Error;
use signorini_fem::geometry::{COORDINATES, across, cross, distance, dot, length, minus, shifted, unit};
use signorini_fem::mesh::deck::{Deck, DeckCard, DeckPlace, SpringType, cut, key};
use signorini_fem::sum::Sum;

/// Nodes farther from their plane or line than this share of its extent lie outside: far above the digits of
/// coordinates in decks.
const OUTSIDE: f64 = 1e-4;

/// Constraints that are refused, with the reason.
const ABSENT: [(&str, &str); 2] = [
    (
        "MEANROT",
        "the mean rotation is not linear there; write *COUPLING with *DISTRIBUTING and a rotation of its reference node",
    ),
    ("DIST", "a bound of the distance of two nodes is no equation"),
];

/// The equations of all cards *MPC; each adds a warning.
pub(super) fn constraints(
    deck: &Deck,
    transforms: &Transforms,
    warnings: &mut Vec<(DeckPlace, String)>,
) -> Result<Vec<Equation>, Error> {
    let mut equations = Vec::new();
    for card in deck.source.cards_of("MPC") {
        let (name, nodes) = nodes(deck, card)?;
        let sums = card.placed(sums(deck, transforms, &name, &nodes))?;
        equations.extend(sums.into_iter().map(|sum| Equation { sum, place: card.place }));
        let message = format!(
            "{name} of *MPC is answered by linear equations for small displacements; CalculiX turns large displacements on"
        );
        warnings.push((card.place, message));
    }
    Ok(equations)
}

/// The name of a constraint and its nodes, in their order.
fn nodes(deck: &Deck, card: DeckCard) -> Result<(String, Vec<usize>), Error> {
    let (mut name, mut nodes) = (None, Vec::new());
    for mut fields in card.fields() {
        if name.is_none() {
            name = Some(key(&fields.text().unwrap_or_default()));
        }
        while fields.clone().next().is_some() {
            // An empty field, or node 0, fills a line.
            let Some(target) = fields.text().filter(|target| target != "0") else { continue };
            nodes.extend(fields.placed(deck.nodes.members(&target))?);
        }
    }
    match name {
        Some(name) => Ok((name, nodes)),
        None => Err(card.fault("*MPC has no line; it begins with PLANE, STRAIGHT or BEAM")),
    }
}

/// The sums that are zero.
fn sums(deck: &Deck, transforms: &Transforms, name: &str, nodes: &[usize]) -> Result<Vec<Sum>, String> {
    if !["PLANE", "STRAIGHT", "BEAM"].contains(&name) {
        let reason = ABSENT.iter().find(|(other, _)| *other == name).map(|(_, reason)| format!(": {reason}"));
        let reason = reason.unwrap_or_default();
        return Err(format!("{} of *MPC is not read; there are PLANE, STRAIGHT and BEAM{reason}", cut(name, 40)));
    }
    let at = |node: usize| deck.place_of_node(node);
    let farthest = |from: &dyn Fn(usize) -> f64| nodes.iter().copied().max_by(|a, b| from(*a).total_cmp(&from(*b)));
    // The ends of the longest line from the first node, and the node farthest from that line.
    let Some(&first) = nodes.first() else { return Err(format!("{name} of *MPC names no node")) };
    let last = farthest(&|node| distance(at(node), at(first))).unwrap_or(first);
    let line = unit(minus(at(last), at(first)));
    let extent = distance(at(last), at(first));
    let off_line = |node: usize| {
        let away = minus(at(node), at(first));
        let height = dot(away, line);
        shifted(away, -height, line)
    };
    if extent == 0.0 {
        return Err(format!("the nodes of {name} of *MPC lie at one place"));
    }
    // The displacement of a node along a vector, less that of a point at its place that moves with others, with their
    // shares.
    let relative = |node: usize, vector: [f64; 3], others: &[(usize, f64)]| {
        let mut sum = along(deck, transforms, node, vector)?;
        for &(other, share) in others {
            sum.add_multiple(-share, &along(deck, transforms, other, vector)?);
        }
        Ok::<Sum, String>(sum)
    };
    let outside = |node: usize, of: &str| {
        Err(format!("node {} does not lie {of} of the other nodes of {name} of *MPC", deck.nodes.numbers[node]))
    };
    let share = |node: usize| dot(minus(at(node), at(first)), line) / extent;
    let mut sums = Vec::new();
    match name {
        "BEAM" => {
            let &[one, two] = nodes else { return Err(format!("BEAM of *MPC joins two nodes, not {}", nodes.len())) };
            sums.push(relative(two, line, &[(one, 1.0)])?);
        }
        "STRAIGHT" => {
            let across = axes_across(line, deck.dimension());
            for &node in nodes.iter().filter(|node| ![first, last].contains(node)) {
                if length(off_line(node)) > OUTSIDE * extent {
                    return outside(node, "on the line");
                }
                for &vector in &across {
                    sums.push(relative(node, vector, &[(first, 1.0 - share(node)), (last, share(node))])?);
                }
            }
        }
        "PLANE" if deck.dimension() == 3 => {
            let third = farthest(&|node| length(off_line(node))).unwrap_or(first);
            let (side, width) = (unit(off_line(third)), length(off_line(third)));
            if width <= OUTSIDE * extent {
                return Err("the nodes of PLANE of *MPC lie on a line, which is in many planes".into());
            }
            let normal = cross(line, side);
            for &node in nodes.iter().filter(|node| ![first, last, third].contains(node)) {
                if dot(minus(at(node), at(first)), normal).abs() > OUTSIDE * extent {
                    return outside(node, "in the plane");
                }
                // The point of the node in the triangle of the three others.
                let of_third = dot(off_line(node), side) / width;
                let of_last = share(node) - of_third * share(third);
                let others = [(first, 1.0 - of_third - of_last), (last, of_last), (third, of_third)];
                sums.push(relative(node, normal, &others)?);
            }
        }
        _ => return Err("PLANE of *MPC is read in space only".into()),
    }
    sums.retain(|sum| !sum.terms.is_empty());
    Ok(sums)
}

/// The unit vectors across a line: one in the plane, two in space.
fn axes_across(line: [f64; 3], dimension: usize) -> Vec<[f64; 3]> {
    if dimension == 2 {
        return vec![[-line[1], line[0], 0.0]];
    }
    let first = across(line);
    vec![first, cross(line, first)]
}

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
    for card in deck.source.cards_of("EQUATION") {
        add_equations(deck, card, transforms, &mut equations)?;
    }
    Ok(equations)
}

/// The equations of a card: their number of terms, then all terms, each a node, a direction and a coefficient.
fn add_equations(
    deck: &Deck,
    card: DeckCard,
    transforms: &Transforms,
    equations: &mut Vec<Equation>,
) -> Result<(), Error> {
    let mut lines = card.fields();
    while let Some(mut first) = lines.next() {
        let count = first.whole("the number of terms of the equation")?;
        first.end()?;
        let (mut sum, mut terms) = (Sum::default(), 0);
        while terms < count {
            let Some(mut fields) = lines.next() else {
                let message = format!("the equation has {terms} terms, not {count}");
                return Err(first.fault(message));
            };
            while terms < count && fields.clone().text().is_some() {
                let number = fields.whole("the node of a term")?;
                let direction = fields.whole(format_args!("the direction of node {number}"))?;
                let coefficient = fields.finite(format_args!("the coefficient of node {number}"))?;
                let node =
                    deck.nodes.place(number).ok_or_else(|| fields.fault(format!("the deck has no node {number}")))?;
                let term = fields.placed(component(deck, transforms, node, direction))?;
                sum.add_multiple(coefficient, &term);
                terms += 1;
            }
            fields.end()?;
        }
        if sum.terms.is_empty() {
            return Err(first.fault("the equation has no term"));
        }
        equations.push(Equation { sum, place: first.place });
    }
    Ok(())
}

/// A spring: its energy is half the stiffness times the square of the elongation.
#[derive(Clone, Debug)]
pub(super) struct Spring {
    pub elongation: Sum,
    /// Positive, in force per length.
    pub stiffness: f64,
    pub place: DeckPlace,
}

pub(super) fn springs(deck: &Deck, transforms: &Transforms) -> Result<Vec<Spring>, Error> {
    let mut springs: Vec<Option<Spring>> = vec![None; deck.springs.len()];
    for card in deck.source.cards_of("SPRING") {
        if deck.is_axisymmetric() {
            return Err(card.fault("springs are not read in an axisymmetric model"));
        }
        let set = card.value("ELSET").ok_or_else(|| card.fault("*SPRING names no elements; write ELSET=NAME"))?;
        let members = card.placed(deck.spring_numbers.members(set))?;
        let Some(of_type) = members.first().map(|&member| deck.springs[member].of_type) else { continue };
        if members.iter().any(|&member| deck.springs[member].of_type != of_type) {
            return Err(card.fault(format!("`{set}` has springs of several types; name a set of each")));
        }
        let (directions, stiffness) = values(deck, card, of_type)?;
        for member in members {
            let element = &deck.springs[member];
            let elongation = elongation(deck, transforms, member, directions);
            let elongation = elongation.map_err(|message| deck.fault(element.place, message))?;
            springs[member] = Some(Spring { elongation, stiffness, place: element.place });
        }
    }
    let without = || deck.springs.iter().zip(&springs).find(|(_, spring)| spring.is_none());
    if let Some((element, _)) = without() {
        return Err(deck.fault(element.place, "this spring has no stiffness; a card *SPRING must name its set"));
    }
    Ok(springs.into_iter().flatten().collect())
}

/// The directions, from 1, and the stiffness of a card.
fn values(deck: &Deck, card: DeckCard, of_type: SpringType) -> Result<([usize; 2], f64), Error> {
    let fault = |message: &str| Err(card.fault(message));
    let mut directions = [1; 2];
    let line = match (of_type, &card.lines[..]) {
        (SpringType::Along, [line]) => line,
        (SpringType::Along, _) => return fault("*SPRING of SPRINGA has one line, with the stiffness"),
        (_, [first, line]) => {
            let mut fields = card.source.fields(first);
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
    let mut fields = card.source.fields(line);
    let stiffness = fields.finite("the stiffness of the spring")?;
    match stiffness > 0.0 {
        true => Ok((directions, stiffness)),
        false => Err(fields.fault("the stiffness of a spring must be positive")),
    }
}

fn elongation(deck: &Deck, transforms: &Transforms, element: usize, directions: [usize; 2]) -> Result<Sum, String> {
    let element = &deck.springs[element];
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
