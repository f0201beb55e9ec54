//! Reference nodes: components of nodes without elements, which rigid bodies, couplings, equations and springs move.
//! Those that are in equations are unknowns of the deck only: they are eliminated here, so that the scene has nodes of
//! elements alone.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use serde_json::{Value, json};

use super::bodies::name_of_node;
use super::coupling::{Coupling, Kind};
use super::equations::equations;
use super::mpc::constraints;
use super::reference_node::{Amount, Part, ReferenceNode};
use super::rigid::RigidBodies;
use super::scene_text::{Entry, object};
use super::springs::{Spring, springs};
use super::sums::{Component, Equation, Sum};
use super::transforms::Transforms;
use crate::error::Error;
use crate::fem::mesh::deck::{Deck, Place};

/// What is left of a value below this share of its parts is rounding.
const CONTRADICTION: f64 = 1e-9;

/// The reference nodes of a deck.
pub(super) struct References<'a> {
    deck: &'a Deck,
    pub rigid_bodies: RigidBodies,
    equations: Vec<Equation>,
    springs: Vec<Spring>,
    /// The reference nodes that follow means, with the places of their couplings.
    means: Vec<(usize, Place)>,
    /// The nodes whose displacements are rotations of reference nodes, with these.
    rotations: HashMap<usize, usize>,
    /// The components without elements that are in equations or springs.
    joined: BTreeSet<Component>,
    prescribed: HashMap<Component, f64>,
    /// The forces on components, line by line.
    loads: Vec<(Place, Sum)>,
    /// The eliminated components, each with a sum that has it and is zero.
    solved: Vec<(Component, Sum)>,
    warnings: Vec<(Place, String)>,
}

/// What the elimination leaves for the scene.
pub(super) struct Eliminated {
    pub ties: Vec<Entry>,
    pub springs: Vec<Entry>,
    pub loads: Vec<Entry>,
    pub warnings: Vec<(Place, String)>,
    /// The reference nodes of equations, couplings and springs.
    pub nodes: Vec<ReferenceNode>,
}

impl<'a> References<'a> {
    /// # Errors
    /// An error with the line for an equation, a constraint, a coupling or a spring that is not read.
    pub fn of(deck: &'a Deck, mut rigid_bodies: RigidBodies, transforms: &Transforms) -> Result<Self, Error> {
        let couplings = std::mem::take(&mut rigid_bodies.couplings);
        let (mut equations, springs) = (equations(deck, transforms)?, springs(deck, transforms)?);
        let mut warnings = Vec::new();
        equations.extend(constraints(deck, transforms, &mut warnings)?);
        let own = |coupling: &Coupling| std::iter::once(coupling.reference).chain(coupling.rotation);
        let mut named: Vec<usize> = couplings.iter().flat_map(own).collect();
        named.extend(terms(&equations, &springs).map(|(component, _)| component.0));
        let (mut means, mut rotations) = (Vec::new(), HashMap::new());
        for coupling in couplings {
            // A rigid body has reference nodes of its own.
            let is_alone = own(&coupling).all(|own| named.iter().filter(|&&node| node == own).count() == 1);
            if is_alone && rigid_bodies.takes(deck, &coupling)? {
                continue;
            }
            if let Some(node) = coupling.rotation
                && rotations.insert(node, coupling.reference).is_some_and(|other| other != coupling.reference)
            {
                let message = format!("node {} is the ROT NODE of two reference nodes", deck.nodes.numbers[node]);
                return Err(deck.source.fault(coupling.place, message));
            }
            equations.extend(coupling.equations(deck)?);
            if matches!(coupling.kind, Kind::Distributing(_)) {
                means.push((coupling.reference, coupling.place));
            }
        }
        let (prescribed, loads, solved, joined) = (HashMap::new(), Vec::new(), Vec::new(), BTreeSet::new());
        let mut references = References {
            deck,
            rigid_bodies,
            equations,
            springs,
            means,
            rotations,
            joined,
            prescribed,
            loads,
            solved,
            warnings,
        };
        for (node, reference) in references.rotations.clone() {
            (0..3).for_each(|kind| references.sums().for_each(|sum| sum.rename((node, kind), (reference, 3 + kind))));
        }
        let References { equations, springs, rigid_bodies, joined, .. } = &mut references;
        for (component, place) in terms(equations, springs).filter(|one| is_loose(deck, one.0)) {
            if rigid_bodies.is_reference(component.0) {
                let number = deck.nodes.numbers[component.0];
                let message = format!(
                    "node {number} is the reference of a bolt; equations and springs do not contain such a node: prescribe its force or \
                     its displacement"
                );
                return Err(deck.source.fault(place, message));
            }
            joined.insert(component);
        }
        Ok(references)
    }

