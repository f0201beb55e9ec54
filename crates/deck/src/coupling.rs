//! Couplings: the cards *RIGID BODY, and *COUPLING, each followed by *KINEMATIC or *DISTRIBUTING, as equations between
//! nodes and the displacement U and the rotation R of a reference node.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.20, keywords *COUPLING, *KINEMATIC, *DISTRIBUTING.

use std::collections::BTreeSet;

use signorini_fem::Error;
use signorini_fem::mesh::deck::{DataFields, Deck, DeckCard, DeckPlace};
use signorini_fem::sum::{Sum, following, mean};

/// A sum that is zero. Its components are those of the nodes of the deck; a node without elements has its displacements
/// along its local axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Equation {
    pub sum: Sum,
    pub place: DeckPlace,
}

/// How a coupling joins the nodes of its surface to the reference node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CouplingKind {
    /// Displacements along these axes follow the rigid motion of the reference node.
    Kinematic([bool; 3]),
    /// The reference node follows the mean motion, in its displacement and in rotations about these axes.
    Distributing([bool; 3]),
}

/// The nodes that a coupling joins to its reference node.
#[derive(Clone, Debug)]
pub(super) enum Joined {
    /// Those of the surface of this name.
    Surface(String),
    /// Those of a set, with its name.
    Nodes(String, Vec<usize>),
}

/// A reference node that is joined to other nodes.
#[derive(Clone, Debug)]
pub(super) struct Coupling {
    pub reference: usize,
    /// The node whose displacements are the rotations of the reference node, if they have one of their own.
    pub rotation: Option<usize>,
    pub nodes: Joined,
    pub kind: CouplingKind,
    pub place: DeckPlace,
}

/// The couplings of a deck, rigid bodies first.
pub(super) fn couplings(deck: &Deck) -> Result<Vec<Coupling>, Error> {
    let rigid_bodies = deck.source.cards_of("RIGIDBODY");
    let rigid_bodies = rigid_bodies.map(|card| card.placed(rigid_body(deck, card)));
    let mut couplings = rigid_bodies.collect::<Result<Vec<Coupling>, Error>>()?;
    let mut open: Option<DeckCard> = None;
    for card in deck.source.cards() {
        let is_kind = card.is_any(&["KINEMATIC", "DISTRIBUTING"]);
        match open.take() {
            Some(of) if is_kind => couplings.push(coupling(deck, of, card)?),
            Some(of) => return Err(of.fault("*KINEMATIC or *DISTRIBUTING must follow *COUPLING")),
            None if is_kind => {
                let message = format!("{} must follow *COUPLING, which names the nodes", card.name);
                return Err(card.fault(message));
            }
            None => open = Some(card).filter(|card| card.is("COUPLING")),
        }
    }
    match open {
        Some(of) => Err(of.fault("*KINEMATIC or *DISTRIBUTING must follow *COUPLING")),
        None => Ok(couplings),
    }
}

/// All displacements of the nodes of a card *RIGID BODY follow its reference node.
fn rigid_body(deck: &Deck, card: DeckCard) -> Result<Coupling, String> {
    let (name, mut nodes) = match [card.value("NSET"), card.value("ELSET")] {
        [Some(set), None] => (set, deck.nodes.members(set)?),
        [None, Some(set)] => {
            let elements = deck.elements.members(set)?;
            let nodes: BTreeSet<usize> = elements.iter().flat_map(|&element| deck.nodes_of(element)).copied().collect();
            ("", nodes.into_iter().collect())
        }
        _ => {
            return Err(
                "*RIGID BODY is read with one set, of nodes or of elements; write NSET=NAME or ELSET=NAME".into()
            );
        }
    };
    let reference = |parameter: &str| match card.value(parameter) {
        None => Ok(None),
        Some(value) => match deck.nodes.members(value)?[..] {
            [node] => Ok(Some(node)),
            _ => Err(format!("{parameter}={value} is not one node")),
        },
    };
    let (Some(centre), rotation) = (reference("REFNODE")?, reference("ROTNODE")?) else {
        return Err("*RIGID BODY has no reference node; write REF NODE=NUMBER".into());
    };
    if rotation.is_some_and(|node| node == centre || deck.body_of_node[node].is_some()) {
        return Err("ROT NODE must be a node of its own, which belongs to no element".into());
    }
    // The reference nodes do not follow themselves.
    nodes.retain(|&node| deck.body_of_node[node].is_some() || (node != centre && Some(node) != rotation));
    if nodes.iter().all(|&node| deck.body_of_node[node].is_none()) {
        return Err("the set of *RIGID BODY has no nodes of elements; nothing would follow the reference node".into());
    }
    let (nodes, kind) = (Joined::Nodes(name.into(), nodes), CouplingKind::Kinematic([true; 3]));
    Ok(Coupling { reference: centre, rotation, nodes, kind, place: card.place })
}

