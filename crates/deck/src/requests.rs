//! What a deck asks for in the files of results: the cards *NODE FILE, *EL FILE, *CONTACT FILE, *NODE PRINT, *EL PRINT,
//! *CONTACT PRINT.

use std::collections::{BTreeSet, HashMap};

use super::amplitudes::{Amplitudes, Temperatures, periods};
use super::contacts::bolts;
use super::coupling::couplings;
use super::references::ReferenceNode;
use super::transforms::Transforms;
use signorini_fem::Error;
use signorini_fem::mesh::deck::{Deck, DeckCard, DeckPlace, key};

/// The results that a deck asks for, under the labels of CalculiX in capitals.
#[derive(Clone, Debug, PartialEq)]
pub struct Requests {
    /// Labels of fields: `U`, `RF`, `S`, `E`, `CDIS` and so on.
    pub fields: BTreeSet<String>,
    /// Tables, in the order of the deck.
    pub tables: Vec<RequestedTable>,
    /// The places of the cards that ask for a kind of result that has no field and no table here, as
    /// `*SECTION PRINT (line 7)`.
    pub others: Vec<String>,
    /// The temperature at the end of the step by the number of its node, in the order of the deck; 0 where the deck
    /// gives none.
    pub temperatures: Vec<(usize, f64)>,
    /// The local axes of nodes by their numbers, each of unit length.
    pub axes: HashMap<usize, [[f64; 3]; 3]>,
    /// The number of the step whose end it is, from 1.
    pub step: usize,
    /// Number of steps of the deck.
    pub steps: usize,
    /// The nodes that are no nodes of the mesh, but move or are moved.
    pub references: Vec<ReferenceNode>,
    /// The time at the end of the step, since the start of the first one.
    pub time: f64,
    /// The time that the step takes.
    pub period: f64,
}

/// One result of the nodes or elements of a set, or of contacts, in rows.
#[derive(Clone, Debug, PartialEq)]
pub struct RequestedTable {
    /// `U`, `RF`, `S`, `E`, `EVOL`, `ELSE`, `CDIS`, `CSTR`, `CF` and so on.
    pub label: String,
    /// The line of the deck that asks for it, as `line 7`.
    pub place: String,
    /// The name of the set in capitals; empty for a contact.
    pub set: String,
    /// The numbers of its nodes or elements, in the order of the deck; empty for a contact.
    pub numbers: Vec<usize>,
    /// `true` if the value of each node or element is asked for.
    pub parts: bool,
    /// `true` if the sum of all is asked for.
    pub totals: bool,
    /// `true` if vectors are along the local axes of their nodes.
    pub is_local: bool,
    /// Slave and master of one contact, as the card names them; `None` for all contacts.
    pub contact: Option<[String; 2]>,
}

/// The cards of each kind of request: three kinds ask for fields, the others for tables.
const KINDS: [&[&str]; 6] = [
    &["NODEFILE", "NODEOUTPUT"],
    &["ELFILE", "ELEMENTOUTPUT"],
    &["CONTACTFILE", "CONTACTOUTPUT"],
    &["NODEPRINT"],
    &["ELPRINT"],
    &["CONTACTPRINT"],
];

/// The cards that ask for results of another kind.
const OTHERS: [&str; 4] = ["FACEPRINT", "SECTIONPRINT", "SECTIONFILE", "ENERGYPRINT"];

impl Requests {
    /// What a deck asks for at the end of its step; `references` are its reference nodes.
    pub fn of(deck: &Deck, references: Vec<ReferenceNode>) -> Result<Self, Error> {
        let end = Temperatures::of(deck, &Amplitudes::of(deck)?)?.end;
        let temperatures = deck.nodes.numbers.iter().copied().zip(end).collect();
        let transforms = Transforms::of(deck, &couplings(deck)?, &bolts(deck)?)?;
        let (fields, tables, others) = (BTreeSet::new(), Vec::new(), Vec::new());
        let (axes, periods) = (transforms.by_number(deck), periods(deck)?);
        let (time, period) = (periods.iter().sum(), periods.last().copied().unwrap_or(1.0));
        let (step, steps) = (deck.step, deck.steps);
        let mut requests =
            Requests { fields, tables, others, temperatures, axes, step, steps, references, time, period };
        for card in deck.source.cards() {
            let place = || format!("{} ({})", card.name, deck.source.named(card.place));
            match KINDS.iter().position(|keywords| card.is_any(keywords)) {
                // The requests of a kind in a later step replace those of the steps before it.
                Some(kind) if deck.source.cards().any(|other| other.step > card.step && other.is_any(KINDS[kind])) => {}
                Some(kind) if kind >= 3 => requests.add_tables(deck, card)?,
                Some(_) => {
                    requests.fields.extend(labels(card).into_iter().map(|(label, _)| label));
                    if card.says("GLOBAL", "NO") && !requests.axes.is_empty() {
                        requests.others.push(format!("GLOBAL=NO of {}", place()));
                    }
                }
                None if card.is_any(&OTHERS) => requests.others.push(place()),
                None => {}
            }
        }
        Ok(requests)
    }

    fn add_tables(&mut self, deck: &Deck, card: DeckCard) -> Result<(), Error> {
        let of = match card {
            _ if card.is("NODEPRINT") => Some(("NSET", &deck.nodes)),
            _ if card.is("ELPRINT") => Some(("ELSET", &deck.elements)),
            _ => None,
        };
        let (mut set, mut numbers) = (String::new(), Vec::new());
        if let Some((parameter, of)) = of {
            let Some(name) = card.value(parameter) else {
                return Err(card.fault(format!("{} names no set; write {parameter}=NAME", card.name)));
            };
            let place = deck.source.named(card.place);
            if card.is("ELPRINT") && deck.spring_numbers.has(name) {
                self.others.push(format!("values of springs ({place})"));
                return Ok(());
            }
            set = key(name);
            numbers = card.placed(of.members(name))?.into_iter().map(|member| of.numbers[member]).collect();
        }
        let contact = match [card.value("SLAVE"), card.value("MASTER")] {
            [Some(slave), Some(master)] => Some([slave.to_string(), master.to_string()]),
            _ => None,
        };
        let (parts, totals) = match card.value("TOTALS").map(key).as_deref() {
            None | Some("NO") => (true, false),
            Some("YES") => (true, true),
            Some("ONLY") => (false, true),
            Some(other) => return Err(card.fault(format!("TOTALS={other} of {} must be NO, YES or ONLY", card.name))),
        };
        for (label, place) in labels(card) {
            let (place, set, numbers) = (deck.source.named(place), set.clone(), numbers.clone());
            let (is_local, contact) = (!card.says("GLOBAL", "YES"), contact.clone());
            self.tables.push(RequestedTable { label, place, set, numbers, parts, totals, is_local, contact });
        }
        Ok(())
    }
}

fn labels(card: DeckCard) -> Vec<(String, DeckPlace)> {
    let mut labels = Vec::new();
    for fields in card.fields() {
        let place = fields.place;
        let all = fields.map(|field| key(&String::from_utf8_lossy(field)));
        labels.extend(all.filter(|label| !label.is_empty()).map(|label| (label, place)));
    }
    labels
}
