//! A card of a deck: a keyword with its parameters and its data lines.

/// A line of one of the files of a deck, from 1; files are numbered from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Place {
    pub file: u32,
    pub line: u32,
}

/// A data line: its place, and its bytes in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    pub place: Place,
    pub start: usize,
    pub end: usize,
}

/// A keyword with its parameters and its data lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Card {
    pub place: Place,
    /// As it is written in messages: `*NODE PRINT`.
    pub name: String,
    /// The keyword in capitals, without blanks: `NODEPRINT`.
    key: String,
    /// In capitals, with the value as it is written; `None` without one.
    pub parameters: Vec<(String, Option<String>)>,
    pub lines: Vec<Line>,
    /// The step in which it stands, from 1; 0 before all steps.
    pub step: usize,
}

/// A name in capitals, without blanks: names that differ only so are one name.
pub(crate) fn key(name: &str) -> String {
    name.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_uppercase).collect()
}

impl Card {
    /// A card without data lines, from its text: `*KEYWORD, NAME=VALUE, ...`.
    pub(super) fn of(place: Place, text: &str) -> Self {
        let mut parts = text.split(',').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let words: Vec<String> = name.split_whitespace().map(str::to_uppercase).collect();
        let parameter = |part: &str| match part.split_once('=') {
            Some((name, value)) => (key(name), Some(value.trim().trim_matches('"').trim().to_string())),
            None => (key(part), None),
        };
        let parameters = parts.filter(|part| !part.is_empty()).map(parameter).collect();
        Card {
            place,
            name: words.join(" "),
            key: key(name.trim_start_matches('*')),
            parameters,
            lines: Vec::new(),
            step: 0,
        }
    }

    /// Returns `true` for the card of this keyword, given in capitals.
    pub fn is(&self, keyword: &str) -> bool {
        self.key == keyword || self.key == key(keyword)
    }

    pub fn has(&self, name: &str) -> bool {
        self.parameters.iter().any(|(own, _)| own == name)
    }

    pub fn value(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(own, _)| own == name).and_then(|(_, value)| value.as_deref())
    }

    /// Returns `true` if it removes those before it.
    pub fn is_new(&self) -> bool {
        self.says("OP", "NEW")
    }

    /// Returns `true` if a parameter has this value, given in capitals.
    pub fn says(&self, name: &str, value: &str) -> bool {
        self.value(name).is_some_and(|own| key(own) == value)
    }
}
