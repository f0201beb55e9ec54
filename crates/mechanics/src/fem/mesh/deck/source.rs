//! The lines of a deck and of the files that it includes, as cards: a keyword with its parameters and its data lines.

use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::card::{Card, Line, Place, key};
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
pub(crate) struct Source {
    /// The deck itself, then the files that it includes, each with its content.
    files: Vec<(PathBuf, Vec<u8>)>,
    pub cards: Vec<Card>,
    /// What is read, but may not be meant: a sentence with its place.
    pub noted: Vec<(Place, String)>,
    /// The first line with values that are passed over.
    pub longer: OnceLock<(Place, String)>,
    bytes: u64,
}

impl Source {
    /// Reads a deck. The files that it includes must lie in the folder `within` or below it; anywhere without one.
    pub fn read(path: &Path, within: Option<&Path>) -> Result<Self, Error> {
        let mut source = Source::default();
        let content = source.content(path)?;
        Reader { folder: path.parent().unwrap_or(Path::new("")), within, open: Vec::new() }.file(
            &mut source,
            path,
            content,
        )?;
        match source.cards.is_empty() {
            true => Err(source.fault(Place { file: 0, line: 1 }, NO_DECK)),
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
    pub fn text(&self, line: &Line) -> &[u8] {
        self.files.get(line.place.file as usize).and_then(|file| file.1.get(line.start..line.end)).unwrap_or_default()
    }

    /// The file and the line of a place.
    pub fn position(&self, place: Place) -> (&Path, usize) {
        (self.files.get(place.file as usize).map_or(Path::new(""), |file| &file.0), place.line as usize)
    }

    /// The deck itself.
    pub fn path(&self) -> &Path {
        self.position(Place { file: 0, line: 0 }).0
    }

    /// The place as it is written in comments and in other sentences.
    pub fn named(&self, place: Place) -> String {
        let (file, line) = self.position(place);
        match place.file {
            0 => format!("line {line}"),
            _ => format!("line {line} of {}", file.file_name().unwrap_or_default().to_string_lossy()),
        }
    }

    /// An error at a place; a message that quotes a long name is cut.
    pub fn fault(&self, place: Place, message: impl Into<String>) -> Error {
        let (file, line) = self.position(place);
        let message = message.into().chars().filter(|c| !c.is_control()).take(LONGEST).collect();
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
    fn file(&mut self, source: &mut Source, path: &Path, content: Vec<u8>) -> Result<(), Error> {
        self.open.push(path.canonicalize().unwrap_or_else(|_| path.into()));
        let file = source.files.len() as u32;
        source.files.push((path.into(), Vec::new()));
        // A keyword whose line ends with a comma goes on in the next line, if that is a parameter.
        let mut keyword: Option<(Place, String)> = None;
        let mut start = if content.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        for (index, whole) in content[start..].split(|&byte| byte == b'\n').enumerate() {
            let (text, place) = (whole.trim_ascii(), Place { file, line: index as u32 + 1 });
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
                Some(card) => card.lines.push(Line { place, start: begin, end: begin + text.len() }),
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
    fn card(&mut self, source: &mut Source, place: Place, text: &str) -> Result<(), Error> {
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
            source.cards.push(card);
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