    /// The component that a direction of a node names, from 1; `None` for one that its rotations do not have.
    fn component(&self, node: usize, direction: usize) -> Option<Component> {
        match self.rotations.get(&node) {
            None => Some((node, direction - 1)),
            Some(&reference) => (direction <= 3).then_some((reference, direction + 2)),
        }
    }

    /// Prescribes a direction of a node, from 1; `false` for a component that is left to the elements of the node.
    ///
    /// # Errors
    /// A sentence for a direction that the rigid bodies of this model do not have.
    pub fn prescribe(&mut self, node: usize, direction: usize, value: f64) -> Result<bool, String> {
        if self.rigid_bodies.prescribe(node, direction, value)? {
            return Ok(true);
        }
        let Some(component) = self.component(node, direction) else {
            return if value == 0.0 { Ok(true) } else { Err(no_rotation(direction)) };
        };
        let is_loose = self.deck.body_of_node[node].is_none() || self.joined.contains(&component);
        if is_loose {
            self.prescribed.insert(component, value);
        }
        Ok(is_loose)
    }

    /// Adds a force or a moment at a direction of a node, from 1; `false` for a component that is left to the elements
    /// of the node. A force along a prescribed component does nothing.
    ///
    /// # Errors
    /// A sentence for a component that nothing follows.
    pub fn press(&mut self, node: usize, direction: usize, force: f64, place: Place) -> Result<bool, String> {
        if self.rigid_bodies.press(node, direction, force)? {
            return Ok(true);
        }
        let component = self.component(node, direction).ok_or_else(|| no_rotation(direction))?;
        let is_joined = self.joined.contains(&component);
        if self.deck.body_of_node[node].is_some() && !is_joined {
            return Ok(false);
        }
        if force == 0.0 || self.prescribed.contains_key(&component) {
            return Ok(true);
        }
        if !is_joined {
            let number = self.deck.nodes.numbers[node];
            return Err(format!("node {number} belongs to no element, and nothing follows its direction {direction}"));
        }
        if self.loads.last().is_none_or(|(last, _)| *last != place) {
            self.loads.push((place, Sum::default()));
        }
        self.loads.iter_mut().next_back().into_iter().for_each(|(_, sum)| sum.add(component, force));
        Ok(true)
    }

