//! The messages of the JSON parser in plain English: in the terms of JSON and of the scene instead of those of Rust.

use super::absent::{absent, other_format};
use super::locate::{key_before, starts_of_entries};
use crate::error::nearly;

/// Characters of the text that a message quotes.
const QUOTED: usize = 20;

/// Messages of the parser that say all alone.
const WHOLE: [(&str, &str); 13] = [
    ("EOF while parsing a list", "the text ends inside an array; a closing `]` is missing"),
    ("EOF while parsing an object", "the text ends inside an object; a closing `}` is missing"),
    ("EOF while parsing a string", "the text ends inside a string; a closing `\"` is missing"),
    ("EOF while parsing a value", "the text ends before a value"),
    ("invalid number", "a number must have the form of JSON, such as 0.5, -2 or 1e-3"),
    ("number out of range", "number out of range: at most about 1.8e308 is allowed"),
    ("invalid escape", "a backslash in a string must be followed by one of \" \\ / b f n r t u; write \\\\ for itself"),
    ("lone leading surrogate in hex escape", INVALID_HEXADECIMAL),
    ("unexpected end of hex escape", INVALID_HEXADECIMAL),
    ("recursion limit exceeded", "more than 127 arrays and objects lie inside each other; that is not allowed"),
    ("invalid type: map, expected enum", "must be an object with a single key, but is empty"),
    ("control character (\\u0000-\\u001F) found while parsing a string", CONTROL_CHARACTER),
    ("expected ident", "this value must be spelt `true`, `false` or `null`"),
];

const INVALID_HEXADECIMAL: &str = "`\\u` in a string must be followed by four hexadecimal digits of a character";

const CONTROL_CHARACTER: &str = "a string may contain no line break and no other control character; its closing `\"` is \
                                 missing, or write \\n or \\t";

/// Words of the parser, and those of JSON; the order matters.
const WORDS: [(&str, &str); 15] = [
    ("invalid type: map", "invalid type: an object"),
    ("invalid type: sequence", "invalid type: an array"),
    ("invalid type: string", "invalid type: the string"),
    ("invalid type: integer", "invalid type: the number"),
    ("invalid type: floating point", "invalid type: the number"),
    ("invalid type: boolean ", "invalid type: "),
    ("invalid value: integer", "invalid value: the number"),
    ("expected f64", "expected a number"),
    ("expected usize", "expected a whole number that is not negative, in digits alone"),
    ("expected u32", "expected a whole number that is not negative, in digits alone"),
    ("expected a sequence", "expected an array"),
    ("expected string or map", "expected a string or an object"),
    ("trailing characters", "the array has too many entries"),
    ("unknown field", "unknown key"),
    ("unknown variant", "unknown choice"),
];

/// The forms of arrays by the end of their paths: an example says more than the word array.
const ARRAYS: [(&[&str], &str); 4] = [
    (&["x.divisions", "y.divisions", "z.divisions"], "an array of whole numbers, one for each interval, such as [80]"),
    (&["x.points", "y.points", "z.points"], "an array of coordinates that increase, such as [0, 1]"),
    (&["x.ratios", "y.ratios", "z.ratios"], "an array of positive numbers, one for each interval, such as [1]"),
    (&["apex", "centre", "point", "normal", "at", "axis"], "an array of coordinates, such as [0, 1]"),
];

/// A fault in the text of a scene.
pub(super) struct Fault<'a> {
    /// The text of the scene.
    pub text: &'a str,
    /// JSON path; `.` for the scene itself.
    pub path: String,
    /// The error of the parser.
    pub error: serde_json::Error,
}

