//! Constraints of the cards *MPC as linear equations, for small displacements: nodes that stay in a plane, on a line,
//! or at a distance.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.20, keyword *MPC.

use super::coupling::Equation;
use super::equations::along;
use super::transforms::Transforms;
use crate::error::Error;
use crate::fem::geometry::{across, cross, distance, dot, length, minus, unit};
use crate::fem::mesh::deck::{Card, Deck, Place, key};
use crate::scene::input::sum::Sum;

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
    warnings: &mut Vec<(Place, String)>,
) -> Result<Vec<Equation>, Error> {
    let mut equations = Vec::new();
    for card in deck.source.cards.iter().filter(|card| card.is("MPC")) {
        let (name, nodes) = nodes(deck, card)?;
        let fault = |message: String| deck.source.fault(card.place, message);
        let sums = sums(deck, transforms, &name, &nodes).map_err(fault)?;
        equations.extend(sums.into_iter().map(|sum| Equation { sum, place: card.place }));
        let message = format!(
            "{name} of *MPC is answered by linear equations for small displacements; CalculiX turns large displacements on"
        );
        warnings.push((card.place, message));
    }
    Ok(equations)
}

/// The name of a constraint and its nodes, in their order.
fn nodes(deck: &Deck, card: &Card) -> Result<(String, Vec<usize>), Error> {
    let (mut name, mut nodes) = (None, Vec::new());
    for line in &card.lines {
        let mut fields = deck.source.fields(line);
        if name.is_none() {
            name = Some(key(&fields.text().unwrap_or_default()));
        }
        while fields.clone().next().is_some() {
            // An empty field, or node 0, fills a line.
            let Some(target) = fields.text().filter(|target| target != "0") else { continue };
            nodes.extend(deck.node_sets.members(&target, &deck.nodes).map_err(|message| fields.fault(message))?);
        }
    }
    match name {
        Some(name) => Ok((name, nodes)),
        None => Err(deck.source.fault(card.place, "*MPC has no line; it begins with PLANE, STRAIGHT or BEAM")),
    }
}

/// The sums that are zero.
fn sums(deck: &Deck, transforms: &Transforms, name: &str, nodes: &[usize]) -> Result<Vec<Sum>, String> {
    if !["PLANE", "STRAIGHT", "BEAM"].contains(&name) {
        let shown: String = name.chars().filter(|c| !c.is_control()).take(40).collect();
        let reason = ABSENT.iter().find(|(other, _)| *other == name).map(|(_, reason)| format!(": {reason}"));
        let reason = reason.unwrap_or_default();
        return Err(format!("{shown} of *MPC is not read; there are PLANE, STRAIGHT and BEAM{reason}"));
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
        [0, 1, 2].map(|axis| away[axis] - height * line[axis])
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
