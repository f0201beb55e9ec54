//! `signorini ccx`, or the program under the name `ccx`: a deck in, the files of CalculiX out.
//!
//! What a program reads that calls it stands on standard output: CalculiX writes its warnings and errors there, and FreeCAD takes any
//! text on standard error for a failure.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::about::about;
use super::failure::{failed, sentence};
use super::input::{Input, scene_of};
use super::options::{Ccx, Format};
use super::outcome::{Ending, Outcome, unfit};
use super::settings::settings;
use super::solve::{assembly_seconds, reported};
use crate::Error;
use crate::output::{CalculixFiles, remove_files};
use crate::qp::{Start, Watch};
use crate::scene::{Requests, Scene};

/// Programs take the first number for the version of CalculiX.
const VERSION: &str = concat!(
    "\nThis is Version 2.20 of the decks and result files of CalculiX, which signorini ",
    env!("CARGO_PKG_VERSION"),
    " reads and writes\n\n"
);

/// Answers a call without a deck; programs look for the name of CalculiX.
const USAGE: &str = "Usage: ccx -i NAME\n\nsignorini solves the deck NAME.inp of CalculiX and writes NAME.frd.\n";

/// The arguments with the command `ccx`, if the program is called by that name. FreeCAD passes `-i` with a blank behind it.
pub(super) fn named(given: Vec<OsString>) -> Vec<OsString> {
    let stem = given.first().and_then(|program| Path::new(program).file_stem()).unwrap_or_default();
    if !stem.to_string_lossy().to_ascii_lowercase().starts_with("ccx") {
        return given;
    }
    let trimmed = |word: OsString| if word == "-i " { OsString::from("-i") } else { word };
    let own = ["signorini", "ccx"].map(OsString::from);
    own.into_iter().chain(given.into_iter().skip(1).map(trimmed)).collect()
}

pub(super) fn run(options: &Ccx, watch: &Watch) -> Outcome {
    if options.version {
        return Outcome::done(VERSION.to_string());
    }
    let Some(name) = options.job.as_ref().or(options.deck.as_ref()) else {
        return Outcome { ending: Ending::BadInput, ..Outcome::done(USAGE.to_string()) };
    };
    let mut text = String::new();
    let ending = answered(options, named_files(name), watch, &mut text).unwrap_or_else(|error| {
        text += &format!(" *ERROR: {}\n", sentence(&error));
        failed(&error, Format::Text).ending
    });
    Outcome { ending, ..Outcome::done(text) }
}

/// The file of a deck, and its name without the ending.
fn named_files(name: &Path) -> [PathBuf; 2] {
    match Scene::is_deck(name) {
        true => [name.to_path_buf(), name.with_extension("")],
        false => [with_ending(name, ".inp"), name.to_path_buf()],
    }
}

/// The name with an ending.
fn with_ending(stem: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(stem);
    name.push(ending);
    name.into()
}

/// Solves the deck in `file` and writes the files of its name `stem`; `text` gets warnings and the report. The files of an earlier run are
/// gone from the start, and fields are written last, of a certified answer only.
fn answered(options: &Ccx, [file, stem]: [PathBuf; 2], watch: &Watch, text: &mut String) -> Result<Ending, Error> {
    let (clock, folder) = (Instant::now(), with_ending(&stem, ".signorini"));
    CalculixFiles::remove(&stem)?;
    remove_files(&folder, &["report.html", "report.json"])?;
    let limits = &options.limits;
    let Some(solve) = options.solve(file.clone(), folder) else { return unfit("ccx", "no options of `solve`") };
    let requests = Requests::of_deck(&file, &limits.deck.permits())?;
    let scene = scene_of(&file, limits)?;
    assembly_seconds(&scene, &solve, watch)?;
    let input = Input::of_scene(&scene, &file, limits, clock.elapsed().as_secs_f64())?;
    *text += &input.warnings().replace("warning: ", " *WARNING: ");
    let missing = CalculixFiles::not_given(&requests);
    if !missing.is_empty() {
        *text += &format!(" *WARNING: these results are not written: {}\n", missing.join(", "));
    }
    let settings = settings(solve.method, &solve.common, watch);
    let about = about(&input.title, "solve", &file, solve.common.out.as_ref(), solve.common.threads);
    let solved = input.problem().solve_from(&Start::default(), &settings).map_err(|error| input.explain(error))?;
    let Some(answer) = input.answer(&solved)? else { return unfit("ccx", "the deck has no mesh") };
    // The stress is part of all files: it is computed once.
    answer.stress()?;
    let outcome = reported(&input, (solved, Some(answer.clone())), settings.goal(), (about, &solve), watch)?;
    outcome.pictures.map_or(Ok(()), |pictures| pictures())?;
    *text += &outcome.text;
    if outcome.ending == Ending::Certified && !watch.is_stopped() {
        CalculixFiles::new(&answer, &requests)?.write(&stem)?;
    }
    Ok(outcome.ending)
}
