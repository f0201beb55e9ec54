//! The lines of a deck and of the files that it includes, as cards: a keyword with its parameters and its data lines.

use std::collections::HashSet;
use std::fmt::Display;
use std::io;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::OnceLock;

use crate::error::Error;
use signorini_linear as linear;
use signorini_linear::file::read_capped;

/// Most bytes of a deck with all files that it includes.
const MOST_OF_DECK: u64 = 4 << 30;

/// Most files of a deck: files that include others several times each could be endlessly many.
const MOST_FILES: usize = 1000;

/// Longest message, in characters.
const LONGEST: usize = 500;

/// The parameters of cards that have no value.
const FLAGS: [&str; 9] =
    ["GENERATE", "NLGEOM", "INTERNAL", "UNSORTED", "DIRECT", "PERTURBATION", "SMALLSLIDING", "FIXED", "TIMERESET"];

/// The mark with which some editors begin a file of UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Error for a file without a keyword; it quotes no content, which may be private.
const NO_DECK: &str = "this is not an input deck: a keyword, as *NODE, must begin here";

/// The content of a deck: its files and its cards, in the order in which they are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeckSource {
    /// The deck itself, then the files that it includes, each with its content.
    files: Vec<(PathBuf, Vec<u8>)>,
    pub cards: Vec<Card>,
    /// What is read, but may not be meant: a sentence with its place.
    pub noted: Vec<(DeckPlace, String)>,
    /// The first line with values that are passed over.
    pub longer: OnceLock<(DeckPlace, String)>,
    bytes: u64,
}

impl DeckSource {
    /// Reads a deck. The files that it includes must lie in the folder `within` or below it; anywhere without one.
    pub fn read(path: &Path, within: Option<&Path>) -> Result<Self, Error> {
        let mut source = DeckSource::default();
        let content = source.content(path)?;
        Reader { folder: path.parent().unwrap_or(Path::new("")), within, open: Vec::new() }.file(
            &mut source,
            path,
            content,
        )?;
        match source.cards.is_empty() {
            true => Err(source.fault(DeckPlace { file: 0, line: 1 }, NO_DECK)),
            false => Ok(source),
        }
    }

    /// The content of a file, counted.
    fn content(&mut self, path: &Path) -> Result<Vec<u8>, Error> {
        let content = read_capped(path, MOST_OF_DECK)?;
        self.bytes = self.bytes.saturating_add(content.len() as u64);
        if self.bytes > MOST_OF_DECK || self.files.len() >= MOST_FILES {
            let reason = format!(
                "the deck with its included files has more than {} MB or {MOST_FILES} files",
                MOST_OF_DECK >> 20
            );
            let source = io::Error::new(io::ErrorKind::FileTooLarge, reason);
            return Err(linear::Error::File { action: "read", path: path.into(), source }.into());
        }
        Ok(content)
    }

    /// The bytes of a line, without surrounding blanks.
    pub fn text(&self, line: &DataLine) -> &[u8] {
        self.files.get(line.place.file as usize).and_then(|file| file.1.get(line.start..line.end)).unwrap_or_default()
    }

    /// The file and the line of a place.
    pub fn position(&self, place: DeckPlace) -> (&Path, usize) {
        (self.files.get(place.file as usize).map_or(Path::new(""), |file| &file.0), place.line as usize)
    }

    /// The deck itself.
    pub fn path(&self) -> &Path {
        self.position(DeckPlace { file: 0, line: 0 }).0
    }

    /// The place as it is written in comments and in other sentences.
    pub fn named(&self, place: DeckPlace) -> String {
        let (file, line) = self.position(place);
        match place.file {
            0 => format!("line {line}"),
            _ => format!("line {line} of {}", file.file_name().unwrap_or_default().to_string_lossy()),
        }
    }

    /// An error at a place; a message that quotes a long name is cut.
    pub fn fault(&self, place: DeckPlace, message: impl Into<String>) -> Error {
        let (file, line) = self.position(place);
        let message = cut(&message.into(), LONGEST);
        linear::Error::FileSyntax { file: file.into(), line: line.max(1), message }.into()
    }
}

