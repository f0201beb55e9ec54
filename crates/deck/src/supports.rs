//! Supports: the cards *BOUNDARY.

use super::amplitudes::Amplitudes;
use super::bodies::{name_of_node, names_of_nodes};
use super::keywords::SceneEntry;
use super::references::{AXES, NO_Z, References};
use super::transforms::{Axes, Displacements, Transforms};
use serde_json::{Value, json};
use signorini_fem::Error;
use signorini_fem::geometry::{COORDINATES, dot};
use signorini_fem::mesh::deck::{Deck, DeckCard, DeckPlace, Overridden, key};

/// Names of dofs in decks of Abaqus, with the first directions that they hold.
const NAMED: [(&str, &[usize]); 5] =
    [("ENCASTRE", &[0, 1, 2]), ("PINNED", &[0, 1, 2]), ("XSYMM", &[0]), ("YSYMM", &[1]), ("ZSYMM", &[2])];

/// The cards *BOUNDARY of a deck, with what they refer to.
struct Boundaries<'a> {
    deck: &'a Deck,
    amplitudes: &'a Amplitudes,
    transforms: &'a Transforms,
    /// The displacements at the ends of the steps before.
    earlier: &'a [Displacements],
}

/// A line: the displacements that it prescribes for some nodes.
struct Prescribed {
    card: DeckPlace,
    target: String,
    nodes: Vec<usize>,
    /// `true` if these are a part of the nodes of the target.
    is_part: bool,
    values: [Option<f64>; 3],
    /// Rotations, which only reference nodes have.
    turns: [Option<f64>; 3],
    place: DeckPlace,
}

/// A support that grows: lines of one card that hold the same nodes, or other nodes alike.
struct Merged {
    card: DeckPlace,
    values: [Option<f64>; 3],
    targets: Vec<String>,
    place: DeckPlace,
}

impl Merged {
    /// Adds a line for one target; `false` if it needs a support of its own.
    fn takes(&mut self, line: &Prescribed, target: &str) -> bool {
        if self.card != line.card {
            return false;
        }
        let is_apart = self.values.iter().zip(&line.values).all(|(own, other)| own.is_none() || other.is_none());
        if self.targets == [target] && is_apart {
            self.values.iter_mut().zip(&line.values).for_each(|(own, other)| *own = own.or(*other));
            return true;
        }
        let is_alike = self.values == line.values;
        if is_alike {
            self.targets.push(target.to_string());
        }
        is_alike
    }
}

pub(super) fn supports(
    deck: &Deck,
    amplitudes: &Amplitudes,
    references: &mut References,
    transforms: &Transforms,
    earlier: &[Displacements],
) -> Result<Vec<SceneEntry>, Error> {
    let mut lines = Vec::new();
    for line in in_force(&Boundaries { deck, amplitudes, transforms, earlier })? {
        lines.extend(off_references(deck, line, references)?);
    }
    let lines = in_the_end(lines);
    let (mut supports, mut turned): (Vec<Merged>, Vec<SceneEntry>) = (Vec::new(), Vec::new());
    for line in lines.iter().filter(|line| line.values.iter().any(Option::is_some)) {
        let in_axes = in_local_axes(deck, line, transforms)?;
        let is_turned = |node: &usize| in_axes.iter().any(|one| one.0 == *node);
        turned.extend(in_axes.iter().flat_map(|(node, axes)| along_axes(deck, line, *node, axes)));
        let targets = match in_axes.is_empty() && !line.is_part {
            true => names_of_nodes(deck, &line.target, &line.nodes),
            false => {
                let plain = line.nodes.iter().filter(|node| !is_turned(node));
                plain.filter_map(|&node| name_of_node(deck, node)).collect()
            }
        };
        for target in targets {
            if !supports.last_mut().is_some_and(|last| last.takes(line, &target)) {
                supports.push(Merged {
                    card: line.card,
                    values: line.values,
                    targets: vec![target],
                    place: line.place,
                });
            }
        }
    }
    let plain = supports.into_iter().map(|one| SceneEntry::new(support(&one.values, one.targets), one.place));
    Ok(plain.chain(turned).collect())
}

