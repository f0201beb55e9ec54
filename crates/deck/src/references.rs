//! Reference nodes: components of nodes without elements, which rigid bodies, couplings, equations and springs move.
//! Rigid bodies are rigid faces of the scene: couplings whose nodes belong to one body and follow in all displacements.
//! Nodes in equations and springs are reference points, called by their numbers.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::bodies::{name_of_node, names_of_nodes, names_of_surface};
use super::contacts::Bolt;
use super::coupling::{Coupling, CouplingKind, Equation, Joined};
use super::keywords::{SceneEntry, object};
use super::mpc::{Spring, constraints, equations, springs};
use super::transforms::Transforms;
use serde_json::{Value, json};
use signorini_fem::Error;
use signorini_fem::mesh::deck::{Deck, DeckPlace};
use signorini_fem::sum::{Component, Sum};

/// The refusal of a displacement other than 0.
pub(super) const NO_Z: &str = "a plane model has no displacement along z";

/// The keys of displacements and rotations.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Nodes of one body that follow a reference node in all displacements.
struct FollowingFace {
    /// `nodes` or `boundary` of the scene, with the name.
    on: (&'static str, Value),
    reference: usize,
    place: DeckPlace,
}

/// The reference nodes of a deck.
pub(super) struct References<'a> {
    deck: &'a Deck,
    faces: Vec<FollowingFace>,
    bolts: Vec<Bolt>,
    equations: Vec<Equation>,
    springs: Vec<Spring>,
    /// The reference nodes that follow means, with the places of their couplings.
    means: Vec<(usize, DeckPlace)>,
    /// The nodes whose displacements are rotations of reference nodes, with these.
    rotations: HashMap<usize, usize>,
    /// The components without elements that are in equations or springs.
    joined: BTreeSet<Component>,
    prescribed: BTreeMap<Component, f64>,
    /// The forces on components, each with the place of the first.
    loads: BTreeMap<Component, (DeckPlace, f64)>,
    warnings: Vec<(DeckPlace, String)>,
}

/// What they are in the scene.
pub(super) struct Entries {
    pub rigid_faces: Vec<SceneEntry>,
    pub points: Vec<SceneEntry>,
    pub ties: Vec<SceneEntry>,
    pub springs: Vec<SceneEntry>,
    pub warnings: Vec<(DeckPlace, String)>,
    /// The reference nodes of rigid faces, and the nodes whose displacements are rotations of points.
    pub nodes: Vec<ReferenceNode>,
}

impl<'a> References<'a> {
    pub fn of(
        deck: &'a Deck,
        couplings: Vec<Coupling>,
        bolts: Vec<Bolt>,
        transforms: &Transforms,
    ) -> Result<Self, Error> {
        let (mut equations, springs) = (equations(deck, transforms)?, springs(deck, transforms)?);
        let mut warnings = Vec::new();
        equations.extend(constraints(deck, transforms, &mut warnings)?);
        let mut named: Vec<usize> = couplings.iter().flat_map(Coupling::references).collect();
        named.extend(terms(&equations, &springs).map(|(component, _)| component.0));
        let is_of_bolt = |node: usize| bolts.iter().any(|bolt| bolt.reference == node);
        let (mut faces, mut means, mut rotations) = (Vec::new(), Vec::new(), HashMap::new());
        for coupling in couplings {
            let fault = |message: String| deck.fault(coupling.place, message);
            // A rigid body has reference nodes of its own.
            let is_alone = coupling.references().all(|own| named.iter().filter(|&&node| node == own).count() == 1);
            let on = if is_alone { following(deck, &coupling).map_err(fault)? } else { None };
            if let Some(shared) = coupling.references().find(|&node| on.is_some() && is_of_bolt(node)) {
                let number = deck.nodes.numbers[shared];
                return Err(fault(format!("node {number} is the reference of two rigid bodies, or of a bolt too")));
            }
            if let Some(node) = coupling.rotation
                && rotations.insert(node, coupling.reference).is_some_and(|other| other != coupling.reference)
            {
                let number = deck.nodes.numbers[node];
                return Err(fault(format!("node {number} is the ROT NODE of two reference nodes")));
            }
            if let Some(on) = on {
                faces.push(FollowingFace { on, reference: coupling.reference, place: coupling.place });
                continue;
            }
            equations.extend(coupling.equations(deck)?);
            if matches!(coupling.kind, CouplingKind::Distributing(_)) {
                means.push((coupling.reference, coupling.place));
            }
        }
        let mut joined: BTreeSet<Component> = bolts.iter().map(|bolt| (bolt.reference, 0)).collect();
        let of_equations = equations.iter_mut().map(|equation: &mut Equation| &mut equation.sum);
        let mut springs = springs;
        for sum in of_equations.chain(springs.iter_mut().map(|spring| &mut spring.elongation)) {
            for (&node, &reference) in &rotations {
                (0..3).for_each(|kind| sum.rename((node, kind), (reference, 3 + kind)));
            }
        }
        for (component, place) in terms(&equations, &springs).filter(|one| is_loose(deck, one.0)) {
            if is_of_bolt(component.0) {
                let number = deck.nodes.numbers[component.0];
                let message = format!(
                    "node {number} is the reference of a bolt; equations and springs do not contain such a node: prescribe its force or \
                     its displacement"
                );
                return Err(deck.fault(place, message));
            }
            joined.insert(component);
        }
        for face in &faces {
            joined.extend(Coupling::motions(deck).map(|kind| (face.reference, kind)));
        }
        let (prescribed, loads) = (BTreeMap::new(), BTreeMap::new());
        Ok(References { deck, faces, bolts, equations, springs, means, rotations, joined, prescribed, loads, warnings })
    }