/// The reading of a deck with the files that it includes.
struct Reader<'a> {
    /// The folder of the deck, in which the names of included files start.
    folder: &'a Path,
    within: Option<&'a Path>,
    /// The files that are being read: each includes the next.
    open: Vec<PathBuf>,
}

impl Reader<'_> {
    fn file(&mut self, source: &mut DeckSource, path: &Path, content: Vec<u8>) -> Result<(), Error> {
        self.open.push(path.canonicalize().unwrap_or_else(|_| path.into()));
        let file = source.files.len() as u32;
        source.files.push((path.into(), Vec::new()));
        // A keyword whose line ends with a comma goes on in the next line, if that is a parameter.
        let mut keyword: Option<(DeckPlace, String)> = None;
        let mut start = if content.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        for (index, whole) in content[start..].split(|&byte| byte == b'\n').enumerate() {
            let (text, place) = (whole.trim_ascii(), DeckPlace { file, line: index as u32 + 1 });
            let begin = start + (whole.len() - whole.trim_ascii_start().len());
            start += whole.len() + 1;
            if text.is_empty() || text.starts_with(b"**") {
                continue;
            }
            match keyword.take() {
                Some((at, begun)) if begun.ends_with(',') && is_parameter(text) => {
                    keyword = Some((at, begun + &String::from_utf8_lossy(text)));
                    continue;
                }
                Some((at, begun)) => self.card(source, at, &begun)?,
                None => {}
            }
            if text.starts_with(b"*") {
                keyword = Some((place, String::from_utf8_lossy(text).into_owned()));
                continue;
            }
            match source.cards.last_mut() {
                Some(card) => card.lines.push(DataLine { place, start: begin, end: begin + text.len() }),
                None => return Err(source.fault(place, NO_DECK)),
            }
        }
        if let Some((place, text)) = keyword {
            self.card(source, place, &text)?;
        }
        source.files[file as usize].1 = content;
        self.open.pop();
        Ok(())
    }

    /// Adds a card; reads the file of an include.
    fn card(&mut self, source: &mut DeckSource, place: DeckPlace, text: &str) -> Result<(), Error> {
        let card = Card::of(place, text);
        let mut names = HashSet::new();
        if let Some((name, _)) = card.parameters.iter().find(|(name, _)| !names.insert(name.as_str())) {
            return Err(source.fault(place, format!("{} has {name} twice", card.name)));
        }
        if text.ends_with(',') {
            let message = format!(
                "{} ends in a comma, but no parameter follows: the next line is read as data, or as a card of its own",
                card.name
            );
            source.noted.push((place, message));
        }
        if !card.is("INCLUDE") {
            let before = source.cards.last().map_or(0, |last| last.step);
            source.cards.push(Card { step: before + usize::from(card.is("STEP")), ..card });
            return Ok(());
        }
        let Some(name) = card.value("INPUT").filter(|name| !name.is_empty()) else {
            return Err(source.fault(place, "*INCLUDE names no file; write *INCLUDE, INPUT=FILE"));
        };
        let path = self.folder.join(name);
        let shown = path.display();
        let real = path.canonicalize().map_err(|error| source.fault(place, format!("cannot read {shown}: {error}")))?;
        if let Some(within) = self.within {
            let home = if within.as_os_str().is_empty() { Path::new(".") } else { within };
            if !home.canonicalize().is_ok_and(|home| real.starts_with(home)) {
                let message = format!(
                    "the included file {shown} lies outside the folder of the deck; copy it there, or allow it (--allow-outside)"
                );
                return Err(source.fault(place, message));
            }
        }
        if self.open.contains(&real) {
            return Err(source.fault(place, format!("the included file {shown} includes itself")));
        }
        let content = source.content(&path).map_err(|error| source.fault(place, error.to_string()))?;
        self.file(source, &path, content)
    }
}

/// Returns `true` for a line that goes on with the parameters of a keyword: its first one has a value, or needs none.
fn is_parameter(text: &[u8]) -> bool {
    let first = String::from_utf8_lossy(text.split(|&byte| byte == b',').next().unwrap_or_default()).into_owned();
    !text.starts_with(b"*") && (first.contains('=') || FLAGS.contains(&key(&first).as_str()))
}

