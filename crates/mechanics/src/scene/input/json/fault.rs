//! What is wrong with the text of a scene, and the words for it: in the terms of JSON and of the scene.

use std::fmt;

use crate::error::nearly;
use crate::scene::input::absent::absent;
use jsonc_parser::ast::Value;
use jsonc_parser::common::Ranged;

/// A fault in the text of a scene; its words are its `Display`.
#[derive(Debug)]
pub(crate) struct Fault {
    pub what: What,
    /// JSON path as `loads[0].traction.value`; empty for the scene itself.
    pub path: String,
    /// The place in the text, in bytes; `None` as long as nothing knows it.
    pub at: Option<usize>,
}

#[derive(Debug)]
pub(crate) enum What {
    /// A value of another type than the right one.
    Type {
        expected: String,
        found: String,
    },
    /// An array of another length than the right one.
    Length {
        expected: usize,
        found: usize,
    },
    /// The number is too large.
    OutOfRange,
    UnknownKey {
        name: String,
        known: &'static [&'static str],
    },
    UnknownChoice {
        name: String,
        known: &'static [&'static str],
    },
    MissingKey(&'static str),
    KeyTwice(&'static str),
    /// Another fault, in words.
    Other(String),
}

pub(crate) const NUMBER: &str = "a number";
pub(crate) const OBJECT: &str = "an object";
pub(crate) const ARRAY: &str = "an array";

/// The forms of arrays by the end of their paths: an example says more than the word array.
const ARRAYS: [(&[&str], &str); 4] = [
    (&["x.divisions", "y.divisions", "z.divisions"], "an array of whole numbers, one for each interval, such as [80]"),
    (&["x.points", "y.points", "z.points"], "an array of coordinates that increase, such as [0, 1]"),
    (&["x.ratios", "y.ratios", "z.ratios"], "an array of positive numbers, one for each interval, such as [1]"),
    (&["apex", "centre", "point", "normal", "at", "axis"], "an array of coordinates, such as [0, 1]"),
];

impl Fault {
    /// A fault at a place of the text.
    pub fn at(at: usize, what: What) -> Fault {
        Fault { what, path: String::new(), at: Some(at) }
    }

    /// The fault as the object or the array sees it that has the faulty value, or the faulty key, at `step` (`key` or
    /// `[3]`).
    pub fn inside(self, step: &str, at: usize) -> Fault {
        let dot = if self.path.is_empty() || self.path.starts_with('[') { "" } else { "." };
        Fault { path: format!("{step}{dot}{}", self.path), ..self.placed(at) }
    }

    /// The fault with a place, if it had none.
    pub fn placed(self, at: usize) -> Fault {
        Fault { at: self.at.or(Some(at)), ..self }
    }

    fn ends_with(&self, keys: &[&str]) -> bool {
        let is_end =
            |end: &&str| self.path.strip_suffix(*end).is_some_and(|start| start.is_empty() || start.ends_with('.'));
        keys.iter().any(is_end)
    }

    fn of_type(&self, expected: &str, found: &str) -> String {
        if expected == NUMBER && found == "null" && self.ends_with(&["x", "y", "z", "normal"]) {
            return "null is not a number; remove the key to leave the direction free".into();
        }
        let example = ARRAYS.iter().find(|(ends, _)| expected == ARRAY && self.ends_with(ends));
        format!("must be {}, but is {found}", example.map_or(expected, |(_, words)| words))
    }

    fn of_length(&self, right: usize, found: usize) -> String {
        let entries = format!("{found} {}", if found == 1 { "entry" } else { "entries" });
        let names = ["[x, y]", "[x, y, z]"].get(right.wrapping_sub(2));
        let mut keys = self.path.rsplit('.');
        match (keys.next(), keys.next(), names) {
            (Some("apex" | "centre" | "axis"), Some(kind), Some(names)) => {
                let room = if right == 2 { "the plane" } else { "space" };
                format!("the array has {entries}; `{kind}` is a shape of {room}, so that it must have {right}: {names}")
            }
            (Some(key), _, Some(names)) if key.starts_with("points[") => {
                format!("the array has {entries}, but must have {right}: {names}")
            }
            _ => format!("the array has {entries}, but must have {right}"),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let words = match &self.what {
            What::Type { expected, found } => self.of_type(expected, found),
            What::Length { expected, found } => self.of_length(*expected, *found),
            What::OutOfRange => "number out of range: at most about 1.8e308 is allowed".into(),
            What::UnknownKey { name, known } => of_unknown("key", name, known),
            What::UnknownChoice { name, known } => of_unknown("choice", name, known),
            What::MissingKey(key) => format!("the key `{key}` is missing"),
            What::KeyTwice(key) => format!("the key `{key}` stands twice in one object; remove one"),
            What::Other(words) => words.clone(),
        };
        formatter.write_str(&words)
    }
}

/// What is not modelled if `name` is the name of that, or else all known names, with a suggestion.
fn of_unknown(kind: &str, name: &str, known: &[&str]) -> String {
    if let Some(words) = absent(name) {
        return format!("the {kind} `{name}` does not exist: {words}");
    }
    let expected = match known {
        [first, second] => format!("`{first}` or `{second}`"),
        [only] => format!("`{only}`"),
        _ => format!("one of `{}`", known.join("`, `")),
    };
    format!("unknown {kind} `{name}`, expected {expected}") + &nearly(name, known.iter().copied())
}

impl std::error::Error for Fault {}

impl serde::de::Error for Fault {
    fn custom<T: fmt::Display>(words: T) -> Fault {
        What::Other(words.to_string()).into()
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Fault {
        What::UnknownKey { name: name.into(), known }.into()
    }

    fn missing_field(key: &'static str) -> Fault {
        What::MissingKey(key).into()
    }

    fn duplicate_field(key: &'static str) -> Fault {
        What::KeyTwice(key).into()
    }
}

impl From<What> for Fault {
    fn from(what: What) -> Fault {
        Fault { what, path: String::new(), at: None }
    }
}

/// The place of the value at `path` as `supports[0].on.boundary`, in bytes; if it is missing, of the value that should
/// contain it.
pub(crate) fn start_of(scene: &Value, path: &str) -> usize {
    let keys = path.split(['.', '[']).map(|key| key.trim_end_matches(']')).filter(|key| !key.is_empty());
    let found = keys.into_iter().try_fold(scene, |value, key| {
        let inner = match value {
            Value::Object(object) => object.get(key).map(|field| &field.value),
            Value::Array(array) => key.parse().ok().and_then(|index: usize| array.elements.get(index)),
            _ => None,
        };
        inner.ok_or(value)
    });
    found.unwrap_or_else(|container| container).start()
}

/// Line and column, from 1, of a place in bytes.
pub(crate) fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..at];
    let line = before.rsplit('\n').next().unwrap_or_default();
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}
