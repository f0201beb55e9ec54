//! Random damage of files, and the messages of their readers.

use std::path::{Path, PathBuf};

use signorini::fem::GmshFile;
use signorini::qp::read_problem;
use signorini::{Error, Scene, qp};

use crate::draws::Draws;

/// Words that are likely to reveal faults of a reader.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e999",
    "1e-999",
    "nan",
    "inf",
    "-inf",
    "18446744073709551616",
    "99999999999",
    "2.5",
    "\"",
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "null",
    "true",
    "\n",
    " ",
    "\u{feff}",
    "\0",
    "$EndNodes",
];

/// Number of words at the beginning of a message that distinguish one fault from another.
const FIRST_WORDS: usize = 4;

/// Returns the text with a few changes, most of which are small.
pub fn damaged(draws: &mut Draws, text: &[u8]) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..1 + draws.below(4) {
        let (from, length) = (draws.below(bytes.len() + 1), draws.below(12));
        let to = (from + length).min(bytes.len());
        match draws.below(6) {
            0 => drop(bytes.splice(from..to, WORDS[draws.below(WORDS.len())].bytes())),
            1 => drop(bytes.drain(from..to)),
            2 => {
                let copy = bytes[from..to].to_vec();
                let at = draws.below(bytes.len() + 1);
                bytes.splice(at..at, copy);
            }
            3 if from < bytes.len() => bytes[from] = draws.below(256) as u8,
            4 if from < bytes.len() => bytes[from] ^= 1 << draws.below(8),
            _ if draws.below(20) == 0 => bytes.truncate(from),
            _ => {}
        }
    }
    bytes
}

/// Returns the deck with a few changes: lines that are lost, repeated, exchanged or included again, words and numbers
/// that are replaced.
pub fn damaged_deck(draws: &mut Draws, text: &str, name: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
    for _ in 0..1 + draws.below(3) {
        let (from, to) = (draws.below(lines.len()), draws.below(lines.len()));
        match draws.below(8) {
            0 => drop(lines.remove(from)),
            1 => lines.insert(to, lines[from].clone()),
            2 => lines.swap(from, to),
            3 => lines.insert(from, format!("*INCLUDE, INPUT={name}")),
            4 => lines.truncate(from.max(1)),
            5 => lines[from] = String::from_utf8_lossy(&damaged(draws, lines[from].as_bytes())).into_owned(),
            _ => {
                let mut words: Vec<String> = lines[from].split(',').map(str::to_string).collect();
                let (place, other) = (draws.below(words.len()), lines[to].split(',').next().unwrap_or_default());
                words[place] = if draws.below(2) == 0 { other.into() } else { WORDS[draws.below(WORDS.len())].into() };
                lines[from] = words.join(",");
            }
        }
        if lines.is_empty() {
            break;
        }
    }
    lines.join("\n")
}

/// Returns the path of a valid file that is to be damaged.
pub fn faults(name: &str) -> PathBuf {
    crate::root().join("tests/faults").join(name)
}

/// Reads a damaged file, and builds the mesh or model if it is small. A matrix is read with the other matrices in
/// `desk`.
pub fn read(name: &str, bytes: &[u8], desk: &Path) -> Result<(), Error> {
    let text = String::from_utf8_lossy(bytes);
    /// Largest number of nodes of a scene that is built; larger ones would only take time.
    const FEW_NODES: f64 = 2000.0;
    match Path::new(name).extension().and_then(|extension| extension.to_str()) {
        Some("json") => {
            let scene = Scene::from_json(&text, name)?;
            if scene.size().nodes < FEW_NODES { scene.build().map(drop) } else { Ok(()) }
        }
        Some("inp") => {
            let file = desk.join(name);
            std::fs::write(&file, bytes).map_err(|source| qp::LinearError::File {
                action: "write",
                path: desk.into(),
                source,
            })?;
            Scene::read(&file)?.build().map_err(|error| Scene::located(error, &file)).map(drop)
        }
        Some("msh") => Ok(GmshFile::parse(bytes, name)?.mesh(&[], 1.0).map(drop)?),
        _ => {
            let io = |source| qp::LinearError::File { action: "write", path: desk.into(), source };
            std::fs::write(desk.join(name), bytes).map_err(io)?;
            Ok(read_problem(desk).map(drop)?)
        }
    }
}

/// Returns the first words of a message, without its place, quotations and numbers. They are equal for inputs with the
/// same fault.
pub fn fault(error: &Error) -> String {
    wording(error.code(), &error.to_string())
}

/// As [`fault`], for a given code and message.
pub fn wording(code: &str, sentence: &str) -> String {
    // The message of a scene begins with the path.
    let behind_path = sentence.split_once("at `").and_then(|parts| parts.1.split_once("`: "));
    let said = behind_path.filter(|_| code == "scene").map_or(sentence, |parts| parts.1);
    let quotes = ['`', '"'];
    let (begin, end) = (said.split(quotes).next(), said.rsplit(quotes).next());
    let words = begin.into_iter().chain(end.filter(|end| Some(*end) != begin)).flat_map(str::split_whitespace);
    let counts = |word: &&str| word.contains(char::is_numeric) || word.trim_end_matches(';').parse::<f64>().is_ok();
    let words: Vec<&str> = words.filter(|word| !counts(word)).take(FIRST_WORDS).collect();
    format!("{code}: {}", words.join(" "))
}