/// A line of one of the files of a deck, from 1; files are numbered from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DeckPlace {
    pub file: u32,
    pub line: u32,
}

/// A data line: its place, and its bytes in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataLine {
    pub place: DeckPlace,
    pub start: usize,
    pub end: usize,
}

/// A keyword with its parameters and its data lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Card {
    pub place: DeckPlace,
    /// As it is written in messages: `*NODE PRINT`.
    pub name: String,
    /// The keyword in capitals, without blanks: `NODEPRINT`.
    key: String,
    /// In capitals, with the value as it is written; `None` without one.
    pub parameters: Vec<(String, Option<String>)>,
    pub lines: Vec<DataLine>,
    /// The step in which it stands, from 1; 0 before all steps.
    pub step: usize,
}

/// A name in capitals, without blanks: names that differ only so are one name.
pub fn key(name: &str) -> String {
    name.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_uppercase).collect()
}

impl Card {
    /// A card without data lines, from its text: `*KEYWORD, NAME=VALUE, ...`.
    pub(super) fn of(place: DeckPlace, text: &str) -> Self {
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

    pub fn is_any(&self, keywords: &[&str]) -> bool {
        keywords.iter().any(|keyword| self.is(keyword))
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

/// A card with the deck that it is in.
#[derive(Clone, Copy)]
pub struct DeckCard<'a> {
    pub source: &'a DeckSource,
    pub card: &'a Card,
}

impl Deref for DeckCard<'_> {
    type Target = Card;

    fn deref(&self) -> &Card {
        self.card
    }
}

impl<'a> DeckCard<'a> {
    /// The value of a parameter.
    pub fn value(&self, name: &str) -> Option<&'a str> {
        self.card.value(name)
    }

    /// The value of NAME.
    pub fn named(&self) -> Result<&'a str, Error> {
        self.value("NAME").ok_or_else(|| self.fault(format!("{} has no name; write NAME=NAME", self.name)))
    }

    /// The fields of each data line.
    pub fn fields(&self) -> impl Iterator<Item = DataFields<'a>> + Clone + use<'a> {
        let source = self.source;
        self.card.lines.iter().map(move |line| source.fields(line))
    }

    pub fn fault(&self, message: impl Into<String>) -> Error {
        self.source.fault(self.place, message)
    }

    /// A result whose sentence becomes an error at the card.
    pub fn placed<T>(&self, result: Result<T, impl Into<String>>) -> Result<T, Error> {
        result.map_err(|message| self.fault(message))
    }
}

/// The fields of a data line, one after the other.
#[derive(Clone)]
pub struct DataFields<'a> {
    source: &'a DeckSource,
    pub place: DeckPlace,
    /// `None` behind the last field.
    rest: Option<&'a [u8]>,
}

/// The beginning of a text of users, for a message: at most so many characters.
pub fn cut(text: &str, most: usize) -> String {
    text.chars().filter(|c| !c.is_control()).take(most).collect()
}

/// A field as it is quoted in messages, where longer ones are cut.
fn shown(field: &[u8]) -> String {
    const MOST: usize = 40;
    let text = cut(&String::from_utf8_lossy(field), MOST + 1);
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

impl DeckSource {
    /// Its cards, each with the deck.
    pub fn cards(&self) -> impl DoubleEndedIterator<Item = DeckCard<'_>> + Clone {
        self.cards.iter().map(|card| DeckCard { source: self, card })
    }

    /// The cards of a keyword, given in capitals.
    pub fn cards_of(&self, keyword: &'static str) -> impl Iterator<Item = DeckCard<'_>> + Clone {
        self.cards().filter(move |card| card.is(keyword))
    }

    /// The fields of a data line; a comma at its end begins no field.
    pub fn fields(&self, line: &DataLine) -> DataFields<'_> {
        let text = self.text(line);
        let text = text.strip_suffix(b",").unwrap_or(text);
        DataFields { source: self, place: line.place, rest: Some(text) }
    }
}

impl<'a> Iterator for DataFields<'a> {
    type Item = &'a [u8];