/// A support for each axis along which a line holds a node.
fn along_axes(deck: &Deck, line: &Prescribed, node: usize, axes: &Axes) -> Vec<SceneEntry> {
    let held = line.values.iter().zip(axes).filter_map(|(value, axis)| Some(((*value)?, axis)));
    let entry = |(value, axis): (f64, &[f64; 3])| {
        let on = json!({"nodes": name_of_node(deck, node)});
        SceneEntry::new(json!({"on": on, "normal": axis[..deck.dimension()], "value": value}), line.place)
    };
    held.map(entry).collect()
}

/// The nodes of a line that have local axes, with these. A node that does not move at all needs none.
fn in_local_axes(deck: &Deck, line: &Prescribed, transforms: &Transforms) -> Result<Vec<(usize, Axes)>, Error> {
    if line.values[..deck.dimension()].iter().all(|value| *value == Some(0.0)) {
        return Ok(Vec::new());
    }
    let of_node = |&node: &usize| match transforms.axes(deck, node) {
        Ok(axes) => axes.filter(|_| deck.body_of_node[node].is_some()).map(|axes| Ok((node, axes))),
        Err(message) => Some(Err(deck.fault(line.place, message))),
    };
    line.nodes.iter().filter_map(of_node).collect()
}

/// The rest of a line after its reference nodes are prescribed; `None` if nothing is left.
fn off_references(deck: &Deck, line: Prescribed, references: &mut References) -> Result<Option<Prescribed>, Error> {
    let mut nodes = Vec::with_capacity(line.nodes.len());
    for &node in &line.nodes {
        let mut is_reference = false;
        for (axis, value) in line.values.iter().chain(&line.turns).enumerate() {
            if let Some(value) = *value {
                let fault = |message: String| deck.fault(line.place, message);
                is_reference |= references.prescribe(node, axis + 1, value).map_err(fault)?;
            }
        }
        // A reference node that belongs to elements is held with its body.
        if !is_reference || deck.body_of_node[node].is_some() {
            nodes.push(node);
        }
    }
    if !nodes.is_empty() && line.turns.iter().flatten().any(|&value| value != 0.0) {
        return Err(deck.fault(line.place, "a node of a solid has no rotation that could be prescribed"));
    }
    let mut line = Prescribed { nodes, ..line };
    if !line.nodes.is_empty() && names_z_of_plane(deck, &mut line.values) {
        return Err(deck.fault(line.place, NO_Z));
    }
    Ok((!line.nodes.is_empty()).then_some(line))
}

/// All lines that OP=NEW does not remove.
fn in_force(given: &Boundaries) -> Result<Vec<Prescribed>, Error> {
    let Boundaries { deck, amplitudes, .. } = given;
    let mut lines: Vec<Prescribed> = Vec::new();
    // The number of lines before the last step that has begun.
    let mut of_model = None;
    for card in deck.source.cards() {
        if card.is("STEP") {
            of_model = Some(lines.len());
        }
        if !card.is("BOUNDARY") {
            continue;
        }
        if card.value("TYPE").is_some_and(|value| key(value) != "DISPLACEMENT") {
            return Err(card.fault("only displacements are prescribed in an equilibrium"));
        }
        if card.is_new() {
            if of_model.is_some_and(|before| lines.len() > before) {
                return Err(card.fault("OP=NEW must stand on the first *BOUNDARY of the step"));
            }
            lines.clear();
            of_model = of_model.map(|_| 0);
        }
        for line in read(deck, card, amplitudes.factor(deck, card)?)? {
            match card.has("FIXED") {
                true => lines.extend(given.fixed(line, card.step)?),
                false => lines.push(line),
            }
        }
    }
    Ok(lines)
}

impl Boundaries<'_> {
    /// A line of FIXED, a line for each node: it holds what it names where the step before ended.
    fn fixed(&self, line: Prescribed, step: usize) -> Result<Vec<Prescribed>, Error> {
        let before = match step {
            0 | 1 => None,
            _ => Some(self.earlier.get(step - 2).ok_or_else(|| {
                let message = format!(
                    "FIXED holds the displacement at the end of step {}, which only `signorini ccx` knows, that solves all steps; or \
                     write the displacement itself, without FIXED",
                    step - 1
                );
                self.deck.fault(line.place, message)
            })?),
        };
        let of_node = |&node: &usize| {
            let number = self.deck.nodes.numbers[node];
            let at = before.and_then(|before| before.get(&number)).copied().unwrap_or_default();
            let axes = self.transforms.axes(self.deck, node).map_err(|message| self.deck.fault(line.place, message));
            let along = axes?.unwrap_or(COORDINATES).map(|axis| dot(axis, [at[0], at[1], at[2]]));
            let held = |given: [Option<f64>; 3], at: [f64; 3]| [0, 1, 2].map(|axis| given[axis].map(|_| at[axis]));
            let (values, turns) = (held(line.values, along), held(line.turns, [at[3], at[4], at[5]]));
            Ok(Prescribed { target: number.to_string(), nodes: vec![node], values, turns, ..line })
        };
        line.nodes.iter().map(of_node).collect()
    }
}