    /// Eliminates all components without elements. The work of a force on such a component is that of forces on the
    /// nodes of the equation that gives it. A spring to a prescribed component is one to the ground, with the force of
    /// its prescribed elongation.
    ///
    /// # Errors
    /// An error with the line for equations that the prescribed components contradict, and for a force or a spring on a
    /// component that is free. The equations are the ties of the scene from number `first_tie`.
    pub fn eliminated(mut self, first_tie: usize) -> Result<Eliminated, Error> {
        for (node, place) in &self.means {
            if self.prescribed.keys().any(|component| component.0 == *node && self.joined.contains(component)) {
                let message = "the mean motion of *DISTRIBUTING is prescribed; CalculiX passes over it";
                self.warnings.push((*place, message.into()));
            }
        }
        let applied: HashMap<Component, f64> = self.loads.iter().fold(HashMap::new(), |mut all, (_, load)| {
            load.terms.iter().for_each(|(component, force)| *all.entry(*component).or_default() += force);
            all
        });
        let prescribed = self.insert_prescribed();
        for component in std::mem::take(&mut self.joined) {
            self.eliminate(component);
        }
        let mut nodes = self.reference_nodes(&prescribed, &applied);
        let mut ties = Vec::new();
        for Equation { sum, place } in &self.equations {
            if !sum.terms.is_empty() {
                let multiplier = Amount::one(Part::Multiplier(first_tie + ties.len()));
                self.resisted(sum, 1.0, &multiplier, &mut nodes);
                ties.push(Entry::new(object("equation", self.tie(sum)), *place));
            } else if sum.constant.abs() > CONTRADICTION * sum.scale {
                let message = "the displacements that are prescribed at reference nodes contradict this equation";
                return Err(self.deck.source.fault(*place, message));
            }
        }
        let (mut springs, mut loads) = (Vec::new(), Vec::new());
        for Spring { elongation, stiffness, place } in &self.springs {
            if let Some((node, kind)) = self.loose(elongation) {
                let number = self.deck.nodes.numbers[node];
                let message = format!("node {number} is free in direction {}; nothing but springs holds it", kind + 1);
                return Err(self.deck.source.fault(*place, message));
            }
            self.resisted(elongation, -stiffness, &self.amount(elongation), &mut nodes);
            if elongation.terms.is_empty() {
                continue;
            }
            springs.push(Entry::new(json!({"terms": self.terms(elongation), "along": stiffness}), *place));
            let mut pull = Sum::default();
            pull.add_multiple(-stiffness * elongation.constant, elongation);
            loads.extend(self.forces(&pull).map(|forces| Entry::new(forces, *place)));
        }
        for (place, sum) in &self.loads {
            if let Some((node, kind)) = self.loose(sum) {
                let number = self.deck.nodes.numbers[node];
                let message = format!("node {number} is free in direction {}, and carries no force there", kind + 1);
                return Err(self.deck.source.fault(*place, message));
            }
            self.resisted(sum, 1.0, &Amount { constant: 1.0, parts: Vec::new() }, &mut nodes);
            loads.extend(self.forces(sum).map(|forces| Entry::new(forces, *place)));
        }
        let nodes = nodes.into_values().collect();
        Ok(Eliminated { ties, springs, loads, warnings: self.warnings, nodes })
    }

    /// The reference nodes with their displacements, and with the forces on components that are not prescribed.
    fn reference_nodes(
        &self,
        prescribed: &HashMap<Component, f64>,
        applied: &HashMap<Component, f64>,
    ) -> BTreeMap<usize, ReferenceNode> {
        let mut nodes = BTreeMap::new();
        let solved = self.solved.iter().map(|(component, zero)| {
            let mut others = zero.clone();
            let own = others.terms.remove(component).unwrap_or(1.0);
            let Amount { constant, parts } = self.amount(&others);
            let parts = parts.into_iter().map(|(factor, part)| (-factor / own, part)).collect();
            (*component, Amount { constant: -constant / own, parts })
        });
        let given =
            prescribed.iter().map(|(component, &constant)| (*component, Amount { constant, parts: Vec::new() }));
        for (component, amount) in solved.chain(given) {
            let force = applied.get(&component).copied().unwrap_or_default();
            for (node, kind) in self.names(component) {
                let node = nodes.entry(node).or_insert_with(|| ReferenceNode::new(self.deck.nodes.numbers[node]));
                node.displacement[kind] = amount.clone();
                node.force[kind].constant += force;
            }
        }
        nodes
    }

    /// A component, and its other name if it is a rotation that has a node of its own.
    fn names(&self, (node, kind): Component) -> impl Iterator<Item = Component> {
        let rotation = self.rotations.iter().filter(move |entry| kind >= 3 && *entry.1 == node);
        std::iter::once((node, kind)).chain(rotation.map(move |entry| (*entry.0, kind - 3)).collect::<Vec<_>>())
    }

    /// Adds the forces that hold prescribed components against `factor` times an amount along a sum.
    fn resisted(&self, sum: &Sum, factor: f64, amount: &Amount, nodes: &mut BTreeMap<usize, ReferenceNode>) {
        for (&component, coefficient) in &sum.replaced {
            for (node, kind) in self.names(component) {
                let Some(ReferenceNode { force, .. }) = nodes.get_mut(&node) else { continue };
                let own = -factor * coefficient;
                force[kind].constant += own * amount.constant;
                force[kind].parts.extend(amount.parts.iter().map(|(factor, part)| (own * factor, *part)));
            }
        }
    }