    fn is_rigid(&self, node: usize) -> bool {
        self.faces.iter().any(|face| face.reference == node)
    }

    /// The component that a direction of a node names, from 1.
    ///
    /// # Errors
    /// A sentence for one that a rigid body, its rotations or its bolt do not have.
    fn component(&self, node: usize, direction: usize) -> Result<Component, String> {
        let component = match self.rotations.get(&node) {
            None => (node, direction - 1),
            Some(&reference) => (reference, direction + 2),
        };
        if self.is_rigid(component.0) {
            return match Coupling::motions(self.deck).any(|kind| kind == component.1) {
                true => Ok(component),
                false => Err(format!("a rigid body of this model has no motion in direction {direction} of this node")),
            };
        }
        if direction > 1 && self.bolts.iter().any(|bolt| bolt.reference == node) {
            return Err(format!("direction {direction} of this node is none of a bolt, which has direction 1 alone"));
        }
        if component.1 > 5 {
            return Err(format!(
                "direction {direction} of a ROT NODE is none; its directions 1 to 3 are the rotations about x, y and z"
            ));
        }
        Ok(component)
    }

    /// Prescribes a direction of a node, from 1; `false` for a component that is left to the elements of the node.
    ///
    /// # Errors
    /// A sentence for a direction that the rigid bodies of this model do not have.
    pub fn prescribe(&mut self, node: usize, direction: usize, value: f64) -> Result<bool, String> {
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
    pub fn press(&mut self, node: usize, direction: usize, force: f64, place: DeckPlace) -> Result<bool, String> {
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

    /// The rigid faces and the reference points of the scene, with the ties and springs at these.
    pub fn entries(mut self) -> Entries {
        for (node, place) in &self.means {
            if self.prescribed.keys().any(|component| component.0 == *node && self.joined.contains(component)) {
                let message = "the mean motion of *DISTRIBUTING is prescribed; CalculiX passes over it";
                self.warnings.push((*place, message.into()));
            }
        }
        let whole = DeckPlace { file: 0, line: 1 };
        let mut places: BTreeMap<usize, DeckPlace> =
            self.prescribed.keys().map(|component| (component.0, whole)).collect();
        let named = terms(&self.equations, &self.springs).filter(|one| self.joined.contains(&one.0));
        places.extend(named.map(|(component, place)| (component.0, place)).collect::<Vec<_>>().into_iter().rev());
        places.extend(self.bolts.iter().map(|bolt| (bolt.reference, bolt.preload.place)));
        places.extend(self.loads.iter().map(|(component, (place, _))| (component.0, *place)));
        places.retain(|&node, _| !self.is_rigid(node));
        let dimension = self.deck.dimension();
        let at = |node: usize| json!(self.deck.place_of_node(node)[..dimension]);
        let number = |node: usize| self.deck.nodes.numbers[node];
        let point = |(node, place): (usize, DeckPlace)| {
            let point = json!({"name": number(node).to_string(), "at": at(node)});
            SceneEntry::new(self.moved(point, node), place)
        };
        let face = |FollowingFace { on, reference, place }: &FollowingFace| {
            let face = json!({on.0: on.1, "centre": at(*reference)});
            SceneEntry::new(self.moved(face, *reference), *place)
        };
        let tie = |Equation { sum, place }: &Equation| SceneEntry::new(object("equation", self.tie(sum)), *place);
        let spring = |Spring { elongation, stiffness, place }: &Spring| {
            SceneEntry::new(json!({"terms": self.terms(elongation), "along": stiffness}), *place)
        };
        let of_face = |reference: usize, first: usize| {
            let face = self.faces.iter().position(|face| face.reference == reference)?;
            Some(Of::Face { face, first, centre: self.deck.place_of_node(reference) })
        };
        let centres = self.faces.iter().filter_map(|face| Some((face.reference, of_face(face.reference, 0)?)));
        let turns = self
            .rotations
            .iter()
            .map(|(&node, &reference)| (node, of_face(reference, 3).unwrap_or(Of::Turns { point: number(reference) })));
        let nodes = centres.chain(turns).map(|(node, of)| ReferenceNode { number: number(node), of });
        Entries {
            rigid_faces: self.faces.iter().map(face).collect(),
            points: places.into_iter().map(point).collect(),
            springs: self.springs.iter().map(spring).collect(),
            nodes: nodes.collect(),
            ties: {
                let ties: Vec<SceneEntry> = self.equations.iter().map(tie).collect();
                self.bolts.into_iter().map(|bolt| bolt.preload).chain(ties).collect()
            },
            warnings: self.warnings,
        }
    }

    /// A rigid face or a reference point with the prescribed motions of its node, its force and its moment.
    fn moved(&self, mut entry: Value, node: usize) -> Value {
        for kind in Coupling::motions(self.deck) {
            if let Some(value) = self.prescribed.get(&(node, kind)) {
                let of = if kind < 3 { &mut entry } else { &mut entry["rotation"] };
                of[AXES[kind % 3]] = (*value).into();
            }
        }
        let load = |kind: usize| self.loads.get(&(node, kind)).map_or(0.0, |load| load.1);
        let (force, moment): (Vec<usize>, Vec<usize>) = Coupling::motions(self.deck).partition(|kind| *kind < 3);
        for (name, kinds) in [("force", force), ("moment", moment)] {
            let parts: Vec<f64> = kinds.into_iter().map(load).collect();
            if parts.iter().any(|&part| part != 0.0) {
                entry[name] = parts.into();
            }
        }
        entry
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

/// The nodes of a coupling as a scene names them, if they belong to one body and all follow in all directions.
fn following(deck: &Deck, coupling: &Coupling) -> Result<Option<(&'static str, Value)>, String> {
    let mut nodes = coupling.nodes(deck)?;
    nodes.retain(|&node| node != coupling.reference || deck.body_of_node[node].is_some());
    let body = nodes.first().and_then(|&node| deck.body_of_node[node]);
    if body.is_none() || nodes.iter().any(|&node| deck.body_of_node[node] != body) || !coupling.is_rigid(deck) {
        return Ok(None);
    }
    let by_number = || nodes.iter().filter_map(|&node| name_of_node(deck, node)).collect::<Vec<String>>();
    Ok(Some(match &coupling.nodes {
        Joined::Surface(name) => {
            let surface = deck.surface_or(name)?;
            // A boundary has the faces on the outside alone.
            match surface.bare.is_empty() && deck.outside_and_inside(surface).1.is_empty() {
                true => ("boundary", names_of_surface(deck, surface).remove(0).1.into()),
                false => ("nodes", by_number().into()),
            }
        }
        Joined::Nodes(set, _) if deck.nodes.sets.named(set).is_some() => {
            ("nodes", names_of_nodes(deck, set, &nodes).remove(0).into())
        }
        Joined::Nodes(..) => ("nodes", by_number().into()),
    }))
}

/// The components in equations and springs, with the places of these.
fn terms<'a>(equations: &'a [Equation], springs: &'a [Spring]) -> impl Iterator<Item = (Component, DeckPlace)> + 'a {
    let of_equations = equations.iter().map(|one| (&one.sum, one.place));
    let sums = of_equations.chain(springs.iter().map(|one| (&one.elongation, one.place)));
    sums.flat_map(|(sum, place)| sum.terms.keys().map(move |&component| (component, place)))
}

/// Returns `true` for a component that no element has.
fn is_loose(deck: &Deck, (node, kind): Component) -> bool {
    kind >= 3 || deck.body_of_node[node].is_none()
}

/// A reference node that is no reference point of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceNode {
    pub number: usize,
    pub of: Of,
}

/// The entry of the scene that a reference node moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Of {
    /// A rigid face about a centre. The directions of the node name its motions from this one: 0 for displacements, 3
    /// for rotations.
    Face { face: usize, first: usize, centre: [f64; 3] },
    /// The rotations of the reference point of this number.
    Turns { point: usize },
}