fn support(values: &[Option<f64>; 3], mut targets: Vec<String>) -> Value {
    let on = match targets.len() {
        1 => Value::from(targets.remove(0)),
        _ => targets.into(),
    };
    let mut value = json!({"on": {"nodes": on}});
    for (axis, displacement) in AXES.iter().zip(values) {
        if let Some(displacement) = displacement {
            value[*axis] = (*displacement).into();
        }
    }
    value
}

/// The lines of a card: nodes, first dof, last dof, displacement.
fn read(deck: &Deck, card: DeckCard, factor: f64) -> Result<Vec<Prescribed>, Error> {
    let mut lines = Vec::with_capacity(card.lines.len());
    for mut fields in card.fields() {
        let (target, nodes) = deck.nodes.target(&mut fields)?;
        let label = fields.clone().text().map(|text| key(&text)).unwrap_or_default();
        let (mut values, mut turns) = ([None; 3], [None; 3]);
        if let Some((_, axes)) = NAMED.iter().find(|(name, _)| *name == label) {
            fields.text();
            axes.iter().for_each(|&axis| values[axis] = Some(0.0));
        } else {
            let first = fields.whole("the first direction")?;
            let last = if fields.clone().text().is_some() {
                fields.whole("the last direction")?
            } else {
                fields.next();
                first
            };
            let value = factor * fields.finite_or_zero("the displacement")?;
            if first == 0 || last < first || last > 6 {
                let message = format!(
                    "directions {first} to {last} are not those of a solid; there are 1, 2 and 3, and rotations 4 to 6"
                );
                return Err(fields.fault(message));
            }
            // A node of a solid has no rotations: to hold them changes nothing.
            for (axis, held) in values.iter_mut().chain(&mut turns).enumerate() {
                if (first..=last).contains(&(axis + 1)) {
                    *held = Some(value);
                }
            }
        }
        fields.pass_over();
        lines.push(Prescribed { card: card.place, target, nodes, is_part: false, values, turns, place: fields.place });
    }
    Ok(lines)
}

/// Leaves z out of a plane model, in which it is zero; `true` for another value.
fn names_z_of_plane(deck: &Deck, values: &mut [Option<f64>; 3]) -> bool {
    let is_plane = deck.dimension() == 2;
    is_plane && values[2].take().is_some_and(|value| value != 0.0)
}

/// The lines as they act in the end. A later line replaces the displacements of its nodes in earlier lines: these keep
/// their other nodes.
fn in_the_end(lines: Vec<Prescribed>) -> Vec<Prescribed> {
    let mut last = Overridden::default();
    for (index, line) in lines.iter().enumerate() {
        for axis in (0..3).filter(|&axis| line.values[axis].is_some()) {
            line.nodes.iter().for_each(|&node| last.give((node, axis), index));
        }
    }
    let mut left = Vec::with_capacity(lines.len());
    for (index, mut line) in lines.into_iter().enumerate() {
        let mut parts = Vec::new();
        for axis in 0..3 {
            let acts = |node: &usize| last.acts(&(*node, axis), index);
            let nodes: Vec<usize> = line.nodes.iter().copied().filter(acts).collect();
            if nodes.len() < line.nodes.len() {
                let mut values = [None; 3];
                values[axis] = line.values[axis].take();
                let (target, is_part, turns) = (line.target.clone(), true, [None; 3]);
                parts.push(Prescribed { nodes, values, target, is_part, turns, ..line });
            }
        }
        left.push(line);
        left.extend(parts.into_iter().filter(|part| !part.nodes.is_empty()));
    }
    left
}
