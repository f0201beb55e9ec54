//! Reference nodes: components of nodes without elements, which rigid bodies, couplings, equations and springs move.
//! Those that are in equations and springs are reference points of the scene, called by the numbers of their nodes.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::bodies::name_of_node;
use super::coupling::{Coupling, Equation, Kind};
use super::keywords::{Entry, object};
use super::mpc::{Spring, constraints, equations, springs};
use super::rigid::{Of, ReferenceNode, RigidBodies, Transforms};
use serde_json::{Value, json};
use signorini_fem::Error;
use signorini_fem::mesh::deck::{Deck, Place};
use signorini_fem::sum::{Component, Sum};

/// The refusal of a displacement other than 0.
pub(super) const NO_Z: &str = "a plane model has no displacement along z";

/// The keys of displacements and rotations.
const AXES: [&str; 3] = ["x", "y", "z"];

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
    prescribed: BTreeMap<Component, f64>,
    /// The forces on components, each with the place of the first.
    loads: BTreeMap<Component, (Place, f64)>,
    warnings: Vec<(Place, String)>,
}

/// What they are in the scene.
pub(super) struct Entries {
    pub points: Vec<Entry>,
    pub ties: Vec<Entry>,
    pub springs: Vec<Entry>,
    pub warnings: Vec<(Place, String)>,
    /// The nodes whose displacements are rotations of points.
    pub nodes: Vec<ReferenceNode>,
}

impl<'a> References<'a> {
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
        let (prescribed, loads, joined) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
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
        joined.extend(rigid_bodies.bolts.references().map(|(node, _)| (node, 0)));
        Ok(references)
    }

    /// The component that a direction of a node names, from 1.
    ///
    /// # Errors
    /// A sentence for one that its rotations or its bolt do not have.
    fn component(&self, node: usize, direction: usize) -> Result<Component, String> {
        match self.rotations.get(&node) {
            None if direction > 1 && self.rigid_bodies.bolts.is_reference(node) => {
                Err(format!("direction {direction} of this node is none of a bolt, which has direction 1 alone"))
            }
            None => Ok((node, direction - 1)),
            Some(&reference) if direction <= 3 => Ok((reference, direction + 2)),
            Some(_) => Err(format!(
                "direction {direction} of a ROT NODE is none; its directions 1 to 3 are the rotations about x, y and z"
            )),
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
        let component = match self.component(node, direction) {
            Ok(component) => component,
            Err(message) => return if value == 0.0 { Ok(true) } else { Err(message) },
        };
        if component.1 == 2 && self.deck.dimension() == 2 && self.deck.body_of_node[node].is_none() {
            return if value == 0.0 { Ok(true) } else { Err(NO_Z.into()) };
        }
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
        let component = self.component(node, direction)?;
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
        self.loads.entry(component).or_insert((place, 0.0)).1 += force;
        Ok(true)
    }

    /// The reference points of the scene, with the ties and springs at them.
    pub fn entries(mut self) -> Entries {
        for (node, place) in &self.means {
            if self.prescribed.keys().any(|component| component.0 == *node && self.joined.contains(component)) {
                let message = "the mean motion of *DISTRIBUTING is prescribed; CalculiX passes over it";
                self.warnings.push((*place, message.into()));
            }
        }
        let whole = Place { file: 0, line: 1 };
        let mut places: BTreeMap<usize, Place> = self.prescribed.keys().map(|component| (component.0, whole)).collect();
        let named = terms(&self.equations, &self.springs).filter(|one| self.joined.contains(&one.0));
        places.extend(named.map(|(component, place)| (component.0, place)).collect::<Vec<_>>().into_iter().rev());
        places.extend(self.rigid_bodies.bolts.references());
        places.extend(self.loads.iter().map(|(component, (place, _))| (component.0, *place)));
        let points = places.into_iter().map(|(node, place)| Entry::new(self.point(node), place)).collect();
        let tie = |Equation { sum, place }: &Equation| Entry::new(object("equation", self.tie(sum)), *place);
        let spring = |Spring { elongation, stiffness, place }: &Spring| {
            Entry::new(json!({"terms": self.terms(elongation), "along": stiffness}), *place)
        };
        let (ties, springs) = (self.equations.iter().map(tie).collect(), self.springs.iter().map(spring).collect());
        let number = |node: usize| self.deck.nodes.numbers[node];
        let turns = |(&node, &point): (&usize, &usize)| ReferenceNode {
            number: number(node),
            of: Of::Turns { point: number(point) },
        };
        let nodes = self.rotations.iter().map(turns).collect();
        Entries { points, ties, springs, warnings: self.warnings, nodes }
    }

    fn point(&self, node: usize) -> Value {
        let (dimension, turns) = (self.deck.dimension(), Coupling::turns(self.deck));
        let at = self.deck.place_of_node(node);
        let mut point = json!({"name": self.deck.nodes.numbers[node].to_string(), "at": at[..dimension]});
        let force = |kind: usize| self.loads.get(&(node, kind)).map_or(0.0, |load| load.1);
        let turns: Vec<usize> = turns.iter().map(|turn| 3 + turn).collect();
        for kind in (0..dimension).chain(turns.iter().copied()) {
            if let Some(value) = self.prescribed.get(&(node, kind)) {
                let of = if kind < 3 { &mut point } else { &mut point["rotation"] };
                of[AXES[kind % 3]] = (*value).into();
            }
        }
        let loads: [(&str, Vec<f64>); 2] =
            [("force", (0..dimension).map(force).collect()), ("moment", turns.into_iter().map(force).collect())];
        for (name, parts) in loads.into_iter().filter(|(_, parts)| parts.iter().any(|&part| part != 0.0)) {
            point[name] = parts.into();
        }
        point
    }

    /// All sums of components: those of equations and springs.
    fn sums(&mut self) -> impl Iterator<Item = &mut Sum> {
        let equations = self.equations.iter_mut().map(|equation| &mut equation.sum);
        equations.chain(self.springs.iter_mut().map(|spring| &mut spring.elongation))
    }

    fn terms(&self, sum: &Sum) -> Vec<Value> {
        let mut terms: BTreeMap<(bool, usize), Value> = BTreeMap::new();
        for (&(node, kind), &part) in &sum.terms {
            let is_loose = is_loose(self.deck, (node, kind));
            let on = || match is_loose {
                true => json!({"reference": self.deck.nodes.numbers[node].to_string()}),
                false => json!({"nodes": name_of_node(self.deck, node)}),
            };
            let term = terms.entry((is_loose, node)).or_insert_with(|| json!({"on": on()}));
            let of = if kind < 3 { term } else { &mut term["rotation"] };
            of[AXES[kind % 3]] = part.into();
        }
        terms.into_values().collect()
    }

    /// The terms and the value of an equation.
    fn tie(&self, sum: &Sum) -> Value {
        let mut tie = json!({"terms": self.terms(sum)});
        if sum.constant != 0.0 {
            tie["value"] = (-sum.constant).into();
        }
        tie
    }
}

/// The components in equations and springs, with the places of these.
fn terms<'a>(equations: &'a [Equation], springs: &'a [Spring]) -> impl Iterator<Item = (Component, Place)> + 'a {
    let of_equations = equations.iter().map(|one| (&one.sum, one.place));
    let sums = of_equations.chain(springs.iter().map(|one| (&one.elongation, one.place)));
    sums.flat_map(|(sum, place)| sum.terms.keys().map(move |&component| (component, place)))
}

/// Returns `true` for a component that no element has.
fn is_loose(deck: &Deck, (node, kind): Component) -> bool {
    kind >= 3 || deck.body_of_node[node].is_none()
}