    /// The next field without blanks around it; empty fields too.
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        let end = rest.iter().position(|&byte| byte == b',');
        self.rest = end.map(|end| &rest[end + 1..]);
        Some(rest[..end.unwrap_or(rest.len())].trim_ascii())
    }
}

impl<'a> DataFields<'a> {
    /// The next field, as a name or the like; `None` if it is empty or missing.
    pub fn text(&mut self) -> Option<String> {
        self.next().filter(|field| !field.is_empty()).map(|field| String::from_utf8_lossy(field).into_owned())
    }

    /// The first field, a set or a number.
    pub fn first(&mut self) -> Result<String, Error> {
        self.text().ok_or_else(|| self.fault("a set or a number must begin this line"))
    }

    /// The next field as a whole number that is not negative.
    pub fn whole(&mut self, what: impl Display) -> Result<usize, Error> {
        let field = self.next().filter(|field| !field.is_empty());
        let Some(field) = field else { return Err(self.fault(format!("{what} is missing"))) };
        number(field).ok_or_else(|| self.wrong(field, what, "a whole number"))
    }

    /// The next field as a finite number; 0 if it is empty or missing.
    pub fn finite_or_zero(&mut self, what: impl Display) -> Result<f64, Error> {
        match self.clone().next() {
            Some(field) if !field.is_empty() => self.finite(what),
            _ => {
                self.next();
                Ok(0.0)
            }
        }
    }

    /// The next three fields as the components of a vector; those that are empty or missing are 0.
    pub fn vector(&mut self, of: impl Display) -> Result<[f64; 3], Error> {
        let mut vector = [0.0; 3];
        for (value, axis) in vector.iter_mut().zip(["x", "y", "z"]) {
            *value = self.finite_or_zero(format_args!("the {axis} of {of}"))?;
        }
        Ok(vector)
    }

    pub fn finite(&mut self, what: impl Display) -> Result<f64, Error> {
        let field = self.next().filter(|field| !field.is_empty());
        let Some(field) = field else { return Err(self.fault(format!("{what} is missing"))) };
        match number(field).or_else(|| number(&with_exponent(field))) {
            Some(value) if f64::is_finite(value) => Ok(value),
            _ => Err(self.wrong(field, what, "a finite number")),
        }
    }

    /// Refuses further fields.
    pub fn end(&mut self) -> Result<(), Error> {
        while let Some(field) = self.next() {
            if !field.is_empty() {
                let field = shown(field);
                return Err(self
                    .fault(format!("`{field}` follows the last value of this line; remove it, or a value before it")));
            }
        }
        Ok(())
    }

    /// Passes over further fields, as CalculiX does; the first line with some is noted.
    pub fn pass_over(&mut self) {
        if let Some(field) = std::iter::from_fn(|| self.next()).find(|field| !field.is_empty()) {
            let message =
                format!("`{}` follows the last value of this line; such values are passed over", shown(field));
            self.source.longer.get_or_init(|| (self.place, message));
        }
    }

    pub fn fault(&self, message: impl Into<String>) -> Error {
        self.source.fault(self.place, message)
    }

    /// A result whose sentence becomes an error at the line.
    pub fn placed<T>(&self, result: Result<T, impl Into<String>>) -> Result<T, Error> {
        result.map_err(|message| self.fault(message))
    }

    fn wrong(&self, field: &[u8], what: impl Display, allowed: &str) -> Error {
        self.fault(format!("{what} is `{}`; it must be {allowed}", shown(field)))
    }
}

/// A number as text; also one that is only part of a field in other languages, such as `1.` and `.3`.
fn number<T: FromStr>(field: &[u8]) -> Option<T> {
    std::str::from_utf8(field).ok().and_then(|text| text.parse().ok())
}

/// A number of Fortran with the letter of its exponent: `1d5` and `1+5` are `1e5`.
fn with_exponent(field: &[u8]) -> Vec<u8> {
    let mut text = Vec::with_capacity(field.len() + 1);
    for &byte in field {
        match byte {
            b'd' | b'D' => text.push(b'e'),
            b'+' | b'-' if text.last().is_some_and(|last| last.is_ascii_digit() || *last == b'.') => {
                text.extend([b'e', byte]);
            }
            _ => text.push(byte),
        }
    }
    text
}