impl Fault<'_> {
    /// The path of the fault, and a sentence on what is wrong and what is allowed.
    pub fn in_words(self) -> (String, String) {
        if let Some(words) = other_format(self.text) {
            return (self.path, words);
        }
        let position = format!(" at line {} column {}", self.error.line(), self.error.column());
        let message = self.error.to_string().replace(&position, "");
        if let Some((_, words)) = WHOLE.iter().find(|(parser, _)| *parser == message) {
            return (self.path, words.to_string());
        }
        if let Some(key) = message.strip_prefix("duplicate field `").and_then(|rest| rest.strip_suffix('`')) {
            let path = if self.path == "." { key.to_string() } else { format!("{}.{key}", self.path) };
            return (path, format!("the key `{key}` stands twice in one object; remove one"));
        }
        if let Some(key) = message.strip_prefix("missing field ") {
            return (self.path, format!("the key {key} is missing"));
        }
        let words = self.of_syntax(&message).or_else(|| self.of_length(&message)).unwrap_or_else(|| {
            let message = WORDS.iter().fold(message, |message, (parser, json)| message.replace(parser, json));
            in_place_of_unknown(&message).or_else(|| of_type(&message, &self.path)).unwrap_or(message)
        });
        (self.path, words)
    }

    /// The place of the fault in the text, in bytes.
    fn offset(&self) -> usize {
        let before = self.text.split_inclusive('\n').take(self.error.line().saturating_sub(1));
        before.map(str::len).sum::<usize>() + self.error.column().saturating_sub(1)
    }

    /// The text at the fault, as a person would name it.
    fn found(&self) -> String {
        let rest = self.text.get(self.offset()..).unwrap_or_default();
        let is_word = |c: &char| c.is_alphanumeric() || "+-._".contains(*c);
        let word: String = rest.chars().take_while(is_word).take(QUOTED).collect();
        let quoted = rest.strip_prefix('"').and_then(|rest| rest.split_once('"')).map(|(inside, _)| inside);
        match (quoted, rest.chars().next()) {
            (Some(inside), _) if inside.chars().count() <= QUOTED => format!("`\"{inside}\"`"),
            _ if !word.is_empty() => format!("`{word}`"),
            (_, Some(c)) if c.is_control() => format!("`{}`", c.escape_default()),
            (_, Some(c)) => format!("`{c}`"),
            (_, None) => "the end of the text".to_string(),
        }
    }

    /// A message on commas, colons, brackets and keys.
    fn of_syntax(&self, message: &str) -> Option<String> {
        let (offset, found) = (self.offset(), self.found());
        let key = key_before(self.text, offset);
        let of_key = key.map_or_else(String::new, |key| format!(" after the value of `{key}`"));
        Some(match message {
            "expected `,` or `}`" => format!("expected a comma or `}}`{of_key}, but found {found}"),
            "expected `,` or `]`" => format!("expected a comma or `]` after an entry of an array, but found {found}"),
            "expected `:`" => format!("expected a colon after a key, but found {found}"),
            "trailing comma" => format!("no comma may stand before {found}; remove the comma{of_key}"),
            "expected value" => format!(
                "expected a value of JSON (a number such as 0.5, a string in double quotes, true, false, an array or an \
                 object), but found {found}"
            ),
            "trailing characters" if self.path == "." => {
                format!("there is more text after the end of the scene: {found}; remove it")
            }
            "key must be a string" => format!("expected a key in double quotes, but found {found}"),
            _ => return None,
        })
    }

    /// A message on an array of another length than the right one.
    fn of_length(&self, message: &str) -> Option<String> {
        let starts = starts_of_entries(self.text, &self.path)?;
        let right = match message {
            // The parser stops at the first entry beyond the last.
            "trailing characters" => starts.iter().filter(|start| **start < self.offset()).count(),
            _ => message.rsplit_once("expected an array of length ")?.1.parse().ok()?,
        };
        let entries = plural(starts.len());
        let mut keys = self.path.rsplit('.');
        let (key, kind) = (keys.next()?, keys.next());
        let names = match right {
            2 => "[x, y]",
            3 => "[x, y, z]",
            _ => return Some(format!("the array has {entries}, but must have {right}")),
        };
        Some(match kind.filter(|_| ["apex", "centre", "axis"].contains(&key)) {
            Some(kind) => {
                let room = if right == 2 { "the plane" } else { "space" };
                format!("the array has {entries}; `{kind}` is a shape of {room}, so that it must have {right}: {names}")
            }
            None if key.starts_with("points[") => format!("the array has {entries}, but must have {right}: {names}"),
            None => format!("the array has {entries}, but must have {right}"),
        })
    }
}

fn plural(entries: usize) -> String {
    format!("{entries} {}", if entries == 1 { "entry" } else { "entries" })
}

/// A message on a value of another type than the right one.
fn of_type(message: &str, path: &str) -> Option<String> {
    let wrong = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "))?;
    let (found, expected) = wrong.rsplit_once(", expected ")?;
    let has_end = |ends: &[&str]| {
        let is_end = |end: &&str| path.strip_suffix(*end).is_some_and(|start| start.is_empty() || start.ends_with('.'));
        ends.iter().any(is_end)
    };
    let example = ARRAYS.iter().find(|(ends, _)| expected == "an array" && has_end(ends));
    let found = if found.starts_with("the number") { found.replace('`', "") } else { found.to_string() };
    Some(format!("must be {}, but is {found}", example.map_or(expected, |(_, words)| words)))
}

/// A message on an unknown key or choice: what is not modelled if it is the name of that, or else the parser's message, which names all
/// known ones, with a suggestion.
fn in_place_of_unknown(message: &str) -> Option<String> {
    let (kind, unknown) = ["key", "choice"]
        .iter()
        .find_map(|kind| message.strip_prefix(&format!("unknown {kind} `")).map(|unknown| (kind, unknown)))?;
    let (name, known) = unknown.split_once("`, ")?;
    if let Some(words) = absent(name) {
        return Some(format!("the {kind} `{name}` does not exist: {words}"));
    }
    // Between the quotation marks, every second piece is a name.
    Some(message.to_string() + &nearly(name, known.split('`').skip(1).step_by(2)))
}
