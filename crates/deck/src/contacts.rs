//! Contacts: the cards *CONTACT PAIR, with their interactions and clearances.

use std::collections::HashMap;

use super::bodies::side;
use super::keywords::{SceneEntry, object};
use serde_json::{Value, json};
use signorini_fem::mesh::deck::{Deck, DeckCard, DeckPlace, key};
use signorini_fem::{Error, nearly};

/// The contacts of a scene, and what a reader should know of them.
pub(super) struct Contacts {
    pub obstacles: Vec<SceneEntry>,
    pub ties: Vec<SceneEntry>,
    pub warnings: Vec<(DeckPlace, String)>,
}

/// The obstacles of a scene; a deck with friction is refused unless it `may_rub`, and is then solved without it.
pub(super) fn contacts(deck: &Deck, may_rub: bool) -> Result<Contacts, Error> {
    let mut found = Contacts { obstacles: Vec::new(), ties: Vec::new(), warnings: Vec::new() };
    let interactions = interactions(deck, may_rub, &mut found.warnings)?;
    let clearances = clearances(deck)?;
    let mut used = vec![false; clearances.len()];
    for card in deck.source.cards_of("CONTACTPAIR") {
        let interaction = card.value("INTERACTION").unwrap_or_default();
        let Some(&is_tied) = interactions.get(&key(interaction)) else {
            let meant = nearly(&key(interaction), interactions.keys().map(String::as_str));
            return Err(card.fault(format!("there is no *SURFACE INTERACTION `{interaction}`{meant}")));
        };
        if let Some(kind) = card.value("TYPE").filter(|kind| !IS_READ.contains(&key(kind).as_str())) {
            return Err(card.fault(format!("contacts of TYPE={kind} are not read; there are {}", IS_READ.join(", "))));
        }
        let adjust = distance(card, "ADJUST", TOUCH)?;
        for mut fields in card.fields() {
            let pair = [fields.text().unwrap_or_default(), fields.text().unwrap_or_default()];
            fields.end()?;
            if is_tied {
                found.ties.push(surfaces(deck, &pair, adjust, fields.place)?);
                continue;
            }
            let mut sides = Vec::with_capacity(2);
            for name in &pair {
                sides.push(fields.placed(side(deck, name))?);
            }
            if sides[0].0 == sides[1].0 {
                let message = format!(
                    "`{}` and `{}` belong to one body; the contact of a body with itself is not modelled",
                    pair[0], pair[1]
                );
                return Err(fields.fault(message));
            }
            let mut facing = json!({"boundary": sides[1].1});
            let clearance =
                clearances.iter().position(|clearance| clearance.pair == pair.each_ref().map(|name| key(name)));
            if let Some(clearance) = clearance {
                used[clearance] = true;
                facing["fit"] = clearances[clearance].fit();
            } else if let Some(reach) = adjust {
                facing["fit"] = json!({"clearance": 0.0});
                facing["reach"] = reach.into();
                let message = format!(
                    "ADJUST: the surfaces `{}` and `{}` have the distance 0 where they are within {reach} of each other; other nodes have \
                     no contact row",
                    pair[0], pair[1]
                );
                found.warnings.push((card.place, message));
            }
            let obstacle = json!({"boundary": sides[0].1, "rule": "closest-point", "shape": {"body": facing}});
            found.obstacles.push(SceneEntry::new(obstacle, fields.place));
        }
    }
    match used.iter().position(|used| !used) {
        Some(unused) => Err(deck.fault(clearances[unused].place, "no *CONTACT PAIR has these surfaces in this order")),
        None => Ok(found),
    }
}

/// What the distance of ADJUST is, and what says another.
const TOUCH: &str = " within which surfaces touch; *CLEARANCE says another distance";

/// The types of contact pairs that hard contact answers.
const IS_READ: [&str; 4] = ["NODETOSURFACE", "SURFACETOSURFACE", "MORTAR", "LINMORTAR"];

/// The distance that a card gives under a name; `sense` goes on with what it must be.
fn distance(card: DeckCard, name: &str, sense: &str) -> Result<Option<f64>, Error> {
    let Some(value) = card.value(&key(name)) else { return Ok(None) };
    let message = || format!("{name}={value} is not read; it must be a positive distance{sense}");
    let distance = value.parse().ok().filter(|distance: &f64| *distance > 0.0 && distance.is_finite());
    distance.map(Some).ok_or_else(|| card.fault(message()))
}

