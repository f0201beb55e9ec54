//! The text of the scene of a deck, and the line of the deck for each of its entries.

use std::fmt::Write;

use serde_json::{Map, Value};

use crate::fem::mesh::deck::{Deck, Place};
use crate::scene::input::entry::number;

/// The keys that begin an object; the others follow in the order of the alphabet.
const FIRST: [&str; 6] = ["name", "on", "file", "boundary", "body", "young"];

/// An entry of the scene with the place in the deck that it comes from.
pub(super) struct Entry {
    pub value: Value,
    pub place: Place,
}

impl Entry {
    pub fn new(value: Value, place: Place) -> Self {
        Entry { value, place }
    }
}

/// A text of JSON that grows, with the places of its values.
pub(super) struct SceneText<'a> {
    deck: &'a Deck,
    pub text: String,
    pub places: Vec<(String, Place)>,
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

    pub fn one(&mut self, key: &str, entry: &Entry) {
        let named = self.deck.source.named(entry.place);
        let _ = write!(self.text, ",\n  // {named}\n  \"{key}\": {}", written(&entry.value));
        self.places.push((key.into(), entry.place));
    }

    /// Adds a list; nothing if it is empty.
    pub fn list(&mut self, key: &str, entries: &[Entry]) {
        if entries.is_empty() {
            return;
        }
        let _ = write!(self.text, ",\n  \"{key}\": [");
        for (index, Entry { value, place }) in entries.iter().enumerate() {
            let (named, comma) = (self.deck.source.named(*place), if index > 0 { "," } else { "" });
            let _ = write!(self.text, "{comma}\n    // {named}\n    {}", written(value));
            self.places.push((format!("{key}[{index}]"), *place));
        }
        self.text += "\n  ]";
    }

    /// The whole text.
    pub fn end(mut self) -> (String, Vec<(String, Place)>) {
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
