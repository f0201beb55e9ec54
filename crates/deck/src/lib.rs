//! Input decks of CalculiX as scenes: a deck becomes the text of a scene, whose body is the mesh of the deck.
//!
//! A card is read, passed over because it changes no answer, or refused with its line: a deck is never half read.
//!
//! ```
//! use signorini_deck::{DeckScene, Reading};
//! # let folder = std::env::temp_dir().join("signorini_deck_example");
//! # std::fs::create_dir_all(&folder).unwrap();
//! # let file = folder.join("square.inp");
//! // A square, held at a corner.
//! let deck = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPE4, ELSET=E\n1, 1, 2, 3, 4\n*MATERIAL, NAME=M\n\
//!     *ELASTIC\n100., .3\n*SOLID SECTION, MATERIAL=M, ELSET=E\n*BOUNDARY\n1, 1, 2\n*STEP\n*STATIC\n*END STEP\n";
//! std::fs::write(&file, deck).unwrap();
//! let scene = DeckScene::read(&file, "square.inp", Reading { permits: &[], step: None, earlier: &[] })?;
//! assert!(scene.text.contains(r#""material": {"young": 100, "poisson": 0.3}"#), "{}", scene.text);
//! # Ok::<(), signorini_fem::Error>(())
//! ```

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(clippy::missing_errors_doc, reason = "the sentence of an error says what is wrong")]

mod amplitudes;
mod bodies;
mod contacts;
mod coupling;
mod keywords;
mod loads;
mod materials;
mod mpc;
#[doc(hidden)]
mod references;
mod requests;
mod supports;
mod transforms;

use std::path::{Path, PathBuf};

use amplitudes::{Amplitudes, Temperatures};
use bodies::Body;
use contacts::{bolts, contacts, ties};
use coupling::couplings;
use keywords::{SceneEntry, SceneText};
use loads::Loads;
use materials::Sections;
use references::References;
use signorini_fem::Error;
use signorini_fem::mesh::deck::{Deck, DeckElement, DeckPlace, Space};
use supports::supports;
use transforms::{Displacements, Transforms};

#[doc(hidden)]
pub use references::{Of, ReferenceNode};
pub use requests::{RequestedTable, Requests};

/// The code of the warning that a deck asks for large displacements.
pub const NONLINEAR: &str = "nonlinear";

/// What it says.
const SMALL: &str = "NLGEOM is answered with small displacements";

/// More bodies than this are a mesh whose nodes were not merged.
const MOST_BODIES: usize = 1000;

/// Longer titles are cut.
const LONGEST_TITLE: usize = 200;

/// Returns `true` for the name of an input deck: it ends with `.inp`.
pub fn is_deck(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("inp"))
}

/// The scene of a deck, and what it is read from.
pub struct DeckScene {
    /// Its text, with a comment for each entry.
    pub text: String,
    /// The code and the sentence of each warning.
    pub warnings: Vec<(&'static str, String)>,
    /// Its nodes that are no nodes of the mesh.
    pub references: Vec<ReferenceNode>,
    /// The deck itself.
    pub deck: Deck,
    /// The file and the line of each entry of the scene, by its JSON path.
    pub lines: Vec<(String, (PathBuf, usize))>,
}

/// How a deck is read.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// Files that the deck includes may lie outside its folder with `outside`; friction is left out with `friction`.
    pub permits: &'a [&'a str],
    /// The step, from 1; the last one without it.
    pub step: Option<usize>,
    /// The displacements at the ends of the steps before it, as far as they are known.
    pub earlier: &'a [Displacements],
}

impl DeckScene {
    /// The scene of the deck `file`, which it calls `named`.
    pub fn read(file: &Path, named: &str, Reading { permits, step, earlier }: Reading) -> Result<Self, Error> {
        let within = file.parent().filter(|_| !permits.contains(&"outside"));
        let deck = Deck::read(file, within, step)?;
        let mut noted = deck.noted.clone();
        let passed = keywords::judged(&deck, &mut noted)?;
        if deck.bodies > MOST_BODIES {
            let message = format!(
                "the deck has {} bodies that share no node; merge the nodes in the mesher: at most {MOST_BODIES} are allowed",
                deck.bodies
            );
            return Err(deck.fault(deck.place_of_body(1), message));
        }
        let space = space(&deck)?;
        let amplitudes = Amplitudes::of(&deck)?;
        let sections = Sections::of(&deck, space)?;
        let temperatures = Temperatures::of(&deck, &amplitudes)?;
        let (couplings, bolts) = (couplings(&deck)?, bolts(&deck)?);
        let transforms = Transforms::of(&deck, &couplings, &bolts)?;
        let mut references = References::of(&deck, couplings, bolts, &transforms)?;
        noted.extend(nearest_elements(&deck));
        noted.extend(sections.noted.iter().cloned());
        let supports = supports(&deck, &amplitudes, &mut references, &transforms, earlier)?;
        let thickness = sections.thickness.map_or(1.0, |thickness| thickness.0);
        let loads = Loads::of(&deck, thickness, &amplitudes, &mut references, &transforms, &mut noted)?;
        let mut contacts = contacts(&deck, permits.contains(&"friction"))?;
        contacts.ties.extend(ties(&deck)?);
        let entries = references.entries();
        contacts.ties.extend(entries.ties);
        noted.extend(contacts.warnings);
        noted.extend(entries.warnings);
        noted.extend(deck.source.longer.get().cloned());
        let small = large_displacements(&deck).map(|place| (NONLINEAR, place, SMALL.to_string()));
        let noted = noted.into_iter().map(|(place, message)| ("deck", place, message));
        let noted: Vec<_> = small.into_iter().chain(noted).collect();
        let mut text = SceneText::new(&deck, &comments(&deck, named, &noted, &passed));
        text.plain("title", &title(&deck).into());
        text.plain("units", &serde_json::json!({"length": "", "force": ""}));
        text.plain("model", &model(space).into());
        if let Some((thickness, place)) = sections.thickness.filter(|thickness| thickness.0 != 1.0) {
            text.one("thickness", &SceneEntry::new(thickness.into(), place));
        }
        let bodies = (0..deck.bodies).map(|index| Body::of(&deck, index, named, &sections, &temperatures));
        add_bodies(&mut text, bodies.collect::<Result<_, _>>()?);
        text.list("supports", &supports);
        text.list("rigid-faces", &entries.rigid_faces);
        text.list("points", &entries.points);
        text.list("ties", &contacts.ties);
        text.list("springs", &entries.springs);
        text.list("loads", &loads);
        text.list("obstacles", &contacts.obstacles);
        let (text, places) = text.end();
        let whole = (String::new(), DeckPlace { file: 0, line: 1 });
        let position = |place: DeckPlace| {
            let (file, line) = deck.source.position(place);
            (file.to_path_buf(), line)
        };
        let warning = |(code, place, message): (&'static str, DeckPlace, String)| {
            let (file, line) = position(place);
            (code, format!("{}:{line}: {message}", file.display()))
        };
        let warnings = noted.into_iter().map(warning).collect();
        let lines = std::iter::once(whole).chain(places).map(|(path, place)| (path, position(place))).collect();
        Ok(DeckScene { text, warnings, references: entries.nodes, deck, lines })
    }
}