fn coupling(deck: &Deck, of: DeckCard, kind: DeckCard) -> Result<Coupling, Error> {
    let fault = |message: String| of.fault(message);
    let wanted = |name: &str| of.value(name).filter(|value| !value.is_empty());
    let Some(target) = wanted("REFNODE") else {
        return Err(fault("*COUPLING has no reference node; write REF NODE=NUMBER".into()));
    };
    let [reference] = deck.nodes.members(target).map_err(fault)?[..] else {
        return Err(fault(format!("the set `{target}` is no reference node: it must have one node")));
    };
    let Some(surface) = wanted("SURFACE") else {
        return Err(fault("*COUPLING has no surface; write SURFACE=NAME".into()));
    };
    let found = deck.surface_or(surface).map_err(fault)?;
    let directions: Vec<[usize; 2]> = kind.fields().map(range).collect::<Result<_, _>>()?;
    let named = |axis: usize| directions.iter().any(|[first, last]| (*first..=*last).contains(&axis));
    let fault = |message: &str| Err(kind.fault(message));
    let kind = match kind.is("KINEMATIC") {
        true if directions.is_empty() => CouplingKind::Kinematic([true; 3]),
        true => CouplingKind::Kinematic([1, 2, 3].map(named)),
        false if directions.is_empty() => return fault("*DISTRIBUTING names no directions; write 1, 3 or 1, 6"),
        false => CouplingKind::Distributing([4, 5, 6].map(named)),
    };
    match kind {
        CouplingKind::Kinematic([false, false, false]) => {
            fault("*KINEMATIC names no direction 1, 2 or 3; nodes of a solid have no rotations that could follow")
        }
        CouplingKind::Distributing(_) if !found.bare.is_empty() => {
            fault("*DISTRIBUTING needs a surface of faces, because forces are distributed over areas")
        }
        CouplingKind::Distributing(_) if deck.body_of_node[reference].is_some() => {
            fault("the reference node of *DISTRIBUTING must belong to no element")
        }
        _ => {
            let nodes = Joined::Surface(surface.into());
            Ok(Coupling { reference, rotation: None, nodes, kind, place: of.place })
        }
    }
}

/// The first and the last direction of a line.
fn range(mut fields: DataFields) -> Result<[usize; 2], Error> {
    let first = fields.whole("the first direction")?;
    let last = if fields.clone().text().is_some() { fields.whole("the last direction")? } else { first };
    match first >= 1 && first <= last && last <= 6 {
        true => Ok([first, last]),
        false => Err(fields.fault(format!("directions {first} to {last} are none; there are 1 to 6"))),
    }
}

impl Coupling {
    /// The nodes that move it: the reference node, and that of its rotations if it has one.
    pub fn references(&self) -> impl Iterator<Item = usize> + use<> {
        std::iter::once(self.reference).chain(self.rotation)
    }

    /// Returns `true` if all displacements of the nodes follow.
    pub fn is_rigid(&self, deck: &Deck) -> bool {
        matches!(self.kind, CouplingKind::Kinematic(axes) if axes[..deck.dimension()].iter().all(|follows| *follows))
    }

    pub fn equations(&self, deck: &Deck) -> Result<Vec<Equation>, Error> {
        let fault = |message: String| deck.fault(self.place, message);
        if deck.is_axisymmetric() {
            let message = "in an axisymmetric model only *RIGID BODY and *KINEMATIC with directions 1, 2 are read, on nodes of one body, with a \
                           reference node that nothing else names";
            return Err(fault(message.into()));
        }
        let sums = match self.kind {
            CouplingKind::Kinematic(axes) => self.kinematic(deck, axes).map_err(fault)?,
            CouplingKind::Distributing(about) => self.distributing(deck, about).map_err(fault)?,
        };
        Ok(sums.into_iter().map(|sum| Equation { sum, place: self.place }).collect())
    }

    /// The nodes that it joins, by their places.
    pub fn nodes(&self, deck: &Deck) -> Result<Vec<usize>, String> {
        match &self.nodes {
            Joined::Surface(name) => Ok(deck.nodes_of_surface(deck.surface_or(name)?)),
            Joined::Nodes(_, nodes) => Ok(nodes.clone()),
        }
    }

    /// The rotations of this model.
    fn turns(deck: &Deck) -> &'static [usize] {
        if deck.dimension() == 3 { &[0, 1, 2] } else { &[2] }
    }

    /// The motions of a reference node in this model: displacements along x, y and z, then rotations from 3.
    pub fn motions(deck: &Deck) -> impl Iterator<Item = usize> + Clone {
        (0..deck.dimension()).chain(Self::turns(deck).iter().map(|turn| 3 + turn))
    }

    /// u_k = U_k + (R x r)_k at each node, with r from the reference node.
    fn kinematic(&self, deck: &Deck, axes: [bool; 3]) -> Result<Vec<Sum>, String> {
        let axes: Vec<usize> = (0..deck.dimension()).filter(|&axis| axes[axis]).collect();
        let centre = (self.reference, deck.place_of_node(self.reference));
        let of_node = |node: usize| following((node, deck.place_of_node(node)), centre, &axes, Self::turns(deck));
        Ok(self.nodes(deck)?.into_iter().flat_map(of_node).collect())
    }

    /// The reference node follows the mean over the areas of a surface.
    fn distributing(&self, deck: &Deck, about: [bool; 3]) -> Result<Vec<Sum>, String> {
        let Joined::Surface(surface) = &self.nodes else {
            return Err("forces are distributed over a surface of faces".into());
        };
        let areas = deck.areas(&deck.surface_or(surface)?.faces);
        let areas: Vec<_> = areas.into_iter().map(|(node, (area, _))| (node, area, deck.place_of_node(node))).collect();
        let turns = Self::turns(deck).iter().copied().filter(|&axis| about[axis]).map(|axis| 3 + axis);
        let kinds: Vec<usize> = (0..deck.dimension()).chain(turns).collect();
        mean(&areas, (self.reference, deck.place_of_node(self.reference)), &kinds, deck.dimension() == 2)
            .ok_or_else(|| format!("the nodes of the surface `{surface}` lie on a line, about which no moment acts"))
    }
}