    /// The value of a sum of components of elements.
    fn amount(&self, sum: &Sum) -> Amount {
        let of_body = sum.terms.iter().filter(|(component, _)| !is_loose(self.deck, **component));
        let part = |(&(node, axis), &factor): (&Component, &f64)| {
            (factor, Part::Displacement(self.deck.nodes.numbers[node], axis))
        };
        Amount { constant: sum.constant, parts: of_body.map(part).collect() }
    }

    /// All sums of components: equations, springs and loads.
    fn sums(&mut self) -> impl Iterator<Item = &mut Sum> {
        let equations = self.equations.iter_mut().map(|equation| &mut equation.sum);
        let springs = self.springs.iter_mut().map(|spring| &mut spring.elongation);
        let solved = self.solved.iter_mut().map(|(_, zero)| zero);
        equations.chain(springs).chain(solved).chain(self.loads.iter_mut().map(|(_, load)| load))
    }

    /// Replaces the prescribed components by their values, and returns these.
    fn insert_prescribed(&mut self) -> HashMap<Component, f64> {
        let prescribed = std::mem::take(&mut self.prescribed);
        self.joined.retain(|component| !prescribed.contains_key(component));
        for sum in self.sums() {
            let own = sum.terms.keys().filter_map(|component| Some((*component, *prescribed.get(component)?)));
            own.collect::<Vec<_>>().into_iter().for_each(|(component, value)| sum.insert(component, value));
        }
        prescribed
    }

    /// Takes the equation in which a component has the largest share, and with it removes the component everywhere
    /// else.
    fn eliminate(&mut self, component: Component) {
        let shares = self.equations.iter().map(|equation| equation.sum.share(component)).enumerate();
        let largest = shares.filter(|(_, share)| *share > 0.0).max_by(|one, other| one.1.total_cmp(&other.1));
        if let Some((pivot, _)) = largest {
            let zero = self.equations.remove(pivot).sum;
            self.sums().for_each(|sum| sum.eliminate(component, &zero));
            self.solved.push((component, zero));
        }
    }

    /// The first component without elements of a sum.
    fn loose(&self, sum: &Sum) -> Option<Component> {
        sum.terms.keys().copied().find(|&component| is_loose(self.deck, component))
    }

    /// The terms of a sum.
    fn terms(&self, sum: &Sum) -> Vec<Value> {
        let term = |(node, vector): (usize, [f64; 3])| {
            let mut term = json!({"on": {"nodes": name_of_node(self.deck, node)?}});
            for (axis, part) in ["x", "y", "z"].into_iter().zip(vector).filter(|(_, part)| *part != 0.0) {
                term[axis] = part.into();
            }
            Some(term)
        };
        sum.vectors().into_iter().filter_map(term).collect()
    }

    /// The terms and the value of an equation.
    fn tie(&self, sum: &Sum) -> Value {
        let mut tie = json!({"terms": self.terms(sum)});
        if sum.constant != 0.0 {
            tie["value"] = (-sum.constant).into();
        }
        tie
    }

    /// The forces of a load on nodes; `None` if there are none.
    fn forces(&self, sum: &Sum) -> Option<Value> {
        let size = self.deck.dimension();
        let force = |(node, force): (usize, [f64; 3])| Some((name_of_node(self.deck, node)?, force[..size].to_vec()));
        let forces: BTreeMap<String, Vec<f64>> = sum.vectors().into_iter().filter_map(force).collect();
        (!forces.is_empty()).then(|| object("nodal-forces", json!(forces)))
    }
}

/// The components in equations and springs, with the places of these.
fn terms<'a>(equations: &'a [Equation], springs: &'a [Spring]) -> impl Iterator<Item = (Component, Place)> + 'a {
    let of_equations = equations.iter().map(|one| (&one.sum, one.place));
    let sums = of_equations.chain(springs.iter().map(|one| (&one.elongation, one.place)));
    sums.flat_map(|(sum, place)| sum.terms.keys().map(move |&component| (component, place)))
}

fn no_rotation(direction: usize) -> String {
    format!("direction {direction} of a ROT NODE is none; its directions 1 to 3 are the rotations about x, y and z")
}

/// Returns `true` for a component that no element has.
fn is_loose(deck: &Deck, (node, kind): Component) -> bool {
    kind >= 3 || deck.body_of_node[node].is_none()
}