/// The comments that open the scene of a deck: where it comes from, and which cards are answered otherwise or passed
/// over.
fn comments(
    deck: &Deck,
    named: &str,
    noted: &[(&str, DeckPlace, String)],
    passed: &[(String, DeckPlace)],
) -> Vec<String> {
    let mut comments = vec![format!("The scene of {named}; each entry names the line of the deck that it comes from.")];
    let warning =
        |(_, place, message): &(&str, DeckPlace, String)| format!("Warning, {}: {message}", deck.source.named(*place));
    comments.extend(noted.iter().map(warning));
    if !passed.is_empty() {
        let names: Vec<&str> = passed.iter().map(|(name, _)| name.as_str()).collect();
        comments.push(format!("Passed over, because it changes no answer: {}.", names.join(", ")));
    }
    comments
}

/// Adds the first body, then the others.
fn add_bodies(text: &mut SceneText, bodies: Vec<Body>) {
    let mut bodies = bodies.into_iter();
    let Some(first) = bodies.next() else { return };
    text.one("body", &SceneEntry::new(first.body, first.place));
    first.material.iter().for_each(|material| text.one("material", material));
    text.list("materials", &first.materials);
    text.list("temperature", &first.temperature.into_iter().collect::<Vec<_>>());
    let (entries, places): (Vec<_>, Vec<_>) = bodies.map(|body| body.further()).unzip();
    text.list("further-bodies", &entries);
    for (index, places) in places.into_iter().enumerate() {
        text.places.extend(places.into_iter().map(|(key, place)| (format!("further-bodies[{index}].{key}"), place)));
    }
}

/// The one space of all elements.
fn space(deck: &Deck) -> Result<Space, Error> {
    let first = deck.element_list.first().map_or(Space::Solid, |element| element.of_type.space);
    match deck.element_list.iter().find(|element| element.of_type.space != first) {
        None => Ok(first),
        Some(DeckElement { place, of_type, .. }) => {
            let message = format!(
                "{} follows elements of the model `{}`; a deck has elements of one model",
                of_type.name,
                model(first)
            );
            Err(deck.fault(*place, message))
        }
    }
}

fn model(space: Space) -> &'static str {
    match space {
        Space::PlaneStress => "plane-stress",
        Space::PlaneStrain => "plane-strain",
        Space::Axisymmetric => "axisymmetric",
        Space::Solid => "space",
        Space::Line | Space::Sheet => "none",
    }
}

/// The first line of *HEADING, or the name of the deck.
fn title(deck: &Deck) -> String {
    let heading = deck.source.cards.iter().find(|card| card.is("HEADING")).and_then(|card| card.lines.first());
    let text = heading.map(|line| String::from_utf8_lossy(deck.source.text(line)).into_owned());
    let text =
        text.unwrap_or_else(|| deck.source.path().file_stem().unwrap_or_default().to_string_lossy().into_owned());
    text.chars().filter(|c| !c.is_control()).take(LONGEST_TITLE).collect()
}

/// The elements that are answered by others, each type once.
fn nearest_elements(deck: &Deck) -> Vec<(DeckPlace, String)> {
    let mut seen: Vec<&str> = Vec::new();
    let mut noted = Vec::new();
    for DeckElement { of_type, kind, place, .. } in &deck.element_list {
        if !seen.contains(&of_type.name) {
            seen.push(of_type.name);
            if !of_type.differs.is_empty() {
                let message =
                    format!("{} is answered by {}, {}", of_type.name, kind.name(), of_type.differs.join("; "));
                noted.push((*place, message));
            }
        }
    }
    noted
}

/// The first step with large displacements.
fn large_displacements(deck: &Deck) -> Option<DeckPlace> {
    let mut steps = deck.source.cards_of("STEP");
    steps.find(|step| step.has("NLGEOM") && !step.says("NLGEOM", "NO")).map(|step| step.place)
}