/// The interactions by their names in capitals; `true` for those that tie.
fn interactions(
    deck: &Deck,
    may_rub: bool,
    warnings: &mut Vec<(DeckPlace, String)>,
) -> Result<HashMap<String, bool>, Error> {
    let mut all = HashMap::new();
    let mut last = String::new();
    for card in deck.source.cards() {
        if card.is("SURFACEINTERACTION") {
            let name = card.named()?;
            last = key(name);
            if all.insert(last.clone(), is_tied(card)).is_some() {
                return Err(card.fault(format!("there are two interactions `{name}`")));
            }
        } else if card.is_any(&["SURFACEBEHAVIOR", "FRICTION"]) && all.is_empty() {
            return Err(card.fault(format!("{} follows no *SURFACE INTERACTION", card.name)));
        } else if card.is("SURFACEBEHAVIOR") {
            warnings.extend(behaviour(card)?.map(|message| (card.place, message)));
        } else if card.is("FRICTION") && all.get(&last) == Some(&false) {
            warnings.extend(friction(card, may_rub)?.map(|message| (card.place, message)));
        }
    }
    Ok(all)
}

/// Returns `true` for an interaction, by its first card, whose behaviour is to tie.
fn is_tied(first: DeckCard) -> bool {
    let own = first.source.cards().skip_while(|card| card.place != first.place).skip(1);
    let mut own = own.take_while(|card| card.is_any(&["SURFACEBEHAVIOR", "FRICTION"]));
    own.any(|card| card.says("PRESSURE-OVERCLOSURE", "TIED"))
}

/// The warning for a contact that is soft in the deck.
fn behaviour(card: DeckCard) -> Result<Option<String>, Error> {
    let law = card.value("PRESSURE-OVERCLOSURE").map_or_else(|| "HARD".into(), key);
    let mut values = Vec::new();
    for mut fields in card.fields() {
        while fields.clone().next().is_some() {
            values.push(fields.finite_or_zero("a value of the contact")?.to_string());
        }
    }
    match law.as_str() {
        // The values are those with which CalculiX approximates hard contact.
        "HARD" => Ok(None),
        "TIED" => Ok(Some(format!(
            "{} with PRESSURE-OVERCLOSURE=TIED ({}) is answered by surfaces that move together; its stiffness is not needed",
            card.name,
            values.join(", ")
        ))),
        "LINEAR" | "EXPONENTIAL" | "TABULAR" => Ok(Some(format!(
            "{} with PRESSURE-OVERCLOSURE={law} ({}) is answered by hard contact: its stiffness is not needed, and surfaces do not overlap",
            card.name,
            values.join(", ")
        ))),
        _ => {
            let message = format!(
                "PRESSURE-OVERCLOSURE={law} is not modelled; there are HARD, LINEAR, EXPONENTIAL, TABULAR and TIED"
            );
            Err(card.fault(message))
        }
    }
}

/// The warning for friction that is left out.
fn friction(card: DeckCard, may_rub: bool) -> Result<Option<String>, Error> {
    let Some(mut fields) = card.fields().next() else { return Err(card.fault("*FRICTION has no values")) };
    let coefficient = fields.finite("the coefficient of friction")?;
    match coefficient {
        0.0 => Ok(None),
        _ if may_rub => Ok(Some(format!(
            "the friction of {coefficient} is left out (--without-friction): the answer is that of a frictionless contact"
        ))),
        _ => {
            let message = format!(
                "*FRICTION of {coefficient} changes the answer and is not modelled; --without-friction solves the deck without it"
            );
            Err(fields.fault(message))
        }
    }
}

/// The distance of two surfaces that *CLEARANCE prescribes.
struct Clearance {
    /// Slave and master, in capitals.
    pair: [String; 2],
    value: f64,
    place: DeckPlace,
}

impl Clearance {
    fn fit(&self) -> Value {
        match self.value < 0.0 {
            true => json!({"interference": -self.value}),
            false => json!({"clearance": self.value}),
        }
    }
}

