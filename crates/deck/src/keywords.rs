//! The cards of a deck: those that are read, with their parameters, those that change no answer, and those that are
//! refused by name.

use std::fmt::Write;

use serde_json::{Map, Value};
use signorini_fem::Error;
use signorini_fem::mesh::deck::{Deck, DeckCard, DeckPlace, cut, key};
use signorini_fem::number;

/// A keyword that is read, in capitals without blanks.
struct Read {
    keyword: &'static str,
    parameters: &'static [&'static str],
    /// Its parameters that change no answer.
    passed: &'static [&'static str],
}

const fn read(keyword: &'static str, parameters: &'static [&'static str], passed: &'static [&'static str]) -> Read {
    Read { keyword, parameters, passed }
}

const READ: [Read; 37] = [
    read("HEADING", &[], &[]),
    read("NODE", &["NSET"], &[]),
    read("ELEMENT", &["TYPE", "ELSET"], &[]),
    read("NSET", &["NSET", "GENERATE", "ELSET"], &["INTERNAL", "UNSORTED"]),
    read("ELSET", &["ELSET", "GENERATE"], &["INTERNAL", "UNSORTED"]),
    read("SURFACE", &["NAME", "TYPE"], &["INTERNAL"]),
    read("MATERIAL", &["NAME"], &[]),
    read("ELASTIC", &["TYPE"], &[]),
    read("DENSITY", &[], &[]),
    read("EXPANSION", &["TYPE", "ZERO"], &[]),
    read("SOLIDSECTION", &["ELSET", "MATERIAL", "ORIENTATION"], &[]),
    read("ORIENTATION", &["NAME", "SYSTEM"], &[]),
    read("BOUNDARY", &["OP", "AMPLITUDE", "TYPE", "FIXED"], &[]),
    read("CLOAD", &["OP", "AMPLITUDE"], &[]),
    read("DLOAD", &["OP", "AMPLITUDE"], &[]),
    read("DSLOAD", &["OP", "AMPLITUDE"], &[]),
    read("TEMPERATURE", &["OP", "AMPLITUDE"], &[]),
    read("INITIALCONDITIONS", &["TYPE"], &[]),
    read("AMPLITUDE", &["NAME", "TIME"], &[]),
    read("CONTACTPAIR", &["INTERACTION", "TYPE", "ADJUST"], &["SMALLSLIDING"]),
    read("SURFACEINTERACTION", &["NAME"], &[]),
    read("SURFACEBEHAVIOR", &["PRESSURE-OVERCLOSURE"], &[]),
    read("FRICTION", &[], &[]),
    read("CLEARANCE", &["MASTER", "SLAVE", "VALUE"], &[]),
    read("TIE", &["POSITIONTOLERANCE"], &["NAME", "ADJUST"]),
    read("EQUATION", &[], &[]),
    read("TRANSFORM", &["NSET", "TYPE"], &[]),
    read("RIGIDBODY", &["NSET", "ELSET", "REFNODE", "ROTNODE"], &[]),
    read("PRE-TENSIONSECTION", &["SURFACE", "NODE"], &[]),
    read("COUPLING", &["REFNODE", "SURFACE"], &["CONSTRAINTNAME"]),
    read("KINEMATIC", &[], &[]),
    read("DISTRIBUTING", &[], &[]),
    read("SPRING", &["ELSET"], &[]),
    read("MPC", &[], &[]),
    read("STEP", &["NLGEOM"], &["INC", "AMPLITUDE", "NAME"]),
    read("STATIC", &[], &["SOLVER", "DIRECT", "TIMERESET", "TOTALTIMEATSTART"]),
    read("ENDSTEP", &[], &[]),
];

/// Keywords that change only output or iterations, or what an equilibrium does not depend on.
const PASSED: [&str; 22] = [
    "OUTPUT",
    "NODEOUTPUT",
    "ELEMENTOUTPUT",
    "CONTACTOUTPUT",
    "NODEFILE",
    "ELFILE",
    "CONTACTFILE",
    "SECTIONFILE",
    "NODEPRINT",
    "ELPRINT",
    "FACEPRINT",
    "CONTACTPRINT",
    "SECTIONPRINT",
    "ENERGYPRINT",
    "MONITOR",
    "PREPRINT",
    "CONTROLS",
    "TIMEPOINTS",
    "PHYSICALCONSTANTS",
    "CONDUCTIVITY",
    "SPECIFICHEAT",
    "DAMPING",
];

/// Keywords that change the answer, with the thing that is not modelled.
const ABSENT: [(&[&str], &str); 24] = [
    (&["DISTRIBUTINGCOUPLING"], "write *COUPLING with *DISTRIBUTING instead, which distributes over areas"),
    (&["DASHPOT"], "dampers are not modelled"),
    (&["GAP"], "gap elements are not modelled"),
    (&["MASS"], "point masses are not modelled"),
    (&["CYCLICSYMMETRYMODEL"], "cyclic symmetry is not modelled"),
    (&["SHELLSECTION"], "shells are not modelled"),
    (&["BEAMSECTION", "BEAMGENERALSECTION"], "beams are not modelled"),
    (&["MEMBRANESECTION"], "membranes are not modelled"),
    (&["FLUIDSECTION"], "fluids are not modelled"),
    (
        &["PLASTIC", "CYCLICHARDENING", "DEFORMATIONPLASTICITY"],
        "plasticity is not modelled, every material is linear elastic",
    ),
    (&["CREEP", "VISCO"], "creep is not modelled, every material is linear elastic"),
    (&["HYPERELASTIC", "HYPERFOAM"], "hyperelasticity is not modelled, every material is linear elastic"),
    (&["USERMATERIAL"], "materials of users are not modelled"),
    (&["DYNAMIC", "MODALDYNAMIC"], "motions of decks are not read; a scene has an `analysis`"),
    (&["STEADYSTATEDYNAMICS"], "vibrations are not computed"),
    (
        &["FREQUENCY"],
        "natural frequencies are those of a scene; write *STATIC in its place, turn the deck into one by `signorini new`, and solve that by \
         `signorini modes`",
    ),
    (&["BUCKLE"], "buckling is not computed"),
    (
        &["HEATTRANSFER", "COUPLEDTEMPERATURE-DISPLACEMENT", "UNCOUPLEDTEMPERATURE-DISPLACEMENT"],
        "heat is not modelled; temperatures may be given",
    ),
    (&["MODELCHANGE"], "bodies and contacts that change between steps are not modelled"),
    (&["CHANGEFRICTION"], "friction is not modelled"),
    (&["SUBMODEL"], "submodels are not modelled"),
    (&["PART"], "parts and instances of Abaqus are not read; write the deck for CalculiX, without *PART"),
    (&["INSTANCE"], "parts and instances of Abaqus are not read; write the deck for CalculiX, without *INSTANCE"),
    (&["ASSEMBLY"], "parts and instances of Abaqus are not read; write the deck for CalculiX, without *ASSEMBLY"),
];

/// The cards that have no data lines.
const BARE: [&str; 6] = ["MATERIAL", "STEP", "ENDSTEP", "CLEARANCE", "RIGIDBODY", "COUPLING"];

/// The cards that stand only in a step.
const OF_STEP: [&str; 6] = ["CLOAD", "DLOAD", "DSLOAD", "TEMPERATURE", "STATIC", "ENDSTEP"];

/// Checks every card of a deck and the order of its steps; returns the names of what is passed over, each once with its
/// first place. What may not be meant is added to `noted`.
pub(super) fn judged(deck: &Deck, noted: &mut Vec<(DeckPlace, String)>) -> Result<Vec<(String, DeckPlace)>, Error> {
    let mut passed: Vec<(String, DeckPlace)> = Vec::new();
    let mut pass = |name: String, place: DeckPlace| {
        if passed.iter().all(|(other, _)| *other != name) {
            passed.push((name, place));
        }
    };
    // The open step, and whether it has *STATIC.
    let (mut open, mut is_static): (Option<DeckCard>, bool) = (None, false);
    let cards = deck.source.cards.iter().chain(&deck.later).map(|card| DeckCard { source: &deck.source, card });
    let last = cards.clone().next_back().map(|card| card.place);
    for card in cards {
        let fault = |message: String| Err(card.fault(message));
        if card.is_any(&PASSED) {
            pass(card.name.clone(), card.place);
            continue;
        }
        let Some(known) = READ.iter().find(|known| card.is(known.keyword)) else { return fault(refusal(card)) };
        for (name, value) in &card.parameters {
            let has = |names: &[&str]| names.contains(&name.as_str());
            if has(known.passed) {
                pass(format!("{name} of {}", card.name), card.place);
            } else if !has(known.parameters) && !card.is("HEADING") {
                return fault(format!("{} has the parameter {}, which is not read", card.name, cut(name, 60)));
            } else if name == "OP" && !value.as_ref().is_some_and(|value| ["NEW", "MOD"].contains(&key(value).as_str()))
            {
                return fault(format!("OP of {} must be NEW or MOD", card.name));
            }
        }
        let most = if card.is("STATIC") || card.is("FRICTION") { 1 } else { usize::MAX };
        let most = if card.is_any(&BARE) { 0 } else { most };
        // Behind the last step stands what nobody reads.
        let is_end = card.is("ENDSTEP") && last == Some(card.place);
        if let Some(line) = card.lines.get(most).filter(|_| is_end) {
            noted.push((line.place, "this text follows the last *END STEP, and is passed over".into()));
        } else if let Some(line) = card.lines.get(most) {
            return Err(
                deck.fault(line.place, format!("this line does not belong to {}; a keyword may be missing", card.name))
            );
        }
        match open {
            None if card.is("STEP") => (open, is_static) = (Some(card), false),
            None if card.is_any(&OF_STEP) => {
                return fault(format!("{} stands outside of the steps, but belongs into one", card.name));
            }
            None if card.step > 0 => {
                return fault(format!("{} follows an *END STEP; only a *STEP may follow one", card.name));
            }
            None => {}
            Some(step) if card.is("STEP") => return Err(without_end(step)),
            Some(step) if card.is("ENDSTEP") && !is_static => {
                return Err(step.fault("the step has no *STATIC; only an equilibrium is solved"));
            }
            Some(_) if card.is("ENDSTEP") => open = None,
            Some(_) => is_static |= card.is("STATIC"),
        }
    }
    let whole = DeckPlace { file: 0, line: 1 };
    match open {
        Some(step) => Err(without_end(step)),
        None if deck.steps == 0 => Err(deck.fault(whole, "the deck has no *STEP: it asks for no answer")),
        None => Ok(passed),
    }
}

fn without_end(step: DeckCard) -> Error {
    step.fault("the step has no *END STEP")
}

/// The sentence about a keyword that is not read.
fn refusal(card: DeckCard) -> String {
    let name = cut(&card.name, 60);
    match ABSENT.iter().find(|(keywords, _)| card.is_any(keywords)) {
        Some((_, reason)) => format!("{name} changes the answer and is refused: {reason}"),
        None => format!("{name} is no keyword that is read; it may change the answer"),
    }
}

/// The keys that begin an object; the others follow in the order of the alphabet.
const FIRST: [&str; 6] = ["name", "on", "file", "boundary", "body", "young"];

/// An entry of the scene with the place in the deck that it comes from.
pub(super) struct SceneEntry {
    pub value: Value,
    pub place: DeckPlace,
}

impl SceneEntry {
    pub fn new(value: Value, place: DeckPlace) -> Self {
        SceneEntry { value, place }
    }
}

/// A text of JSON that grows, with the places of its values.
pub(super) struct SceneText<'a> {
    deck: &'a Deck,
    pub text: String,
    pub places: Vec<(String, DeckPlace)>,
}

impl<'a> SceneText<'a> {
    pub fn new(deck: &'a Deck, comments: &[String]) -> Self {
        let mut text = String::new();
        for comment in comments {
            let _ = writeln!(text, "// {}", comment.replace(['\n', '\r'], " "));
        }
        text += "{\n  \"format\": 1";
        SceneText { deck, text, places: Vec::new() }
    }

    /// Adds a key of the scene that has no place in the deck.
    pub fn plain(&mut self, key: &str, value: &Value) {
        let _ = write!(self.text, ",\n  \"{key}\": {}", written(value));
    }

    pub fn one(&mut self, key: &str, entry: &SceneEntry) {
        let named = self.deck.source.named(entry.place);
        let _ = write!(self.text, ",\n  // {named}\n  \"{key}\": {}", written(&entry.value));
        self.places.push((key.into(), entry.place));
    }

    /// Adds a list; nothing if it is empty.
    pub fn list(&mut self, key: &str, entries: &[SceneEntry]) {
        if entries.is_empty() {
            return;
        }
        let _ = write!(self.text, ",\n  \"{key}\": [");
        for (index, SceneEntry { value, place }) in entries.iter().enumerate() {
            let (named, comma) = (self.deck.source.named(*place), if index > 0 { "," } else { "" });
            let _ = write!(self.text, "{comma}\n    // {named}\n    {}", written(value));
            self.places.push((format!("{key}[{index}]"), *place));
        }
        self.text += "\n  ]";
    }

    /// The whole text.
    pub fn end(mut self) -> (String, Vec<(String, DeckPlace)>) {
        self.text += "\n}\n";
        (self.text, self.places)
    }
}

pub(super) fn object(key: &str, value: Value) -> Value {
    Value::Object(Map::from_iter([(key.to_string(), value)]))
}

/// A value in one line, as a person writes it.
fn written(value: &Value) -> String {
    match value {
        Value::Object(object) => {
            let mut fields: Vec<(&String, &Value)> = object.iter().collect();
            let rank = |key: &str| FIRST.iter().position(|first| *first == key).unwrap_or(FIRST.len());
            fields.sort_by(|(one, _), (other, _)| rank(one).cmp(&rank(other)).then(one.cmp(other)));
            let fields =
                fields.into_iter().map(|(key, value)| format!("{}: {}", Value::from(key.as_str()), written(value)));
            format!("{{{}}}", fields.collect::<Vec<_>>().join(", "))
        }
        Value::Array(values) => format!("[{}]", values.iter().map(written).collect::<Vec<_>>().join(", ")),
        Value::Number(float) if float.is_f64() => number(float.as_f64().unwrap_or_default() + 0.0),
        other => other.to_string(),
    }
}
