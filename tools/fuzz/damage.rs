//! Random damage of files, and what their reader says of it.

use std::path::{Path, PathBuf};

use signorini::fem::GmshFile;
use signorini::qp::read_problem;
use signorini::{Error, Scene};

use super::draws::Draws;

/// Words that readers stumble over.
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

/// So many words tell one fault from another.
const FIRST_WORDS: usize = 4;

/// A few changes of a text, most of them small.
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

/// The right files that are damaged.
pub fn faults(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults").join(name)
}

/// Reads a damaged `name`, and builds what can be read, if it is small. A matrix stands beside the others of `desk`.
pub fn read(name: &str, bytes: &[u8], desk: &Path) -> Result<(), Error> {
    let text = String::from_utf8_lossy(bytes);
    /// Scenes of more nodes would only take time.
    const FEW_NODES: f64 = 2000.0;
    match Path::new(name).extension().and_then(|extension| extension.to_str()) {
        Some("json") => {
            let scene = Scene::from_json(&text, name)?;
            if scene.size().nodes < FEW_NODES { scene.build().map(drop) } else { Ok(()) }
        }
        Some("msh") => GmshFile::parse(bytes, name)?.mesh(None, 1.0).map(drop),
        _ => {
            let io = |source| Error::File { action: "write", path: desk.into(), source };
            std::fs::write(desk.join(name), bytes).map_err(io)?;
            read_problem(desk).map(drop)
        }
    }
}

/// The first words of a sentence, but for its place, what it quotes and counts: the same for inputs with the same fault.
pub fn fault(error: &Error) -> String {
    wording(error.code(), &error.to_string())
}

/// The same for a code and a sentence at hand.
pub fn wording(code: &str, sentence: &str) -> String {
    // In a scene, the path stands first.
    let behind_path = sentence.split_once("at `").and_then(|parts| parts.1.split_once("`: "));
    let said = behind_path.filter(|_| code == "scene").map_or(sentence, |parts| parts.1);
    let quotes = ['`', '"'];
    let (begin, end) = (said.split(quotes).next(), said.rsplit(quotes).next());
    let words = begin.into_iter().chain(end.filter(|end| Some(*end) != begin)).flat_map(str::split_whitespace);
    let counts = |word: &&str| word.contains(char::is_numeric) || word.trim_end_matches(';').parse::<f64>().is_ok();
    let words: Vec<&str> = words.filter(|word| !counts(word)).take(FIRST_WORDS).collect();
    format!("{code}: {}", words.join(" "))
}