fn clearances(deck: &Deck) -> Result<Vec<Clearance>, Error> {
    let mut clearances = Vec::new();
    for card in deck.source.cards_of("CLEARANCE") {
        let (Some(slave), Some(master)) = (card.value("SLAVE"), card.value("MASTER")) else {
            return Err(card.fault("*CLEARANCE needs SLAVE=NAME and MASTER=NAME"));
        };
        let value = card.value("VALUE").and_then(|value| value.parse::<f64>().ok()).filter(|value| value.is_finite());
        let Some(value) = value else {
            return Err(card.fault("*CLEARANCE needs VALUE=NUMBER"));
        };
        clearances.push(Clearance { pair: [key(slave), key(master)], value, place: card.place });
    }
    Ok(clearances)
}

// Preloads of bolts: the cards *PRE-TENSION SECTION. Their reference nodes are points of the scene, which have the
// tension or the shortening. Ties: the cards *TIE.

/// A cut through a bolt.
pub(super) struct Bolt {
    /// The node whose direction 1 is the shortening.
    pub reference: usize,
    /// What it is in the scene.
    pub preload: SceneEntry,
}

pub(super) fn bolts(deck: &Deck) -> Result<Vec<Bolt>, Error> {
    let mut bolts: Vec<Bolt> = Vec::new();
    for (card, names) in deck.source.cards_of("PRE-TENSIONSECTION").zip(&deck.cuts) {
        let reference = card.placed(reference(deck, card))?;
        let number = deck.nodes.numbers[reference].to_string();
        if bolts.iter().any(|bolt| bolt.reference == reference) {
            return Err(card.fault(format!("node {number} is the reference of two bolts")));
        }
        let [boundary, to] = names.each_ref().map(|name| card.placed(side(deck, name)));
        let mut preload = json!({"boundary": boundary?.1, "to": to?.1, "point": number});
        if let Some(direction) = direction(card)? {
            preload["direction"] = direction[..deck.dimension()].into();
        }
        bolts.push(Bolt { reference, preload: SceneEntry::new(object("preload", preload), card.place) });
    }
    Ok(bolts)
}

/// The node of a card, which belongs to no element.
fn reference(deck: &Deck, card: DeckCard) -> Result<usize, String> {
    let Some(value) = card.value("NODE") else {
        return Err("*PRE-TENSION SECTION has no reference node; write NODE=NUMBER".into());
    };
    let number = value.parse().map_err(|_| format!("NODE={value} is not the number of a node"))?;
    let node = deck.nodes.place(number).ok_or_else(|| format!("the deck has no node {number}"))?;
    match deck.body_of_node[node] {
        None => Ok(node),
        Some(_) => Err(format!("node {number} belongs to an element; the reference node of a bolt belongs to none")),
    }
}

/// The direction of a card, from the elements of its surface to those behind.
fn direction(card: DeckCard) -> Result<Option<[f64; 3]>, Error> {
    let Some(mut fields) = card.fields().next() else { return Ok(None) };
    let direction = fields.vector("the direction")?;
    fields.end()?;
    match (direction == [0.0; 3], card.fields().nth(1)) {
        (false, None) => Ok(Some(direction)),
        (true, _) => Err(fields.fault("the direction of the bolt has no length")),
        (_, Some(second)) => Err(second.fault("*PRE-TENSION SECTION has one line, with the direction")),
    }
}

/// The tied surfaces of a scene.
pub(super) fn ties(deck: &Deck) -> Result<Vec<SceneEntry>, Error> {
    let mut ties = Vec::new();
    for card in deck.source.cards_of("TIE") {
        let reach = distance(card, "POSITION TOLERANCE", "")?;
        for mut fields in card.fields() {
            let pair = [fields.text().unwrap_or_default(), fields.text().unwrap_or_default()];
            fields.end()?;
            ties.push(surfaces(deck, &pair, reach, fields.place)?);
        }
    }
    Ok(ties)
}

/// Two tied surfaces, slave and master, within a distance.
pub(super) fn surfaces(
    deck: &Deck,
    pair: &[String; 2],
    reach: Option<f64>,
    place: DeckPlace,
) -> Result<SceneEntry, Error> {
    let [slave, master] = pair.each_ref().map(|name| side(deck, name));
    let fault = |message: String| deck.fault(place, message);
    let (slave, master) = (slave.map_err(fault)?, master.map_err(fault)?);
    let mut tied = json!({"boundary": slave.1, "to": master.1});
    if let Some(reach) = reach {
        tied["reach"] = reach.into();
    }
    Ok(SceneEntry::new(json!({"surfaces": tied}), place))
}
